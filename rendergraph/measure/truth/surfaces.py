"""What a camera sees, by rays through the pixels' centres: the truth of everything that a rasteriser stores.

A rasteriser moves vertices to a grid of 1/256 pixel and tests depths with the depth buffer's precision, so where a
surface ends, which surface a pixel's centre sees is not known; nor is a texture's value where its mip levels mix.
:class:`Surfaces` tells where.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import product

import numpy as np

from rendergraph.measure.truth.materials import Shading, coordinates, shade_inputs, shading_normal, transformed
from rendergraph.measure.truth.rays import Bools, Hits, Ints, Rays
from rendergraph.plan.graph import Frame
from rendergraph.run.frame_constants import View, camera_view
from rendergraph.scene.scene import F64, Alpha, Camera, Scene

#: Pixels off a centre, as far as the same surface must be seen, and the share of the distance that it may leave its
#: tangent plane by there: a smooth surface's bend, and what one triangle's plane does not give away of its neighbour's.
RINGS = ((1.0 / 8.0, 2e-3), (1.0 / 128.0, 1e-6))
_CORNERS = ((-1, -1), (-1, 1), (1, -1), (1, 1))
_BEND = np.cos(np.radians(15.0))


@dataclass(frozen=True, eq=False)
class Surfaces:
    """What each pixel's centre sees, rows bottom-up: arrays [h, w, ...], zero where nothing is ``hit``.

    ``position`` and ``geometric_normal`` (unit, towards the viewer) in the world, metres; ``view_depth`` metres in
    front of the camera; ``depth`` as the frame's depth buffer stores it, its far value where nothing is hit. ``known``
    bool: the same surface is seen all around the centre, and no cut-out texel in front of it; background is known
    where it is seen all around. Blended surfaces are looked through.
    """

    rays: Rays
    camera: Camera
    view: View
    hits: Hits  # of all pixels, flat, as are the rays
    origins: F64
    directions: F64
    hit: Bools
    position: F64
    geometric_normal: F64
    view_depth: F64
    depth: F64
    known: Bools

    @cached_property
    def shading(self) -> Shading:
        """Materials and shading normals of the pixels that are hit, in the order of ``position[hit]``."""
        seen, of = self._seen
        found = self.rays.primitives
        return shade_inputs(
            self.rays.scene, self.rays.textures, found.instance[of], found.material[of], found.vertices[of],
            self.hits.barycentric[seen], self.hits.front[seen],
        )  # fmt: skip

    @cached_property
    def magnified_slots(self) -> Bools:
        """bool[h, w, 5]: the texture in each slot of the pixel's material is not minified, so that its first mip level
        alone decides; True without a texture.
        """
        seen, of = self._seen
        rays, found = self.rays, self.rays.primitives
        largest = np.zeros((len(of), 5))
        steps = [self._step(seen, of, axis) for axis in (0, 1)]
        for index in np.unique(found.material[of]):
            rows = np.nonzero(found.material[of] == index)[0]
            for slot, use in enumerate(rays.scene.materials[index].textures):
                if use is None:
                    continue
                here, *there = (
                    transformed(use, coordinates(rays.scene, use, found.vertices[of[rows]], weights[rows]))
                    for weights in (self.hits.barycentric[seen], *steps)
                )
                for moved in there:
                    texels = np.abs(moved - here).sum(axis=1) * rays.textures.size(use)
                    largest[rows, slot] = np.maximum(largest[rows, slot], texels)
        # The level of detail is taken from differences over a quad of pixels, so not 1.
        return self.image(largest < 0.9).astype(bool)

    @cached_property
    def magnified(self) -> Bools:
        """bool[h, w]: no texture of the pixel's material is minified."""
        return np.asarray(self.magnified_slots.all(axis=2))

    @cached_property
    def textured(self) -> Bools:
        """bool[h, w, 5]: the pixel's material has a texture in the slot."""
        has = np.array([[use is not None for use in m.textures] for m in self.rays.scene.materials], dtype=bool)
        return self.image(has.reshape(-1, 5)[self.rays.primitives.material[self._seen[1]]]).astype(bool)

    @cached_property
    def behind_blended(self) -> Bools:
        """bool[h, w]: a blended surface that faces the eye lies in front of what is seen, or right at its edge."""
        height, width = self.hit.shape
        glass = Rays(self.rays.scene, (Alpha.BLENDED,))
        covered = np.zeros(height * width, dtype=bool)
        limit = self.hits.distance
        for x, y in ((0, 0), *_CORNERS):
            offset = (x * RINGS[0][0], y * RINGS[0][0])
            origins, directions = pixel_rays(self.view, self.camera.near, width, height, offset)
            covered |= glass.nearest(origins, directions, cull=True).distance < limit
        return covered.reshape(height, width)

    def image(self, values: F64 | Bools) -> F64:
        """Values of the pixels that are hit, float64[n, ...], as an image float64[h, w, ...] with zeros elsewhere."""
        result = np.zeros((*self.hit.shape, *values.shape[1:]))
        result[self.hit] = values
        return result

    @property
    def _seen(self) -> tuple[Ints, Ints]:
        seen = np.nonzero(self.hits.hit)[0]
        return seen, self.hits.primitive[seen]

    def _step(self, seen: Ints, of: Ints, axis: int) -> F64:
        """Barycentrics where the plane of each pixel's triangle is met one pixel to the right (0) or above (1)."""
        height, width = self.hit.shape
        offset = (1.0, 0.0) if axis == 0 else (0.0, 1.0)
        origins, directions = pixel_rays(self.view, self.camera.near, width, height, offset)
        _, weights, _ = self.rays.refine(of, origins[seen], directions[seen])
        return weights


