"""Collects geometry, materials and placements into a ``Scene``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rendergraph.scene.procedural.geometry import F64, Geometry
from rendergraph.scene.procedural.textures import Maps
from rendergraph.scene.scene import Image, Instance, Material, Mesh, Scene, TextureUse, Wrap


def placement(
    x: float = 0.0,
    y: float = 0.0,
    z: float = 0.0,
    *,
    turn: float = 0.0,
    scale: float | tuple[float, float, float] = 1.0,
) -> F64:
    """Scale, then turn about the vertical (radians, counter-clockwise seen from above), then move: float64[4, 4]."""
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]) * np.broadcast_to(scale, 3)
    matrix[:3, 3] = x, y, z
    return matrix


class SceneBuilder:
    """Grows a scene. Each method returns the index its thing will have in the scene."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._parts: list[Geometry] = []
        self._meshes: list[Mesh] = []
        self._instances: list[Instance] = []
        self._materials: list[Material] = []
        self._images: list[Image] = []
        self._vertices = 0
        self._indices = 0

    def image(self, image: Image) -> int:
        """Add an image."""
        self._images.append(image)
        return len(self._images) - 1

    def material(self, material: Material, maps: Maps | None = None) -> int:
        """Add a material, textured with ``maps`` when given."""
        self._materials.append(material if maps is None else self._textured(material, maps))
        return len(self._materials) - 1

    def dyed(self, material: int, name: str, base_color: tuple[float, float, float, float]) -> int:
        """Add a copy of a material in another colour; it shares the textures."""
        self._materials.append(replace(self._materials[material], name=name, base_color=base_color))
        return len(self._materials) - 1

    def _textured(self, material: Material, maps: Maps) -> Material:
        wrap = (Wrap.REPEAT, Wrap.REPEAT if maps.tiles else Wrap.CLAMP)
        base, normal, packed = (
            None if image is None else TextureUse(self.image(image), wrap=wrap)
            for image in (maps.base, maps.normal, maps.orm)
        )
        return replace(
            material,
            base_color_texture=base,
            normal_texture=normal,
            metallic_roughness_texture=packed,
            occlusion_texture=packed,
        )

    def mesh(self, geometry: Geometry, material: int) -> int:
        """Add a mesh."""
        low, high = geometry.positions.min(axis=0), geometry.positions.max(axis=0)
        self._meshes.append(
            Mesh(
                first_index=self._indices,
                index_count=len(geometry.indices),
                base_vertex=self._vertices,
                material=material,
                bounds_min=(float(low[0]), float(low[1]), float(low[2])),
                bounds_max=(float(high[0]), float(high[1]), float(high[2])),
            )
        )
        self._parts.append(geometry)
        self._vertices += len(geometry.positions)
        self._indices += len(geometry.indices)
        return len(self._meshes) - 1

    def recoloured(self, mesh: int, material: int) -> int:
        """Add a mesh that draws another one's triangles with another material; costs no vertices."""
        self._meshes.append(replace(self._meshes[mesh], material=material))
        return len(self._meshes) - 1

    def place(self, mesh: int, world: F64 | None = None, name: str = "") -> int:
        """Put a mesh into the world."""
        self._instances.append(Instance(mesh, np.eye(4) if world is None else world, name))
        return len(self._instances) - 1

    def build(self) -> Scene:
        """The scene: geometry, materials and images; the caller adds cameras and lights."""
        parts = self._parts
        count = self._vertices
        return Scene(
            name=self._name,
            positions=np.concatenate([p.positions for p in parts]).astype(np.float32),
            normals=np.concatenate([p.normals for p in parts]).astype(np.float32),
            tangents=np.concatenate([p.tangents for p in parts]).astype(np.float32),
            uv0=np.concatenate([p.uv for p in parts]).astype(np.float32),
            uv1=np.zeros((count, 2), np.float32),
            colors=np.ones((count, 4), np.float32),
            indices=np.concatenate([p.indices for p in parts]).astype(np.uint32),
            meshes=self._meshes,
            instances=self._instances,
            materials=self._materials,
            images=self._images,
        )
