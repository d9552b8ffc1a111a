"""Skins and animations, parsed and kept (glTF 2.0, 3.7.3 and 3.11)."""

from __future__ import annotations

import numpy as np

from rendergraph.scene.gltf.accessors import FLOAT, Accessors
from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.scene import F32, F64, Animation, AnimationChannel, Skin

_WIDTH = {"translation": 3, "rotation": 4, "scale": 3, "weights": 1}
_NORMALIZED = (5120, 5121, 5122, 5123, 5126)
_INTERPOLATIONS = ("LINEAR", "STEP", "CUBICSPLINE")


def read_skin(item: Item, document: Document, accessors: Accessors) -> Skin:
    """One element of ``skins``; inverse bind matrices are identity where the file gives none."""
    joints = tuple(document.as_index(joint, "nodes") for joint in item.require("joints"))
    if not joints:
        raise item.require("joints").wrong("at least one joint")
    matrices = item.get("inverseBindMatrices")
    if matrices is None:
        return Skin(joints, np.tile(np.eye(4, dtype=np.float32), (len(joints), 1, 1)))
    values = accessors.floats(matrices, ("MAT4",))
    if len(values) < len(joints):
        got = f"an accessor of {len(values)} matrices"
        raise gltf_error("RG608", str(matrices), got=got, expected=f"one for each of {len(joints)} joints")
    return Skin(joints, np.ascontiguousarray(values[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)))


def rest_transform(skin: Skin, worlds: list[F64]) -> tuple[F64, bool]:
    """What skinning does to the mesh at rest, as one matrix (of the first joint), and whether it is the same for all
    joints: then it is exact, else the mesh is drawn in its bind pose.
    """
    matrices = np.stack([worlds[joint] for joint in skin.joints]) @ skin.inverse_bind.astype(np.float64)
    spread = np.abs(matrices - matrices[0]).max()
    return matrices[0], bool(spread <= 1e-3 * max(1.0, np.abs(matrices[0]).max()))


def read_animation(item: Item, document: Document, accessors: Accessors) -> Animation:
    """One element of ``animations``. Channels that target nothing are left out."""
    samplers = item.elements("samplers")
    channels = []
    for channel in item.elements("channels"):
        target = channel.require("target")
        index = channel.require("sampler")
        if index.as_integer() >= len(samplers):
            what = f"{item.path[1:]}/samplers"
            raise gltf_error("RG606", str(index), what=what, index=index.value, count=len(samplers))
        node = document.index(target, "node", "nodes")
        path = target.require("path")
        if path.as_text() not in _WIDTH:
            raise path.wrong("translation, rotation, scale or weights")
        if node is not None:
            channels.append(_channel(node, path.as_text(), samplers[index.as_integer()], accessors))
    return Animation(item.text("name"), tuple(channels))


def _channel(node: int, path: str, sampler: Item, accessors: Accessors) -> AnimationChannel:
    mode = sampler.get("interpolation")
    if mode is not None and mode.as_text() not in _INTERPOLATIONS:
        raise mode.wrong(" or ".join(_INTERPOLATIONS))
    interpolation = "LINEAR" if mode is None else mode.as_text()
    times = accessors.floats(sampler.require("input"), ("SCALAR",))[:, 0]
    if (np.diff(times) < 0).any() or times[0] < 0:
        raise gltf_error(
            "RG616", str(sampler.require("input")), reason="keyframe times do not increase", section="3.11"
        )
    kind = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[_WIDTH[path]]
    output = sampler.require("output")
    values = accessors.floats(output, (kind,), _NORMALIZED if path in ("rotation", "weights") else FLOAT)
    return AnimationChannel(
        node, path, interpolation, times, _by_keyframe(values, len(times), path, interpolation, output)
    )


def _by_keyframe(values: F32, keyframes: int, path: str, interpolation: str, where: Item) -> F32:
    """``float32[keyframes, n]``: a cubic spline's rows are in-tangent, value, out-tangent; weights have any n."""
    per_frame = 3 if interpolation == "CUBICSPLINE" else 1
    rows, rest = divmod(len(values), keyframes * per_frame)
    if rest or (rows != 1 and path != "weights"):
        got = f"an accessor of {len(values)} elements"
        raise gltf_error("RG608", str(where), got=got, expected=f"{per_frame} for each of {keyframes} keyframes")
    return values.reshape(keyframes, -1)
