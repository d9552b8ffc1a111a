"""Triangles that no mesh should have and many do: without area, thinner than a texel, or with nothing for a normal."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from rendergraph.scene.scene import F64, Alpha, Instance, Material, Mesh, Scene

#: Corners in the square -1..1 before the camera: a point, a line there and back, a line, and slivers of every thinness.
_TRIANGLES: Final = (
    ((0.1, 0.1, 0.0), (0.1, 0.1, 0.0), (0.1, 0.1, 0.0)),
    ((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((-0.5, -0.2, 0.0), (0.0, -0.2, 0.0), (0.5, -0.2, 0.0)),
    *(((-0.8, k / 20 - 1, 0.0), (0.8, k / 20 - 1, 0.0), (0.8, k / 20 - 1 + 10.0**-k, 0.0)) for k in range(1, 39, 4)),
    ((-0.3, -0.3, 0.0), (0.3, -0.3, 0.0), (0.0, 0.3, 0.0)),  # a whole one, without normals
)  # fmt: skip


def degenerate_triangles(scene: Scene, world: F64) -> Scene:
    """The scene with them, placed by ``world`` float64[4, 4]. Every second has normals and tangents of length zero."""
    corners = np.array(_TRIANGLES, np.float32)
    count = len(corners) * 3
    normals = np.zeros((len(corners), 3, 3), np.float32)
    normals[::2] = (0.0, 0.0, 1.0)
    tangents = np.zeros((len(corners), 3, 4), np.float32)
    tangents[::2] = (1.0, 0.0, 0.0, 1.0)
    zeros = np.zeros((count, 2), np.float32)
    mesh = Mesh(
        first_index=len(scene.indices),
        index_count=count,
        base_vertex=len(scene.positions),
        material=len(scene.materials),
        bounds_min=(-0.8, -1.0, 0.0),
        bounds_max=(0.8, 1.0, 0.0),
    )
    joints, weights = scene.joints, scene.weights
    if joints is not None and weights is not None:
        joints = np.concatenate([joints, np.zeros((count, 4), joints.dtype)])
        weights = np.concatenate([weights, np.zeros((count, 4), np.float32)])
    return replace(
        scene,
        positions=np.concatenate([scene.positions, corners.reshape(-1, 3)]),
        normals=np.concatenate([scene.normals, normals.reshape(-1, 3)]),
        tangents=np.concatenate([scene.tangents, tangents.reshape(-1, 4)]),
        uv0=np.concatenate([scene.uv0, zeros]),
        uv1=np.concatenate([scene.uv1, zeros]),
        colors=np.concatenate([scene.colors, np.ones((count, 4), np.float32)]),
        indices=np.concatenate([scene.indices, np.arange(count, dtype=np.uint32)]),
        meshes=[*scene.meshes, mesh],
        materials=[*scene.materials, Material("degenerate", double_sided=True, alpha=Alpha.OPAQUE)],
        instances=[*scene.instances, Instance(len(scene.meshes), world, "degenerate")],
        joints=joints,
        weights=weights,
    )
