"""Where everything of a sweep's plot lies, for the page's SVG and for the PNG: time across, error up, bytes by size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10, sqrt
from typing import Any, Final

from rendergraph.report.accuracy_table import shown
from rendergraph.report.tables import mebibytes

#: Largest over smallest, from which on an axis is logarithmic.
_LOGARITHMIC: Final = 12.0
_RADII: Final = (5.0, 13.0)  # px, of the least and the most bytes


@dataclass(frozen=True, slots=True)
class Scale:
    """Values to pixels, and the values that are marked."""

    low: float
    high: float
    start: float
    end: float
    logarithmic: bool
    ticks: tuple[tuple[float, str], ...]  # px, label

    def at(self, value: float) -> float:
        """Where a value lies; values beyond the ends lie at them."""
        return _at(self, value)


@dataclass(frozen=True, slots=True)
class Bubble:
    """One setting: centre, limits of its time, radius, and what is said of it."""

    index: int
    x: float
    y: float
    left: float
    right: float
    radius: float
    front: bool
    recommended: bool
    own: bool
    label: str


@dataclass(frozen=True, slots=True)
class Plot:
    """A plot of ``width`` x ``height`` pixels, y downwards. ``steps`` is the front as a staircase of corners."""

    width: float
    height: float
    x: Scale
    y: Scale
    bubbles: tuple[Bubble, ...]
    steps: tuple[tuple[float, float], ...]


def sweep_plot(record: dict[str, Any], width: float = 960.0, height: float = 460.0) -> Plot | None:
    """The plot of a sweep record; None where no setting has both a time and an error."""
    chosen = record["recommended"]["point"] if record["recommended"] else None
    shown_points = [
        (index, point)
        for index, point in [*enumerate(record["points"]), (-1, record["control"])]
        if point["ms"] is not None and isinstance(point["error"], int | float)
        and not (index == -1 and any(other["own"] for other in record["points"]))
    ]  # fmt: skip
    if not shown_points:
        return None
    times = [point["ms"]["estimate"] for _, point in shown_points]
    # Whiskers too, unless they would squeeze everything else.
    limits = [point["ms"][end] for _, point in shown_points for end in ("low", "high")]
    times += [t for t in limits if isinstance(t, int | float) and min(times) / 1.3 <= t <= max(times) * 1.3]
    errors = [point["error"] for _, point in shown_points]
    x = scale(times, 78.0, width - 24.0)
    y = scale(errors, height - 56.0, 18.0)
    largest = max(point["bytes"] for _, point in shown_points) or 1
    bubbles = []
    for index, point in shown_points:
        low, high = point["ms"]["low"], point["ms"]["high"]
        share = sqrt(point["bytes"] / largest)
        bubbles.append(
            Bubble(
                index, x.at(point["ms"]["estimate"]), y.at(point["error"]), x.at(low),
                x.at(high if isinstance(high, int | float) else x.high),
                _RADII[0] + (_RADII[1] - _RADII[0]) * share, point["front"], index == chosen, point["own"],
                setting_label(point),
            )
        )  # fmt: skip
    # Large ones first, so that none hides a smaller one.
    bubbles.sort(key=lambda bubble: (bubble.recommended, bubble.front, -bubble.radius))
    return Plot(width, height, x, y, tuple(bubbles), staircase([(b.x, b.y) for b in bubbles if b.front]))


def setting_label(point: dict[str, Any]) -> str:
    """A setting and what it costs, in one line."""
    values = [override.removeprefix("passes.").replace(".set.", ".") for override in point["set"]]
    name = ", ".join(values) or "as the document is"
    ms = point["ms"]
    time = f"{ms['estimate']:.3f} ms" if ms else "refused"
    return f"{name}: {time}, {mebibytes(point['bytes'])}, error {shown(point['error'])}"


def staircase(corners: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The lower left border of points, y downwards (so that a smaller error is a larger y): what is better in both."""
    steps: list[tuple[float, float]] = []
    for x, y in sorted(corners, key=lambda corner: (corner[0], -corner[1])):
        if not steps or y > steps[-1][1]:
            if steps:
                steps.append((x, steps[-1][1]))
            steps.append((x, y))
    return tuple(steps)


def scale(values: Sequence[float], start: float, end: float) -> Scale:
    """A scale that holds all values with some room: logarithmic over a wide range of positive ones, else from about
    the least one on.
    """
    known = [value for value in values if isfinite(value)]
    low, high = min(known, default=0.0), max(known, default=1.0)
    if low > 0.0 and high / low > _LOGARITHMIC:
        low, high = low / 1.25, high * 1.25
        decades = range(floor(log10(low)), ceil(log10(high)) + 1)
        marks = [m * 10.0**d for d in decades for m in (1.0, 2.0, 5.0) if low <= m * 10.0**d <= high]
        bare = Scale(low, high, start, end, True, ())
    else:
        room = 0.08 * (high - low) or abs(high) * 0.1 or 1.0
        low, high = max(0.0, low - room) if low >= 0.0 else low - room, high + room
        step = _step((high - low) / 5.0)
        marks = [k * step for k in range(ceil(low / step), floor(high / step) + 1)]
        bare = Scale(low, high, start, end, False, ())
    ticks = tuple((bare.at(mark), f"{mark:.4g}") for mark in marks)
    return Scale(bare.low, bare.high, start, end, bare.logarithmic, ticks)


def _at(scale: Scale, value: float) -> float:
    value = min(max(value, scale.low), scale.high)
    low, high = scale.low, scale.high
    if scale.logarithmic:
        value, low, high = log10(value), log10(low), log10(high)
    return round(scale.start + (value - low) / (high - low) * (scale.end - scale.start), 2)


def _step(rough: float) -> float:
    """A round number near ``rough``."""
    power = 10.0 ** floor(log10(rough))
    return next(m * power for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * power >= rough * 0.999)
