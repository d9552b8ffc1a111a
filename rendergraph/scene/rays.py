"""What rays from one point of a scene hit: every triangle against every ray, without an acceleration structure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import F32, F64, Scene

_AT_ONCE = 3072  # triangles tested together: products stay in the cache, and too small to be worth threads to BLAS


@dataclass(frozen=True, slots=True)
class Triangles:
    """A scene's triangles in the world: ``corners`` float64[3, t, 3] counter-clockwise from the front, metres;
    ``double_sided`` bool[t].
    """

    corners: F64
    double_sided: npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Hits:
    """The nearest hit of each ray: ``distance`` float64[d], infinite where there is none; ``faced`` bool[d], whether
    its triangle shows a face to the ray.
    """

    distance: F64
    faced: npt.NDArray[np.bool_]


def world_triangles(scene: Scene) -> Triangles:
    """Every triangle of every instance, as placed at rest. Mirroring transforms keep their fronts outside."""
    corners, sided = [np.zeros((3, 0, 3))], [np.zeros(0, dtype=bool)]
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        indices = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].astype(np.int64)
        if len(indices) == 0:
            continue
        linear = instance.world[:3, :3]
        used = scene.positions[mesh.base_vertex : mesh.base_vertex + int(indices.max()) + 1]
        points = used.astype(np.float64) @ linear.T + instance.world[:3, 3]
        order = (0, 2, 1) if np.linalg.det(linear) < 0.0 else (0, 1, 2)
        corners.append(np.stack([points[indices[k::3]] for k in order]))
        sided.append(np.full(len(indices) // 3, scene.materials[mesh.material].double_sided))
    return Triangles(np.concatenate(corners, axis=1), np.concatenate(sided))


def cast(triangles: Triangles, origin: F64, directions: F64) -> Hits:
    """Nearest hits of rays from ``origin`` float64[3] along unit ``directions`` float64[d, 3].

    A ray d meets the triangle abc, given from its origin, where the volumes d.(b x c), d.(c x a) and d.(a x b) have one
    sign; their sum is d.n of its normal n (Kensler and Shirley, "Optimizing ray-triangle intersection via automated
    search", 2006). What depends on the triangle alone is computed once for all directions.
    """
    nearest = np.full(len(directions), np.inf)
    faced = np.zeros(len(directions), dtype=bool)
    towards: F32 = directions.astype(np.float32)
    for start in range(0, triangles.corners.shape[1], _AT_ONCE):
        run = slice(start, start + _AT_ONCE)
        a, b, c = (triangles.corners[:, run] - origin).astype(np.float32)
        bc, ca, ab = _cross(b, c), _cross(c, a), _cross(a, b)
        u, v, w = towards @ bc.T, towards @ ca.T, towards @ ab.T
        least, most = np.minimum(np.minimum(u, v), w), np.maximum(np.maximum(u, v), w)
        ray, triangle = np.nonzero((least >= 0) | (most <= 0))
        along = u[ray, triangle] + v[ray, triangle] + w[ray, triangle]
        volume = (a * bc).sum(axis=1)[triangle]
        ahead = (along != 0) & (volume * along > 0)
        triangle, ray, along, volume = triangle[ahead], ray[ahead], along[ahead], volume[ahead]
        distance = volume.astype(np.float64) / along
        farthest_first = np.argsort(-distance)
        triangle, ray, along, distance = (x[farthest_first] for x in (triangle, ray, along, distance))
        best = np.full(len(directions), np.inf)
        shown = np.zeros(len(directions), dtype=bool)
        best[ray], shown[ray] = distance, (along < 0) | triangles.double_sided[run][triangle]  # the last write stays
        closer = best < nearest
        nearest[closer], faced[closer] = best[closer], shown[closer]
    return Hits(nearest, faced)


def _cross(a: F32, b: F32) -> F32:
    """``np.cross`` of float32[t, 3] by columns, several times as fast."""
    (ax, ay, az), (bx, by, bz) = a.T, b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
