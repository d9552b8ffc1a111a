"""Mesh primitives: attributes and indices to triangle lists with every vertex array present (glTF 2.0, 3.7.2)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.scene.gltf.accessors import QUANTIZED, UNSIGNED, Accessors, check_below
from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.scene import F32, U32, TextureUse
from rendergraph.scene.tangents import any_tangents, generate_tangents, orthonormal_tangents

_SIGNED = (5120, 5122, 5126)
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_ATTRIBUTES = ("POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0")


@dataclass(frozen=True, slots=True)
class Geometry:
    """A triangle list; arrays as in ``Scene``, joints and weights none when the primitive has no skinning data."""

    positions: F32
    normals: F32
    tangents: F32
    uv0: F32
    uv1: F32
    colors: F32
    joints: npt.NDArray[np.uint16] | None
    weights: F32 | None
    indices: U32

    def select(self, vertices: npt.NDArray[Any], indices: U32, **replaced: Any) -> Geometry:
        """The geometry with the given vertices (repeated or dropped) and indices into them."""
        arrays = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in {"indices", *replaced}}
        taken: dict[str, Any] = {name: None if array is None else array[vertices] for name, array in arrays.items()}
        return Geometry(**taken, **replaced, indices=indices)


def read_primitive(
    primitive: Item, document: Document, accessors: Accessors, normal_map: TextureUse | None
) -> Geometry | None:
    """A primitive's triangles; none (and a note) for points, lines, or no positions.

    ``normal_map``: the material's, whose uv set and transform decide the tangents; none if it has no normal map.
    """
    mode = primitive.integer("mode", _TRIANGLES, 0, 6)
    attributes = primitive.require("attributes")
    if mode < _TRIANGLES:
        document.note(f"{primitive.path} consists of points or lines and was skipped")
        return None
    if attributes.get("POSITION") is None:
        document.note(f"{primitive.path} has no POSITION and was skipped")
        return None
    if primitive.get("targets") is not None:
        document.note(f"{primitive.path} has morph targets, which are ignored")
    for name in attributes.members():
        if name not in _ATTRIBUTES and not name.startswith("_"):
            document.note(f"{primitive.path} has {name[:20]!r}, which is ignored")

    positions = accessors.floats(attributes.require("POSITION"), ("VEC3",), QUANTIZED)
    reader = _Attributes(attributes, accessors, len(positions))
    normals, tangents = (
        reader.floats("NORMAL", ("VEC3",), _SIGNED, True),
        reader.floats("TANGENT", ("VEC4",), _SIGNED, True),
    )
    joints, weights = reader.skinning()
    zeros = np.broadcast_to(np.float32(0), (len(positions), 2))
    uv0, uv1 = (reader.floats(f"TEXCOORD_{i}", ("VEC2",), QUANTIZED, False) for i in (0, 1))
    geometry = Geometry(
        positions,
        np.empty((len(positions), 3), np.float32) if normals is None else _unit_normals(normals),
        np.empty((len(positions), 4), np.float32) if tangents is None else tangents,
        zeros if uv0 is None else uv0,
        zeros if uv1 is None else uv1,
        reader.colors(),
        joints,
        weights,
        _triangle_list(_read_indices(primitive, accessors, len(positions)), mode, primitive),
    )
    if normals is None:  # "flat normals", which no two faces can share; tangents then "MUST be ignored"
        geometry, tangents = _flat_shaded(geometry), None
    return _with_tangents(geometry, tangents is not None, normal_map, (uv0, uv1), document, primitive)


class _Attributes:
    """A primitive's optional attributes, all of which must have as many elements as it has positions."""

    def __init__(self, attributes: Item, accessors: Accessors, count: int) -> None:
        self._attributes, self._accessors, self._count = attributes, accessors, count

    def floats(
        self, name: str, types: tuple[str, ...], components: tuple[int, ...], normalized_only: bool
    ) -> F32 | None:
        item = self._item(name)
        if item is None:
            return None
        return self._accessors.floats(item, types, components, normalized_only=normalized_only)

    def colors(self) -> F32:
        """COLOR_0 as linear RGBA; white without it."""
        colors = self.floats("COLOR_0", ("VEC3", "VEC4"), UNSIGNED, True)
        if colors is None:
            return np.broadcast_to(np.float32(1), (self._count, 4))
        if colors.shape[1] == 4:
            return colors
        return np.hstack([colors, np.ones((len(colors), 1), np.float32)])

    def skinning(self) -> tuple[npt.NDArray[np.uint16] | None, F32 | None]:
        """JOINTS_0 and WEIGHTS_0, weights made to sum to 1."""
        item, weights = self._item("JOINTS_0"), self.floats("WEIGHTS_0", ("VEC4",), UNSIGNED, True)
        if item is None or weights is None:
            return None, None
        joints = self._accessors.integers(item, ("VEC4",), (5121, 5123)).astype(np.uint16)
        weights = np.maximum(weights, 0)
        weights[~weights.any(axis=1)] = (1.0, 0.0, 0.0, 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        return joints, weights

    def _item(self, name: str) -> Item | None:
        item = self._attributes.get(name)
        if item is not None and self._accessors.count(item) != self._count:
            got = f"an accessor of {self._accessors.count(item)} elements"
            raise gltf_error("RG608", str(item), got=got, expected=f"{self._count}, as many as POSITION has,")
        return item


def _read_indices(primitive: Item, accessors: Accessors, vertices: int) -> U32:
    item = primitive.get("indices")
    if item is None:
        return np.arange(vertices, dtype=np.uint32)
    indices = accessors.integers(item, ("SCALAR",), (5121, 5123, 5125)).reshape(-1)
    check_below(indices, vertices, item, "vertices")
    return indices


def _triangle_list(indices: U32, mode: int, primitive: Item) -> U32:
    """Triangles, strips and fans as a list, wound as glTF 2.0, 3.7.2.1 has them."""
    count = len(indices)
    if count < 3 or (mode == _TRIANGLES and count % 3):
        reason = f"{count} vertices do not make whole triangles"
        raise gltf_error("RG616", str(primitive), reason=reason, section="3.7.2.1 (topology types)")
    if mode == _TRIANGLES:
        return indices
    first = np.arange(count - 2)
    if mode == _STRIP:
        odd = first % 2
        corners = np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)
    else:
        corners = np.stack([first + 1, first + 2, np.zeros_like(first)], axis=1)
    return indices[corners].reshape(-1)


