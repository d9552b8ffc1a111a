"""What the sun sees of a scene: a layer of its shadow map by rays through texels, in float64."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from rendergraph.measure.truth.rays import Hits, Rays

F64 = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


class LightView:
    """A scene's casters seen along the sun's light: a layer of the map by rays through its texels."""

    def __init__(self, rays: Rays, to_clip: F64, towards: F64, size: int, slope_bias: float, reversed: bool) -> None:
        self._rays, self._towards, self._reversed = rays, towards, reversed
        self._bias = slope_bias
        # Clip space to texels and depth, all of it linear: the light's rays are parallel.
        window = np.diag([0.5 * size, 0.5 * size, 1.0, 1.0])
        window[:2, 3] = 0.5 * size
        self._to_window = window @ to_clip
        self._to_world = np.linalg.inv(self._to_window)

    def trace(self, x: F64, y: F64) -> tuple[F64, F64, Bools]:
        """Depth as the map stores it, its slope (the larger derivative by x or y, a texel) and whether it is known, at
        places in texels, float64[n] each.

        A caster is pushed away by its slope, so a second one behind it can be the nearest: all those count that start
        before the nearest so far ends.
        """
        n = len(x)
        start = (np.stack([x, y, np.zeros(n), np.ones(n)], axis=1) @ self._to_world.T)[:, :3]
        middle, reach = self._rays.middle, 2.0 * self._rays.extent
        start += self._towards * (((middle - start) @ self._towards) + reach)[:, None]
        away = np.broadcast_to(-self._towards, start.shape)
        nearest, slope, sure = np.full(n, np.inf), np.zeros(n), np.ones(n, dtype=bool)
        travelled, open_ = np.zeros(n), np.arange(n)
        last, bumps = np.full(n, -1, dtype=np.int64), np.zeros(n)
        while len(open_):
            origins = start[open_] + travelled[open_, None] * away[open_]
            hits = self._rays.nearest(origins, away[open_])
            sure[open_] &= ~hits.passed
            distance = travelled[open_] + np.where(hits.hit, hits.distance, 0.0)
            farness, rise = self._farness(start[open_] + distance[:, None] * away[open_], hits)
            going = hits.hit & (farness < nearest[open_])
            pushed = farness + self._bias * rise
            better = going & (pushed < nearest[open_])
            nearest[open_[better]], slope[open_[better]] = pushed[better], rise[better]
            # A triangle met again, edge-on or from too far for float32, is left behind in growing steps.
            again = hits.primitive == last[open_]
            bumps[open_] = np.where(again, 2.0 * bumps[open_], self._rays.self_offset(origins, distance))
            last[open_] = hits.primitive
            travelled[open_] = np.maximum(distance, travelled[open_]) + bumps[open_]
            open_ = open_[going]
        stored = np.clip(nearest, 0.0, 1.0)
        return 1.0 - stored if self._reversed else stored, slope, sure

    def _farness(self, points: F64, hits: Hits) -> tuple[F64, F64]:
        """Of points on triangles: 0 nearest to the sun to 1, whatever the depth convention, and its slope."""
        depth = points @ self._to_window[2, :3] + self._to_window[2, 3]
        corners = self._rays.primitives.corners[np.maximum(hits.primitive, 0)] @ self._to_window[:3, :3].T
        ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        normal = np.cross(ab, ac)
        across = np.abs(normal[:, :2]).max(axis=1)
        slope = np.divide(across, np.abs(normal[:, 2]), out=np.full(len(across), np.inf), where=normal[:, 2] != 0.0)
        return 1.0 - depth if self._reversed else depth, slope
