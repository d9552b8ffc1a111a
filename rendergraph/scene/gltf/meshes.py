"""Collects the primitives of all drawn meshes into one vertex pool and one index buffer."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.scene.gltf.accessors import Accessors, check_below
from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.images import Images
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.gltf.materials import read_material
from rendergraph.scene.gltf.primitives import Geometry, read_primitive
from rendergraph.scene.scene import Material, Mesh, TextureUse

MAX_VERTICES = 2**24
MAX_INDICES = 2**26

_WIDTHS = {"positions": 3, "normals": 3, "tangents": 4, "uv0": 2, "uv1": 2, "colors": 4}


class MeshPool:
    """Meshes are read when first drawn; primitives that share accessors share their place in the pool."""

    def __init__(self, document: Document, accessors: Accessors, images: Images) -> None:
        self._document, self._accessors = document, accessors
        self.materials: list[Material] = [read_material(m, document, images) for m in document.arrays["materials"]]
        self.meshes: list[Mesh] = []
        self._geometries: list[Geometry] = []
        self._placed: dict[Any, tuple[int, int, int] | None] = {}
        self._of_mesh: dict[int, list[int]] = {}
        self._default_material: int | None = None
        self._vertices = self._indices = 0

    def use(self, mesh: int) -> list[int]:
        """Indices into ``meshes`` of a glTF mesh's primitives."""
        if mesh not in self._of_mesh:
            primitives = self._document.arrays["meshes"][mesh].require("primitives")
            self._of_mesh[mesh] = [m for p in primitives if (m := self._mesh(p)) is not None]
        return self._of_mesh[mesh]

    def check_joints(self, mesh: int, count: int) -> None:
        """RG609 if a primitive refers to a joint that its skin of ``count`` joints does not have."""
        for primitive in self._document.arrays["meshes"][mesh].require("primitives"):
            joints = primitive.require("attributes").get("JOINTS_0")
            if joints is not None:
                check_below(self._accessors.integers(joints, ("VEC4",), (5121, 5123)), count, joints, "joints")

    def vertex_arrays(self) -> dict[str, Any]:
        """The pool's arrays by their names in ``Scene``."""
        arrays: dict[str, Any] = {
            name: np.concatenate([np.zeros((0, width), np.float32), *(getattr(g, name) for g in self._geometries)])
            for name, width in _WIDTHS.items()
        }
        arrays["indices"] = np.concatenate([np.zeros(0, np.uint32), *(g.indices for g in self._geometries)])
        if any(g.joints is not None for g in self._geometries):
            arrays["joints"] = np.concatenate([_or_zeros(g.joints, g, np.uint16) for g in self._geometries])
            arrays["weights"] = np.concatenate([_or_zeros(g.weights, g, np.float32) for g in self._geometries])
        return arrays

    # ---- one primitive

    def _mesh(self, primitive: Item) -> int | None:
        material = self._material(primitive)
        place = self._place(primitive, self.materials[material].normal_texture)
        if place is None:
            return None
        geometry = self._geometries[place[0]]
        low, high = geometry.positions.min(axis=0), geometry.positions.max(axis=0)
        bounds = (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2]))
        self.meshes.append(Mesh(place[1], len(geometry.indices), place[2], material, *bounds))
        return len(self.meshes) - 1

    def _place(self, primitive: Item, normal_map: TextureUse | None) -> tuple[int, int, int] | None:
        """Geometry number, first index and base vertex."""
        attributes = primitive.require("attributes")
        tangents = None if normal_map is None else (normal_map.uv_set, normal_map.scale, normal_map.rotation)
        accessors = tuple((name, self._reference(attributes.get(name))) for name in sorted(attributes.members()))
        key = (accessors, self._reference(primitive.get("indices")), primitive.integer("mode", 4), tangents)
        if key not in self._placed:
            self._check_size(primitive, attributes)
            geometry = read_primitive(primitive, self._document, self._accessors, normal_map)
            self._placed[key] = None if geometry is None else self._append(geometry)
        return self._placed[key]

    def _reference(self, item: Item | None) -> int | None:
        return None if item is None else self._document.as_index(item, "accessors")

    def _append(self, geometry: Geometry) -> tuple[int, int, int]:
        place = (len(self._geometries), self._indices, self._vertices)
        self._geometries.append(geometry)
        self._vertices += len(geometry.positions)
        self._indices += len(geometry.indices)
        return place

    def _check_size(self, primitive: Item, attributes: Item) -> None:
        """Before decoding: a small file can refer to the same data, or to none, any number of times."""
        position, indices = attributes.get("POSITION"), primitive.get("indices")
        vertices = 0 if position is None else self._accessors.count(position)
        corners = vertices if indices is None else self._accessors.count(indices)
        if primitive.integer("mode", 4) > 4:
            corners *= 3  # strips and fans: a triangle an index
        if attributes.get("NORMAL") is None:
            vertices = corners  # flat normals: a vertex a corner
        sizes = (
            ("vertices", self._vertices + vertices, MAX_VERTICES),
            ("indices", self._indices + corners, MAX_INDICES),
        )
        for what, number, limit in sizes:
            if number > limit:
                raise gltf_error("RG617", str(primitive), what=what, count=number, limit=limit)

    def _material(self, primitive: Item) -> int:
        index = self._document.index(primitive, "material", "materials")
        if index is not None:
            return index
        if self._default_material is None:
            self._default_material = len(self.materials)
            self.materials.append(Material(name="default"))
        return self._default_material


def _or_zeros(array: npt.NDArray[Any] | None, geometry: Geometry, dtype: type) -> npt.NDArray[Any]:
    return np.zeros((len(geometry.positions), 4), dtype) if array is None else array
