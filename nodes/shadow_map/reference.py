"""Shadows and cascades in float64 numpy: rays against every triangle, splits, and the corners of frustum slices."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]


def world_triangles(scene: Any) -> F64:
    """Triangles of a ``rendergraph.scene.scene.Scene`` in world space, ``float64[triangles, 3, 3]``."""
    parts = []
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        indices = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].astype(np.int64)
        corners = scene.positions[indices + mesh.base_vertex].astype(np.float64)
        parts.append((corners @ instance.world[:3, :3].T + instance.world[:3, 3]).reshape(-1, 3, 3))
    return np.concatenate(parts)


def visible(triangles: F64, points: F64, towards: F64, offset: float = 1e-4) -> npt.NDArray[np.bool_]:
    """Whether each point (``float64[k, 3]``, metres) sees light from direction ``towards`` (``float64[3]``, unit).

    Moeller and Trumbore 1997, both sides of a triangle blocking; hits closer than ``offset`` metres do not count.
    """
    a, edge_1, edge_2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(towards, edge_2)
    determinant = np.sum(edge_1 * p, axis=1)
    usable = np.abs(determinant) > 1e-14
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=usable)
    lit = np.ones(len(points), dtype=bool)
    for row, point in enumerate(points):
        s = point - a
        u = np.sum(s * p, axis=1) * inverse
        q = np.cross(s, edge_1)
        v = (q @ towards) * inverse
        t = np.sum(edge_2 * q, axis=1) * inverse
        lit[row] = not np.any(usable & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > offset))
    return lit


def splits(near: float, far: float, count: int, blend: float) -> F64:
    """View depths, metres, at which the cascades end: uniform (``blend`` 0) to logarithmic (1), ``float64[count]``."""
    fraction = np.arange(1, count + 1) / count
    uniform = near + (far - near) * fraction
    logarithmic = near * (far / near) ** fraction
    return uniform * (1.0 - blend) + logarithmic * blend


def slice_corners(inverse_view_projection: F64, view: F64, near: float, far: float) -> F64:
    """The eight world-space corners of the view frustum between two view depths, ``float64[8, 3]``."""
    corners = []
    eye = np.linalg.inv(view)[:3, 3]
    forward = -view[2, :3]
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            clip = inverse_view_projection @ np.array([x, y, 0.5, 1.0])
            ray = clip[:3] / clip[3] - eye
            ray /= ray @ forward
            corners += [eye + ray * near, eye + ray * far]
    return np.array(corners)
