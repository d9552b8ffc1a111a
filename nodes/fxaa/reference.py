"""The truth that anti-aliasing aims at, exact area coverage of half planes, and the filter itself in float64."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]

_REC601 = np.array([0.299, 0.587, 0.114])


# ---------------------------------------------------------------- the truth


def coverage(height: int, width: int, slope: float, offset: float) -> F64:
    """Share of each texel that lies below the line ``y = offset + slope * x``, in texels: ``float64[height, width]``.

    Exact: the antiderivative of a clamped line, taken between a texel's left and right border.
    """
    rows, columns = np.mgrid[:height, :width].astype(np.float64)
    left = offset + slope * columns - rows
    right = left + slope

    def integral(t: F64) -> F64:
        """Of clamp(t, 0, 1)."""
        return np.where(t <= 0, 0.0, np.where(t >= 1, t - 0.5, 0.5 * t * t))

    if slope == 0.0:
        return np.asarray(np.clip(left, 0.0, 1.0))
    return (integral(right) - integral(left)) / slope


def aliased(height: int, width: int, slope: float, offset: float) -> F64:
    """The same half plane with one sample a texel, at its centre."""
    rows, columns = np.mgrid[:height, :width].astype(np.float64)
    return np.asarray(rows + 0.5 < offset + slope * (columns + 0.5), dtype=np.float64)


# ---------------------------------------------------------------- the filter


@dataclass(frozen=True, slots=True)
class Settings:
    """The node's knobs."""

    edge_threshold: float = 0.125
    edge_minimum: float = 0.0312
    search_steps: int = 12
    subpixel: float = 0.75


def resolve(image: F64, settings: Settings) -> F64:
    """The filter, texel by texel, of encoded colour ``float64[height, width, 3]``, row 0 at the bottom."""
    luma = image @ _REC601
    out = image.copy()
    for y in range(image.shape[0]):
        for x in range(image.shape[1]):
            shift, direction = _shift(luma, x, y, settings)
            out[y, x] += shift * (_at(image, x + direction[0], y + direction[1]) - image[y, x])
    return out


def _at(grid: F64, x: int, y: int) -> F64:
    height, width = grid.shape[:2]
    return np.asarray(grid[min(max(y, 0), height - 1), min(max(x, 0), width - 1)])


def _shift(luma: F64, x: int, y: int, settings: Settings) -> tuple[float, tuple[int, int]]:
    """How far, and towards which neighbour, the texel's sample moves."""
    block = np.array([[float(_at(luma, x + i, y + j)) for i in (-1, 0, 1)] for j in (-1, 0, 1)])
    cross = block[[1, 0, 2, 1, 1], [1, 1, 1, 0, 2]]
    middle, contrast = block[1, 1], cross.max() - cross.min()
    if contrast <= max(settings.edge_minimum, cross.max() * settings.edge_threshold):
        return 0.0, (0, 0)

    weights = np.array([[1.0, 2.0, 1.0], [2.0, 0.0, 2.0], [1.0, 2.0, 1.0]]) / 12.0
    out_of_line = min(abs(float((weights * block).sum()) - middle) / contrast, 1.0)
    blend = (out_of_line * out_of_line * (3.0 - 2.0 * out_of_line)) ** 2 * settings.subpixel

    bend = np.array([1.0, -2.0, 1.0])
    line = np.array([1.0, 2.0, 1.0])
    horizontal = float(line @ np.abs(bend @ block)) + 1 / 4096 >= float(line @ np.abs(block @ bend))
    behind, ahead = (block[0, 1], block[2, 1]) if horizontal else (block[1, 0], block[1, 2])
    side, other = (1, ahead) if abs(ahead - middle) >= abs(behind - middle) else (-1, behind)
    across = (0, side) if horizontal else (side, 0)
    along = (1, 0) if horizontal else (0, 1)
    edge = 0.5 * (middle + other)
    tolerance = 0.25 * abs(middle - other)

    ends = []
    for sign in (1, -1):
        distance, difference, ended = 0.0, 0.0, False
        for step in range(settings.search_steps):
            stride = 1 if step < 4 else 2 if step < 8 else 4
            distance += stride
            px, py = x + sign * along[0] * int(distance), y + sign * along[1] * int(distance)
            difference = 0.5 * float(_at(luma, px, py) + _at(luma, px + across[0], py + across[1])) - edge
            ended = abs(difference) >= tolerance
            if ended:
                distance -= 0.5 * stride
                break
        ends.append((distance, difference))
    nearest = ends[0] if ends[0][0] < ends[1][0] else ends[1]
    if (nearest[1] < 0.0) != (middle < edge):
        blend = max(blend, 0.5 - nearest[0] / (ends[0][0] + ends[1][0]))
    return float(blend), across