def _unit_normals(normals: F32) -> F32:
    """Normals at unit length; +y for a zero one, which only faces without area should have."""
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit = (normals / np.where(lengths > 1e-20, lengths, 1)).astype(np.float32)
    unit[lengths[:, 0] <= 1e-20] = (0.0, 1.0, 0.0)
    return unit


def _flat_shaded(geometry: Geometry) -> Geometry:
    corners = geometry.positions[geometry.indices].reshape(-1, 3, 3).astype(np.float64)
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(faces, axis=1, keepdims=True)
    normals = _unit_normals((faces / np.where(lengths > 0, lengths, 1)).astype(np.float32))
    unshared = np.arange(len(geometry.indices), dtype=np.uint32)
    return geometry.select(geometry.indices, unshared, normals=np.repeat(normals, 3, axis=0))


def _with_tangents(
    geometry: Geometry,
    given: bool,
    normal_map: TextureUse | None,
    uvs: tuple[F32 | None, F32 | None],
    document: Document,
    primitive: Item,
) -> Geometry:
    if given:
        return replace(geometry, tangents=orthonormal_tangents(geometry.tangents, geometry.normals))
    if normal_map is None or uvs[normal_map.uv_set] is None:
        if normal_map is not None:
            document.note(f"{primitive.path} has a normal map but no TEXCOORD_{normal_map.uv_set}")
        return replace(geometry, tangents=any_tangents(geometry.normals))
    uv = transform_uv(geometry.uv1 if normal_map.uv_set else geometry.uv0, normal_map)
    space = generate_tangents(geometry.positions, geometry.normals, uv, geometry.indices)
    return geometry.select(space.vertices, space.indices, tangents=space.tangents)


def transform_uv(uv: F32, use: TextureUse) -> F32:
    """KHR_texture_transform: scale, then rotate the coordinates (the image turns clockwise), then move."""
    if use.scale == (1.0, 1.0) and use.rotation == 0.0:
        return uv  # an offset alone leaves tangents as they are
    cos, sin = np.cos(use.rotation), np.sin(use.rotation)
    turn = np.array([[cos, sin], [-sin, cos]]) @ np.diag(use.scale)
    moved: F32 = (uv @ turn.T + use.offset).astype(np.float32)
    return moved
