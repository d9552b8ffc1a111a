"""The truth that anti-aliasing aims at, exact area coverage of half planes, and the filter itself in float64."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.storage import storage_error
from rendergraph.node.reference import PassRun, Truth

if TYPE_CHECKING:
    from rendergraph.nodes.fxaa import FxaaParams

F64 = npt.NDArray[np.float64]

_REC601 = np.array([0.299, 0.587, 0.114])
#: By how much a horizontal edge is preferred, so that no rounding decides between equal ones.
TIE = 1 / 4096
#: Differences of luma that float32 may get the wrong way round: a few units in the last place of sums up to 12.
DOUBT = 4e-6
#: Of float32 arithmetic in the blend (measured: 2e-7).
ARITHMETIC = 2e-6


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
    """The filter of encoded colour ``float64[height, width, 3]``, row 0 at the bottom."""
    return resolve_surely(image, settings)[0]


def resolve_surely(image: F64, settings: Settings) -> tuple[F64, npt.NDArray[np.bool_]]:
    """The filtered image, and bool[height, width]: False where float32 may decide otherwise, because two numbers that
    are compared lie within :data:`DOUBT` and yet are not equal by construction.
    """
    luma = image @ _REC601
    height, width = luma.shape
    around = np.stack([[_shifted(luma, i, j) for i in (-1, 0, 1)] for j in (-1, 0, 1)])  # [dy + 1, dx + 1, h, w]
    cross = np.stack([around[1, 1], around[0, 1], around[2, 1], around[1, 0], around[1, 2]])
    middle, contrast = luma, np.ptp(cross, axis=0)
    threshold = np.maximum(settings.edge_minimum, cross.max(axis=0) * settings.edge_threshold)
    edge = contrast > threshold
    doubt = np.abs(contrast - threshold) < DOUBT

    weights = np.array([[1.0, 2.0, 1.0], [2.0, 0.0, 2.0], [1.0, 2.0, 1.0]]) / 12.0
    mean = np.einsum("ji,jihw->hw", weights, around)
    out_of_line = np.minimum(np.abs(mean - middle) / np.where(edge, contrast, 1.0), 1.0)
    blend = (out_of_line * out_of_line * (3.0 - 2.0 * out_of_line)) ** 2 * settings.subpixel

    bend, line = np.array([1.0, -2.0, 1.0]), np.array([1.0, 2.0, 1.0])
    across_rows = np.einsum("i,ihw->hw", line, np.abs(np.einsum("j,jihw->ihw", bend, around)))
    across_columns = np.einsum("j,jhw->hw", line, np.abs(np.einsum("i,jihw->jhw", bend, around)))
    horizontal = across_rows + TIE >= across_columns
    doubt |= np.abs(across_rows + TIE - across_columns) < DOUBT

    behind = np.where(horizontal, around[0, 1], around[1, 0])
    ahead = np.where(horizontal, around[2, 1], around[1, 2])
    steeper = np.abs(ahead - middle) - np.abs(behind - middle)
    doubt |= (np.abs(steeper) < DOUBT) & (ahead != behind)
    side = np.where(steeper >= 0, 1, -1)
    other = np.where(steeper >= 0, ahead, behind)
    rows, columns = np.mgrid[:height, :width]
    dx, dy = np.where(horizontal, 0, side), np.where(horizontal, side, 0)
    half, tolerance = 0.5 * (middle + other), 0.25 * np.abs(middle - other)

    def step_off(distance: npt.NDArray[np.int64], sign: int) -> F64:
        x = columns + np.where(horizontal, sign * distance, 0)
        y = rows + np.where(horizontal, 0, sign * distance)
        return np.asarray(0.5 * (_at(luma, x, y) + _at(luma, x + dx, y + dy)) - half)

    ends = []
    for sign in (1, -1):
        reach = np.zeros_like(luma)
        last = np.zeros_like(luma)
        going = np.ones_like(edge)
        for step in range(settings.search_steps):
            stride = 1 if step < 4 else 2 if step < 8 else 4
            so_far = np.where(going, reach + stride, reach)
            difference = step_off(so_far.astype(np.int64), sign)
            ended = going & (np.abs(difference) >= tolerance)
            doubt |= going & (np.abs(np.abs(difference) - tolerance) < DOUBT)
            last = np.where(going, difference, last)
            reach = np.where(ended, so_far - 0.5 * stride, so_far)
            going &= ~ended
        ends.append((reach, last))
    (ahead_reach, ahead_last), (behind_reach, behind_last) = ends
    nearer = ahead_reach < behind_reach
    nearest = np.where(nearer, ahead_reach, behind_reach)
    last = np.where(nearer, ahead_last, behind_last)
    doubt |= ((np.abs(last) < DOUBT) & (last != 0.0)) | ((np.abs(middle - half) < DOUBT) & (middle != other))
    turns = (last < 0.0) != (middle < half)
    shift = np.where(turns, np.maximum(0.5 - nearest / (ahead_reach + behind_reach), blend), blend)
    shift = np.where(edge, shift, 0.0)[..., None]
    moved = image + shift * (_at(image, columns + dx, rows + dy) - image)
    # What is no edge is decided by the contrast alone.
    sure = np.where(edge, ~doubt, np.abs(contrast - threshold) >= DOUBT)
    return moved, sure


def _at(grid: F64, x: npt.NDArray[np.int64], y: npt.NDArray[np.int64]) -> F64:
    height, width = grid.shape[:2]
    return np.asarray(grid[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)])


def _shifted(grid: F64, x: int, y: int) -> F64:
    rows, columns = np.mgrid[: grid.shape[0], : grid.shape[1]]
    return _at(grid, columns + x, rows + y)


# ---------------------------------------------------------------- judging

#: Samples a pixel and axis of the truth: 64 in all, whose own error is a sixteenth of the aliased image's.
FACTOR = 8


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``filter``: the algorithm in float64. ``coverage``: the input drawn with 64 samples a pixel."""
    params: FxaaParams = run.params  # type: ignore[assignment]
    source, out = (np.asarray(content, np.float64) for content in (run.inputs["color"], run.outputs["color"]))
    format = run.descs["color"].format  # type: ignore[union-attr]
    stored = float(storage_error(format, np.ones(3))[0])
    settings = Settings(params.edge_threshold, params.edge_minimum, params.search_steps, params.subpixel)
    value, sure = resolve_surely(source[..., :3], settings)
    return {
        "filter": Truth(value, judged=out[..., :3], mask=sure, tolerance=stored + ARITHMETIC),
        "coverage": _coverage(run, source[..., :3], out[..., :3], stored),
    }


