"""Small scenes for rays: parallelograms of one material each, in the world or placed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rendergraph.scene.scene import Image, Instance, Material, Mesh, Scene

MATT = Material(metallic=0.0)


def quads(
    corners: Sequence[Sequence[Sequence[float]]],
    materials: Sequence[Material] = (MATT,),
    *,
    of: Sequence[int] = (),
    images: Sequence[Image] = (),
    world: np.ndarray | None = None,
) -> Scene:
    """Each of ``corners`` is (corner, u, v); its front looks along u x v; texture coordinates run 0..1 along u and v.

    ``of``: the material of each, by default the first. An instance a quad.
    """
    points, normals, tangents, meshes, instances = [], [], [], [], []
    for index, (corner, u, v) in enumerate(np.array(corners, dtype=np.float64)):
        places = np.array([corner, corner + u, corner + u + v, corner + v])
        normal = np.cross(u, v)
        points.append(places)
        normals.append(np.tile(normal / np.linalg.norm(normal), (4, 1)))
        tangents.append(np.tile([*(u / np.linalg.norm(u)), 1.0], (4, 1)))
        low, high = tuple(places.min(0).tolist()), tuple(places.max(0).tolist())
        meshes.append(Mesh(0, 6, 4 * index, of[index] if of else 0, low, high))
        instances.append(Instance(index, np.eye(4) if world is None else world))
    uv = np.tile(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32), (len(corners), 1))
    return Scene(
        name="quads",
        positions=np.array(points, dtype=np.float32).reshape(-1, 3),
        normals=np.array(normals, dtype=np.float32).reshape(-1, 3),
        tangents=np.array(tangents, dtype=np.float32).reshape(-1, 4),
        uv0=uv,
        uv1=uv,
        colors=np.ones((len(uv), 4), dtype=np.float32),
        indices=np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32),
        meshes=meshes,
        instances=instances,
        materials=list(materials),
        images=list(images),
    )


def square(z: float, half: float = 1.0) -> list[list[float]]:
    """The square of side 2 ``half`` around the z axis that faces +z."""
    return [[-half, -half, z], [2 * half, 0, 0], [0, 2 * half, 0]]
