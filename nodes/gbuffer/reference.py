"""The truth of a G-buffer: surfaces by rays, and packings and depth reconstruction in float64 numpy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.node.reference import PassRun, Truth
from rendergraph.nodes.gbuffer.packing import NORMAL_ERROR
from rendergraph.plan.graph import TextureDesc

F64 = npt.NDArray[np.float64]


def octahedral_encode(n: F64) -> F64:
    """Unit vectors ``float64[k, 3]`` to the square [-1, 1]^2, ``float64[k, 2]`` (Cigolle et al. 2014)."""
    p = n / np.abs(n).sum(axis=1, keepdims=True)
    folded = (1.0 - np.abs(p[:, 1::-1])) * np.where(p[:, :2] >= 0.0, 1.0, -1.0)
    square: F64 = np.where(p[:, 2:] >= 0.0, p[:, :2], folded)
    return square


def octahedral_decode(e: F64) -> F64:
    """The square back to unit vectors."""
    z = 1.0 - np.abs(e).sum(axis=1)
    folded = (1.0 - np.abs(e[:, ::-1])) * np.where(e >= 0.0, 1.0, -1.0)
    n = np.column_stack([np.where(z[:, None] >= 0.0, e, folded), z])
    unit: F64 = n / np.linalg.norm(n, axis=1, keepdims=True)
    return unit


def quantise_unorm(x: F64, bits: int) -> F64:
    """[-1, 1] stored as 0.5 + 0.5 x in an unsigned normalised channel, and read back."""
    top = 2.0**bits - 1.0
    return np.round((x * 0.5 + 0.5) * top) / top * 2.0 - 1.0


def angle_degrees(a: F64, b: F64) -> F64:
    """Angle between unit vectors, degrees; accurate for small angles (``atan2`` of sine and cosine)."""
    degrees: F64 = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1)))
    return degrees


def sphere(count: int, seed: int = 0) -> F64:
    """``count`` random directions, and the poles, axes and octants' edges where packings break, ``float64[k, 3]``."""
    random = np.random.default_rng(seed).normal(size=(count, 3))
    signs = np.array([-1.0, 0.0, 1.0])
    lattice = np.stack(np.meshgrid(signs, signs, signs), axis=-1).reshape(-1, 3)
    special = lattice[np.abs(lattice).sum(axis=1) > 0]
    near_poles = np.array([[x * 1e-4, y * 1e-4, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    every = np.concatenate([random, special, near_poles])
    unit: F64 = every / np.linalg.norm(every, axis=1, keepdims=True)
    return unit


def view_z(depth: F64, projection: F64) -> F64:
    """View-space z, metres, of depth-buffer values, by inverting ``projection`` (``float64[4, 4]``, view to clip)."""
    inverse = np.linalg.inv(projection)
    clip = np.stack([np.zeros_like(depth), np.zeros_like(depth), depth, np.ones_like(depth)], axis=-1)
    view = clip @ inverse.T
    z: F64 = view[..., 2] / view[..., 3]
    return z


# ---------------------------------------------------------------- judging

#: Rounding of a transformed vertex, its interpolation and the division by w, in float32.
_DEPTH_ARITHMETIC = 24.0 * 2.0**-24
#: Texture units weigh texels with eight bits: so much of the difference between neighbours along both axes together,
#: and what it turns the normal of a normal map by.
_FILTER, _FILTER_DEGREES = 2.0 / 256.0, 1.0
_SRGB_SLOPE = 2.275  # of the decoding, at white


def judge(run: PassRun) -> Mapping[str, Truth]:
    """Every target against what rays through the pixels' centres hit (measure/truth/surfaces.py), where it is known.

    Materials are judged where their textures are not minified; tolerances follow from the targets' formats.
    """
    assert run.trace is not None
    seen = run.trace()
    known, slots, shading = seen.known & seen.hit, seen.magnified_slots, seen.shading
    masks = {"normal": known & slots[..., 2], "base_color": known & slots[..., 0],
             "material": known & slots[..., 1] & slots[..., 3], "emissive": known & slots[..., 4]}  # fmt: skip
    textured = {port: bool((masks[port] & seen.textured[..., slot]).any())
                for port, slot in (("base_color", 0), ("material", 1), ("normal", 2))}  # fmt: skip
    depth = _stored_depth(run)
    drawn = depth[..., 0] != (0.0 if run.frame.depth == "reversed" else 1.0)
    depth_error = _depth_error(run, seen.depth[known])
    factors = np.stack([shading.roughness, shading.metallic, shading.occlusion, shading.unlit], axis=-1)
    return {
        "depth": Truth(
            seen.depth[..., None], depth, mask=seen.known & ("depth" in run.outputs),
            tolerance=_in_ulps(depth_error, seen.depth[known]),
        ),
        "distance": Truth(
            seen.view_depth[..., None],
            np.where(drawn[..., None], -view_z(np.where(drawn[..., None], depth, 0.5), seen.view.projection), 0.0),
            mask=known & drawn,
            # z = P32 / (depth + P22), so a depth off by e moves z by z^2 e / P32.
            tolerance=float((depth_error * seen.view_depth[known]).max(initial=0.0) / abs(seen.view.projection[2, 3])),
        ),
        "normal": _normal_truth(run, seen.image(shading.normal), masks["normal"], textured["normal"]),
        "base_color": Truth(
            seen.image(shading.base_color), run.outputs["base_color"][..., :3].astype(np.float64),
            mask=masks["base_color"], tolerance=_step(run, "base_color") + _FILTER * textured["base_color"],
        ),
        "material": Truth(
            seen.image(factors), run.outputs["material"].astype(np.float64), mask=masks["material"],
            tolerance=_step(run, "material") + _FILTER * textured["material"],
        ),
        "emissive": _emissive_truth(run, seen.image(np.minimum(shading.emissive, 64512.0)), masks["emissive"]),
    }  # fmt: skip


def invariants(run: PassRun) -> Iterable[str]:
    """Normals stored as xyz are of unit length, material factors lie in 0..1, nothing emits less than nothing."""
    depth, normal = _stored_depth(run)[..., 0], run.outputs["normal"].astype(np.float64)
    covered = depth != (0.0 if run.frame.depth == "reversed" else 1.0)
    if normal.shape[-1] >= 3 and covered.any():
        stored = _signed(run, normal)[covered][:, :3]
        off = float(np.abs(np.linalg.norm(stored, axis=1) - 1.0).max())
        # By drivers that do not round; ten bits: see _step. Both change lengths more than directions.
        truncated = {"rgba16f": 2.0**-10, "rgb10_a2": 1.0 / 1023.0}.get(_format(run, "normal"), 0.0)
        if off > np.radians(NORMAL_ERROR[_format(run, "normal")]) + truncated + 1e-5:
            yield f"a stored normal has a length of 1 +- {off:.2g}"
    for port in ("base_color", "material"):
        values = run.outputs[port]
        if not (np.isfinite(values).all() and values.min() >= 0.0):
            yield f"{port} holds a value that is negative or no number"
    if run.outputs["material"].max() > 1.0:
        yield "material holds a factor above 1"
    if "emissive" in run.outputs and not (run.outputs["emissive"] >= 0.0).all():
        yield "emissive holds a negative value or no number"


def unpack_normals(stored: F64, format: str) -> F64:
    """World-space unit normals float64[..., 3] of texels as a shader reads them, by the packing of their format."""
    signed = stored if FORMATS[format].channel is not Channel.UNORM else stored * 2.0 - 1.0
    if stored.shape[-1] == 2:
        return octahedral_decode(signed.reshape(-1, 2)).reshape(*stored.shape[:-1], 3)
    length = np.linalg.norm(signed[..., :3], axis=-1, keepdims=True)
    return np.asarray(np.divide(signed[..., :3], length, out=np.zeros_like(signed[..., :3]), where=length > 0.0))


def _normal_truth(run: PassRun, normal: F64, mask: npt.NDArray[np.bool_], mapped: bool) -> Truth:
    format = _format(run, "normal")
    judged = unpack_normals(run.outputs["normal"].astype(np.float64), format)
    tolerance = 1.02 * NORMAL_ERROR[format] + 1e-4
    return Truth(normal, judged, mask=mask, tolerance=tolerance + (_FILTER_DEGREES if mapped else 0.0))


def _emissive_truth(run: PassRun, emissive: F64, mask: npt.NDArray[np.bool_]) -> Truth:
    if "emissive" not in run.outputs:
        return Truth(emissive, emissive, mask=np.zeros_like(mask))
    # Truncated floats of 10 bits are off by up to a 32nd, of 11 by a 64th, of 16 by a 1024th.
    step = {"r11g11b10f": 2.0**-5, "rgba16f": 2.0**-10}.get(_format(run, "emissive"), 2.0**-20)
    tolerance = (step + _FILTER) ** 2
    return Truth(emissive, run.outputs["emissive"][..., :3].astype(np.float64), mask=mask, tolerance=tolerance)


def _stored_depth(run: PassRun) -> F64:
    """The depth target, float64[h, w, 1]; as far as it goes where nothing is drawn and nobody reads it."""
    if "depth" in run.outputs:
        return run.outputs["depth"].astype(np.float64)[..., :1]
    return np.full((run.frame.height, run.frame.width, 1), 0.0 if run.frame.depth == "reversed" else 1.0)


def _depth_error(run: PassRun, depth: F64) -> F64:
    """How far a stored depth may be off: by its format, and by float32 before it."""
    name = _format(run, "depth")
    quantum = 0.0 if name in ("d32f", "d32fs8") else {"d16": 2.0**-16}.get(name, 2.0**-24)
    return quantum + _DEPTH_ARITHMETIC * np.abs(depth)


def _in_ulps(error: F64, depth: F64) -> float:
    """The largest of the errors in units in the last place of float32."""
    return float((error / np.spacing(np.maximum(np.abs(depth), 1e-30).astype(np.float32))).max(initial=1.0))


def _step(run: PassRun, port: str) -> float:
    """Largest rounding error of values in 0..1 in a port's format, as a shader reads them."""
    format = _format(run, port)
    row = FORMATS[format]
    if row.channel is Channel.FLOAT:
        return 2.0 ** -(11 if row.texel_bytes == 8 else 22)
    bits = 10 if format == "rgb10_a2" else 8 * row.texel_bytes // row.channels
    # Ten bits may be stored as equal bins, floor(1024 x), as llvmpipe does: up to a whole code off.
    codes = 1.05 if bits == 10 else 0.6
    return codes / (2.0**bits - 1.0) * (_SRGB_SLOPE if row.srgb else 1.0)


def _format(run: PassRun, port: str) -> str:
    desc = run.descs[port]
    assert isinstance(desc, TextureDesc)
    return desc.format


def _signed(run: PassRun, normal: F64) -> F64:
    return normal if FORMATS[_format(run, "normal")].channel is not Channel.UNORM else normal * 2.0 - 1.0