def _coverage(run: PassRun, source: F64, out: F64, stored: float) -> Truth:
    """Against the supersampled input; the tolerance is the unfiltered input's own error, which the filter must not
    exceed. Nowhere known where the input does not grow with the frame.
    """
    try:
        truth = run.supersampled("color", FACTOR)[..., :3] if run.supersampled else None
    except RenderGraphError:
        truth = None
    if truth is None:
        return Truth(source, judged=out, mask=np.zeros(out.shape[:2], bool))
    aliased = float(np.sqrt(np.mean((source - truth) ** 2)))
    return Truth(truth, judged=out, tolerance=aliased + stored)


def invariants(run: PassRun) -> Iterator[str]:
    """Every texel lies between the least and the largest of its neighbourhood of 3 x 3, and alpha is passed on."""
    source, out = (np.asarray(content, np.float64) for content in (run.inputs["color"], run.outputs["color"]))
    slack = storage_error(run.descs["color"].format, np.ones(out.shape[-1])) + ARITHMETIC  # type: ignore[union-attr]
    around = np.stack([_shifted(source, i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    below, above = out < around.min(axis=0) - slack, out > around.max(axis=0) + slack
    if below[..., :3].any() or above[..., :3].any():
        yield "a texel leaves the range of its neighbourhood"
    if source.shape[-1] == out.shape[-1] == 4 and not (np.abs(out[..., 3] - source[..., 3]) <= slack[3]).all():
        yield "alpha is not the input's"
