"""A camera inside a scene that encloses its own middle: a room, seen from a corner."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from rendergraph.scene.rays import Hits, cast, world_triangles
from rendergraph.scene.scene import F64, Camera, Scene

_ENCLOSED = 0.9  # share of the rays that must meet a wall's inner side
_APART = 0.02  # of the diagonal: how far a wall must be from the middle, and the camera from anything
_EYE = 1.6  # metres above the floor, in rooms that measure like rooms in metres


def _lattice() -> F64:
    """The 26 unit directions to the faces, edges and corners of a cube, ``float64[26, 3]``."""
    cells = np.array([cell for cell in product((-1.0, 0.0, 1.0), repeat=3) if any(cell)])
    unit: F64 = cells / np.linalg.norm(cells, axis=1, keepdims=True)
    return unit


def _level(count: int) -> F64:
    """Horizontal unit directions all around, ``float64[count, 3]``."""
    angle = (np.arange(count) + 0.5) * 2.0 * np.pi / count
    return np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=1)


_AROUND = _lattice()
_LEVEL = _level(24)


def interior_camera(scene: Scene, fov: float) -> Camera | None:
    """A camera in a corner of the room that ``scene`` is, at eye height, looking across its middle; ``None`` where the
    scene does not enclose its middle with walls that face it. ``fov`` is vertical, radians.
    """
    low, high = scene.bounds()
    diagonal = float(np.linalg.norm(high - low))
    if not 0.0 < diagonal < math.inf:
        return None
    triangles = world_triangles(scene)
    apart = _APART * diagonal
    middle = (low + high) / 2.0
    around = cast(triangles, middle, _AROUND)
    if not _encloses(around, apart):
        return None
    # Slanted rays find the floor beside a table and the ceiling beside a lamp.
    met = np.isfinite(around.distance)
    rises = around.distance[met] * _AROUND[met, 1]
    height = float(np.ptp(rises))
    middle[1] += rises.min() + (_EYE if 0.2 * height <= _EYE <= 0.6 * height else 0.6 * height)
    if not _encloses(cast(triangles, middle, _AROUND), apart):
        return None
    free = cast(triangles, middle, _LEVEL).distance
    free[~np.isfinite(free)] = 0.0  # not out of a window
    across = free + np.roll(free, len(free) // 2)
    for share in (0.85, 0.7, 0.5):
        for k in np.argsort(-np.where(free > 0.0, across, 0.0))[:2]:
            eye = middle + _LEVEL[k] * free[k] * share
            if _encloses(cast(triangles, eye, _AROUND), apart):
                # Down a little: floors show more than ceilings.
                target = middle - np.array([0.0, 0.1 * height, 0.0])
                (x, y, z), (tx, ty, tz) = eye.tolist(), target.tolist()
                return Camera((x, y, z), (tx, ty, tz), fov=fov, near=apart * 0.1, name="framing")
    return None


def _encloses(hits: Hits, apart: float) -> bool:
    """Whether nearly all of a point's rays meet faces turned towards it, and none anything within ``apart``."""
    return bool(hits.distance.min() > apart and (hits.faced & np.isfinite(hits.distance)).mean() >= _ENCLOSED)