def trace_surfaces(scene: Scene, camera: Camera, frame: Frame, rays: Rays | None = None) -> Surfaces:
    """Trace a frame's pixels.

    :raises RenderGraphError: RG743 where embree is not installed.
    """
    rays = rays or Rays(scene)
    view = camera_view(camera, frame)
    width, height = frame.width, frame.height
    origins, directions = pixel_rays(view, camera.near, width, height)
    hits = _clipped(rays.nearest(origins, directions, cull=True), origins, directions, view, camera)
    shape = (height, width)
    position = np.zeros((height * width, 3))
    position[hits.hit] = (origins + np.where(hits.hit, hits.distance, 0.0)[:, None] * directions)[hits.hit]
    normal = geometric_normals(rays, hits, directions)
    view_depth = np.where(hits.hit, -(position @ view.view[2, :3] + view.view[2, 3]), 0.0)
    far = 0.0 if frame.depth == "reversed" else 1.0
    a, b = view.projection[2, 2], view.projection[2, 3]
    depth = np.divide(b, view_depth, out=np.full_like(view_depth, far + a), where=hits.hit) - a
    known = ~hits.passed
    for (reach, step), (x, y) in product(RINGS, _CORNERS):
        there = pixel_rays(view, camera.near, width, height, (x * reach, y * reach))
        around = _clipped(rays.nearest(*there, cull=True), *there, view, camera)
        known &= _same_surface(rays, hits, around, *there, step)
    return Surfaces(
        rays, camera, view, hits, origins, directions, hits.hit.reshape(shape), position.reshape(*shape, 3),
        normal.reshape(*shape, 3), view_depth.reshape(shape), depth.reshape(shape), known.reshape(shape),
    )  # fmt: skip


def cached_trace(scene: Scene, camera: Camera, frame: Frame) -> Callable[[], Surfaces]:
    """:func:`trace_surfaces`, done when first called."""
    return lru_cache(maxsize=1)(lambda: trace_surfaces(scene, camera, frame))


def pixel_rays(
    view: View, near: float, width: int, height: int, offset: tuple[float, float] = (0.0, 0.0)
) -> tuple[F64, F64]:
    """Origins (on the near plane, ``near`` metres away) and unit directions float64[h * w, 3] of rays through pixels,
    ``offset`` pixels off their centres; world space.
    """
    x = (np.arange(width) + 0.5 + offset[0]) / width * 2.0 - 1.0
    y = (np.arange(height) + 0.5 + offset[1]) / height * 2.0 - 1.0
    p = view.projection
    right, up = np.meshgrid((x + p[0, 2]) / p[0, 0], (y + p[1, 2]) / p[1, 1])
    local = np.stack([right, up, np.full_like(right, -1.0)], axis=-1).reshape(-1, 3)
    directions = local @ view.view[:3, :3]
    eye = -view.view[:3, :3].T @ view.view[:3, 3]
    return eye + near * directions, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def geometric_normals(rays: Rays, hits: Hits, directions: F64) -> F64:
    """Unit normals of the triangles that are hit, turned against the rays, float64[n, 3]; zero elsewhere."""
    result = np.zeros((len(hits.primitive), 3))
    a, b, c = np.moveaxis(rays.primitives.corners[hits.primitive[hits.hit]], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    towards = np.sum(normal * directions[hits.hit], axis=1, keepdims=True) > 0.0
    result[hits.hit] = np.where(towards, -normal, normal)
    return result


def _clipped(hits: Hits, origins: F64, directions: F64, view: View, camera: Camera) -> Hits:
    """Without what lies beyond the far plane."""
    if camera.far is None:
        return hits
    points = origins + np.where(hits.hit, hits.distance, 0.0)[:, None] * directions
    beyond = -(points @ view.view[2, :3] + view.view[2, 3]) > camera.far
    return replace(
        hits, primitive=np.where(beyond, -1, hits.primitive), distance=np.where(beyond, np.inf, hits.distance)
    )


def _same_surface(rays: Rays, hits: Hits, around: Hits, origins: F64, directions: F64, step: float) -> Bools:
    """Whether rays next to the pixels' centres see what the centres see: no edge, step or crease between."""
    same = hits.hit == around.hit
    both = np.nonzero(hits.hit & around.hit)[0]
    found = rays.primitives
    here, there = hits.primitive[both], around.primitive[both]
    expected, _, _ = rays.refine(here, origins[both], directions[both])
    leaves = np.abs(expected - around.distance[both]) > step * around.distance[both]
    normals = [
        shading_normal(rays.scene, found.instance[of], found.vertices[of], weights[both], None)
        for of, weights in ((here, hits.barycentric), (there, around.barycentric))
    ]
    crease = np.sum(normals[0] * normals[1], axis=1) < _BEND
    same[both] &= (found.instance[here] == found.instance[there]) & ((here == there) | ~(leaves | crease))
    same &= ~around.passed
    return np.asarray(same)
