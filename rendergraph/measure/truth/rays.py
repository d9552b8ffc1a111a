"""What rays hit: embree finds the triangle in float32, and the hit is computed again on it in float64.

Three rules make single precision good enough to point at the right triangle:

* Geometry and origins are taken relative to the middle of the scene before they become float32, so a scene far from
  the world's origin loses nothing.
* A ray that starts on a surface starts ``offset`` along itself: eight float32 roundings of the largest coordinate
  involved (:func:`self_offset`). Hits nearer than that are not seen.
* A ray that must go on behind a hit (a cut-out texel, a culled back) starts again one such offset behind it; where it
  meets the same triangle once more the offset doubles, so it always gets through.

Which of two surfaces closer together than the offset comes first is not known.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.truth.materials import Textures, is_cut_out
from rendergraph.scene.scene import F64, Alpha, Scene

Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

SOLID = (Alpha.OPAQUE, Alpha.MASKED)
_ROUNDINGS = 8.0 * 2.0**-24


@dataclass(frozen=True, slots=True)
class Primitives:
    """Triangles in the world: ``corners`` float64[t, 3, 3] (corner, xyz) counter-clockwise from the front, metres;
    ``vertices`` int64[t, 3] into the scene's pools; ``instance``, ``mesh``, ``material`` and ``triangle`` (of its mesh)
    int64[t].
    """

    corners: F64
    vertices: Ints
    instance: Ints
    mesh: Ints
    material: Ints
    triangle: Ints


@dataclass(frozen=True, slots=True)
class Hits:
    """Where rays went. ``primitive`` int64[n], -1 for none; ``distance`` float64[n] along the unit direction, infinite
    for none; ``barycentric`` float64[n, 3]; ``front`` bool[n]: the front was hit; ``passed`` bool[n]: a cut-out texel
    was passed on the way.
    """

    primitive: Ints
    distance: F64
    barycentric: F64
    front: Bools
    passed: Bools

    @property
    def hit(self) -> Bools:
        """Which rays hit something."""
        return self.primitive >= 0


class Rays:
    """A scene's triangles under embree, those of the materials whose alpha is one of ``alphas``.

    :raises RenderGraphError: RG743 where embree is not installed.
    """

    def __init__(self, scene: Scene, alphas: tuple[Alpha, ...] = SOLID) -> None:
        self.scene = scene
        self.primitives = primitives(scene, alphas)
        self.textures = Textures(scene)
        materials = scene.materials
        self._masked = np.array([m.alpha is Alpha.MASKED for m in materials], dtype=bool)
        self._double_sided = np.array([m.double_sided for m in materials], dtype=bool)
        corners = self.primitives.corners
        self.middle = np.zeros(3)
        if len(corners):
            self.middle = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
        self.extent = float(np.abs(corners - self.middle).max()) if len(corners) else 0.0
        self._embree = _embree(corners - self.middle)

    def nearest(self, origins: F64, directions: F64, *, cull: bool = False) -> Hits:
        """The first solid surface along each ray: float64[n, 3] origins, metres, and unit directions.

        Alpha-tested surfaces let rays through where the base colour's alpha (bilinear, first mip level) is below the
        cutoff. ``cull``: the backs of single-sided materials let them through, too, as a rasteriser's do.
        """
        count = len(origins)
        start, bumps = np.zeros(count), np.zeros(count)
        passed = np.zeros(count, dtype=bool)
        last = np.full(count, -1, dtype=np.int64)
        result = Hits(last.copy(), np.full(count, np.inf), np.zeros((count, 3)), np.zeros(count, dtype=bool), passed)
        rays = np.arange(count)
        while len(rays) and len(self.primitives.corners):
            found = self._first(origins[rays], directions[rays], start[rays])
            rays, found = rays[found >= 0], found[found >= 0]
            distance, barycentric, front = self.refine(found, origins[rays], directions[rays])
            material = self.primitives.material[found]
            through = np.zeros(len(rays), dtype=bool)
            masked = self._masked[material]
            through[masked] = self._cut_out(found[masked], barycentric[masked])
            passed[rays] |= through
            if cull:
                through |= ~front & ~self._double_sided[material]
            here, kept = rays[~through], ~through
            result.primitive[here], result.distance[here] = found[kept], distance[kept]
            result.barycentric[here], result.front[here] = barycentric[kept], front[kept]
            rays, found, distance = rays[through], found[through], distance[through]
            bumps[rays] = np.where(found == last[rays], 2.0 * bumps[rays], self.self_offset(origins[rays], distance))
            last[rays] = found
            start[rays] = np.maximum(distance, start[rays]) + bumps[rays]
        return result

    def occluded(self, origins: F64, directions: F64, far: F64 | float = np.inf) -> Bools:
        """Whether something solid lies between each origin and ``far`` metres along its direction; both faces block.

        Origins that lie on a surface must be moved off it first: :meth:`leave`.
        """
        return np.asarray(self.nearest(origins, directions).distance < far)

    def leave(self, points: F64, normals: F64, directions: F64) -> F64:
        """Points on surfaces with unit geometric normals float64[n, 3], moved off them to the side that the rays
        leave to, by :meth:`self_offset`.
        """
        side = np.where(np.sum(normals * directions, axis=-1) < 0.0, -1.0, 1.0)
        reach = np.zeros(len(points))
        return np.asarray(points + normals * (side * self.self_offset(points, reach))[:, None])

    def self_offset(self, origins: F64, distance: F64) -> F64:
        """How far behind a point of a ray float32 is sure to tell another point from it, metres, float64[n]."""
        largest = np.maximum(np.abs(origins - self.middle).max(axis=1), self.extent)
        return np.asarray(_ROUNDINGS * (largest + distance))

    def _first(self, origins: F64, directions: F64, start: F64) -> Ints:
        begin = (origins + start[:, None] * directions - self.middle).astype(np.float32)
        if not len(begin):
            return np.zeros(0, dtype=np.int64)
        found = self._embree.run(begin, directions.astype(np.float32))
        return np.asarray(found, dtype=np.int64)

    def refine(self, primitive: Ints, origins: F64, directions: F64) -> tuple[F64, F64, Bools]:
        """Distance, barycentrics and side on the plane of a known triangle (Moeller and Trumbore, 1997)."""
        a, b, c = np.moveaxis(self.primitives.corners[primitive], 1, 0)
        ab, ac, s = b - a, c - a, origins - a
        p = np.cross(directions, ac)
        determinant = np.sum(ab * p, axis=1)
        inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=determinant != 0.0)
        q = np.cross(s, ab)
        u, v = np.sum(s * p, axis=1) * inverse, np.sum(directions * q, axis=1) * inverse
        return np.sum(ac * q, axis=1) * inverse, np.stack([1.0 - u - v, u, v], axis=1), determinant > 0.0

    def _cut_out(self, primitive: Ints, barycentric: F64) -> Bools:
        return is_cut_out(self.scene, self.textures, self.primitives.material[primitive],
                          self.primitives.vertices[primitive], barycentric)  # fmt: skip


def primitives(scene: Scene, alphas: tuple[Alpha, ...] = SOLID) -> Primitives:
    """Every triangle of every instance as placed at rest. Mirroring transforms keep their fronts outside."""
    corners, vertices, owners = [np.zeros((0, 3, 3))], [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 4), np.int64)]
    for index, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if scene.materials[mesh.material].alpha not in alphas:
            continue
        run = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].astype(np.int64) + mesh.base_vertex
        run = run.reshape(-1, 3)
        linear = instance.world[:3, :3]
        if np.linalg.det(linear) < 0.0:
            run = run[:, ::-1]
        corners.append(scene.positions[run].astype(np.float64) @ linear.T + instance.world[:3, 3])
        vertices.append(run)
        owner = np.empty((len(run), 4), dtype=np.int64)
        owner[:] = (index, instance.mesh, mesh.material, 0)
        owner[:, 3] = np.arange(len(run))
        owners.append(owner)
    instance_of, mesh_of, material_of, triangle = np.concatenate(owners).T
    return Primitives(np.concatenate(corners), np.concatenate(vertices), instance_of, mesh_of, material_of, triangle)


def _embree(corners: F64) -> Any:
    try:
        scenes = importlib.import_module("embreex.rtcore_scene")
        meshes = importlib.import_module("embreex.mesh_construction")
    except ImportError as error:
        raise RenderGraphError([diagnose("RG743")], exit_code=3) from error
    built = scenes.EmbreeScene()
    if len(corners):
        meshes.TriangleMesh(built, corners.astype(np.float32))
    return built
