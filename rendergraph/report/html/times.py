"""The bars of the page's time section: medians, their spread, and a tick a sample, on one axis for all passes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

#: The axis in parts; ticks closer than one part cannot be told apart, and are drawn once.
AXIS = 1000
#: Samples further out than this many times the longest median would squeeze every bar: they are drawn at the end.
_FARTHEST = 1.6


@dataclass(frozen=True, slots=True)
class TimeBar:
    """A row: milliseconds, and positions on the axis. ``late`` counts samples beyond its end."""

    name: str
    detail: str
    median: float
    low: float
    high: float
    share: float
    length: int
    spread: tuple[int, int]
    ticks: str  # an SVG path
    late: int
    inside: tuple[TimeBar, ...] = ()


@dataclass(frozen=True, slots=True)
class TimeChart:
    """Whole-frame rows, pass rows in execution order, and the labelled positions of the axis of either."""

    frame: tuple[TimeBar, ...]
    passes: tuple[TimeBar, ...]
    frame_marks: tuple[tuple[int, str], ...]
    marks: tuple[tuple[int, str], ...]
    samples: int


def time_chart(record: dict[str, Any]) -> TimeChart | None:
    """The chart of a timing record; ``None`` when no frame was timed."""
    whole = record["frame_ms"]
    if whole["median"] is None:
        return None
    passes = record["passes"]
    total = sum(entry["ms"]["median"] for entry in passes) or 1.0
    sums = [sum(values) for values in zip(*(entry["ms"]["samples"] for entry in passes), strict=True)]
    axis = _axis([p["ms"] for p in passes])
    bars = []
    for entry in passes:
        inside = [_bar(_step(s["name"]), "", s["ms"], total, axis) for s in entry["subpasses"]]
        bars.append(_bar(entry["name"], entry["node"], entry["ms"], total, axis, inside if len(inside) > 1 else ()))
    serial = {"samples": sums, "median": _median(sums), "min": min(sums, default=0), "max": max(sums, default=0)}
    wide = _axis([whole, serial])
    frame = (
        _bar("whole frame", "passes in flight together", whole, total, wide),
        _bar("sum of passes", "each on its own", serial, total, wide),
    )
    return TimeChart(frame, tuple(bars), tuple(_marks(wide)), tuple(_marks(axis)), len(whole["samples"]))


def _step(name: str) -> str:
    return name.split(".", 1)[-1]


def _axis(spreads: Iterable[dict[str, Any]]) -> float:
    """Milliseconds at the axis's end."""
    known = list(spreads)
    farthest = max((s["max"] for s in known), default=0.0)
    return float(min(farthest, _FARTHEST * max((s["median"] for s in known), default=0.0))) or 1.0


def _bar(
    name: str, detail: str, spread: dict[str, Any], total: float, axis: float, inside: Sequence[TimeBar] = ()
) -> TimeBar:
    def place(value: float) -> int:
        return min(AXIS, round(AXIS * value / axis))

    places = sorted({place(value) for value in spread["samples"]})
    return TimeBar(
        name, detail, spread["median"], spread["min"], spread["max"], spread["median"] / total,
        place(spread["median"]), (place(spread["min"]), place(spread["max"])),
        "".join(f"M{x} 0V10" for x in places), sum(value > axis for value in spread["samples"]), tuple(inside),
    )  # fmt: skip


def _marks(axis: float) -> Iterable[tuple[int, str]]:
    """Round numbers along the axis: 1, 2 or 5 times a power of ten apart, four to eight of them."""
    rough = axis / 5
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough)
    for index in range(int(axis / step) + 1):
        yield round(AXIS * index * step / axis), f"{index * step:g}"


def _median(values: Sequence[float]) -> float:
    ordered = sorted(values)
    middle = len(ordered) // 2
    if not ordered:
        return 0.0
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2
