"""The blended surfaces in front of what each pixel sees, in the order in which they are drawn, by rays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.measure.truth.materials import Shading, shade_inputs
from rendergraph.measure.truth.rays import Hits, Rays
from rendergraph.measure.truth.surfaces import RINGS, Surfaces, pixel_rays
from rendergraph.scene.draw_queues import QUEUES, draw_runs
from rendergraph.scene.gpu_layout import place_textures
from rendergraph.scene.scene import Alpha

F64 = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Layers:
    """Blended surfaces, one row each: ``pixel`` int64[n] (flat), ``position`` float64[n, 3], ``shading`` of the points;
    sorted by pixel, and within one by the order of drawing.
    """

    pixel: Ints
    position: F64
    shading: Shading


def blended_layers(seen: Surfaces) -> tuple[Layers, Bools]:
    """Every blended surface nearer than the solid one, and the pixels bool[h, w] where these are known: the same draws
    are met all around the centre, none is textured, and no two touch.
    """
    scene, height, width = seen.rays.scene, *seen.hit.shape
    glass = Rays(scene, (Alpha.BLENDED,))
    draws = np.zeros(max(1, len(scene.instances)), dtype=np.int64)
    runs = draw_runs(scene, seen.camera.position, place_textures(scene))[QUEUES[Alpha.BLENDED]]
    order = [int(one) for run in runs for one in run.commands["base_instance"]]
    draws[order] = np.arange(1, len(order) + 1)
    known = np.ones(height * width, dtype=bool)
    pixel, primitive, distance, weights, front = _through(glass, seen.origins, seen.directions, seen.hits.distance)
    found = glass.primitives
    textured = np.array([any(m.textures) for m in scene.materials], dtype=bool)
    known[pixel[textured[found.material[primitive]]]] = False
    here = _signature(pixel, draws[found.instance[primitive]], height * width)
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        offset = (x * RINGS[0][0], y * RINGS[0][0])
        around = pixel_rays(seen.view, seen.camera.near, width, height, offset)
        there = _through(glass, *around, seen.hits.distance)
        known &= here == _signature(there[0], draws[found.instance[there[1]]], height * width)
    # Within a draw, triangles blend in the order of the index buffer.
    rows = np.lexsort((found.triangle[primitive], draws[found.instance[primitive]], pixel))
    pixel, primitive, front = pixel[rows], primitive[rows], front[rows]
    distance, weights = distance[rows], weights[rows]
    shading = shade_inputs(
        scene, glass.textures, found.instance[primitive], found.material[primitive], found.vertices[primitive],
        weights, front,
    )  # fmt: skip
    position = seen.origins[pixel] + distance[:, None] * seen.directions[pixel]
    return Layers(pixel, position, shading), known.reshape(height, width)


def blend(background: F64, layers: Layers, radiance: F64, over: Callable[[F64, F64, F64], F64]) -> F64:
    """``layers``' radiance float64[n, 3] put ``over`` an image float64[h, w, 3], one after the other."""
    result = background.reshape(-1, 3).copy()
    for row in range(len(layers.pixel)):
        at = layers.pixel[row]
        result[at] = over(result[at], radiance[row], layers.shading.alpha[row])
    return result.reshape(background.shape)


def _through(glass: Rays, origins: F64, directions: F64, limit: F64) -> tuple[Ints, Ints, F64, F64, Bools]:
    """Every hit before ``limit``: ray, primitive, distance, barycentrics, side."""
    parts: list[tuple[Ints, Hits]] = []
    travelled, open_ = np.zeros(len(origins)), np.arange(len(origins))
    while len(open_) and len(glass.primitives.corners):
        start = origins[open_] + travelled[open_, None] * directions[open_]
        hits = glass.nearest(start, directions[open_], cull=True)
        reached = travelled[open_] + hits.distance
        kept = reached < limit[open_]
        open_, reached, start = open_[kept], reached[kept], start[kept]
        parts.append((open_, Hits(hits.primitive[kept], reached, hits.barycentric[kept], hits.front[kept],
                                  hits.passed[kept])))  # fmt: skip
        travelled[open_] = reached + glass.self_offset(start, reached)
    ray = np.concatenate([np.zeros(0, dtype=np.int64), *(part[0] for part in parts)])
    primitive = np.concatenate([np.zeros(0, dtype=np.int64), *(part[1].primitive for part in parts)])
    distance = np.concatenate([np.zeros(0), *(part[1].distance for part in parts)])
    weights = np.concatenate([np.zeros((0, 3)), *(part[1].barycentric for part in parts)])
    front = np.concatenate([np.zeros(0, dtype=bool), *(part[1].front for part in parts)])
    return ray, primitive, distance, weights, front


def _signature(pixel: Ints, draw: Ints, count: int) -> Ints:
    """A number for the set of draws that each pixel meets, how often each: equal for equal sets."""
    total = np.zeros(count, dtype=np.int64)
    np.add.at(total, pixel, (draw + 7) * (draw * draw + 104729))
    return total
