"""What the device was asked for and what it said, for the records: counters, statistics, bytes a second, warnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, Final

from rendergraph.document.messages import Diagnostic
from rendergraph.run.result import StepCounters

_COUNTS: Final = tuple(f.name for f in fields(StepCounters) if f.name not in ("name", "statistics"))


def add_counters(steps: Sequence[StepCounters]) -> dict[str, int | None]:
    """The sum of sub-passes' counters: exact, so compared exactly. ``None`` where one of them is not known."""
    totals: dict[str, int | None] = {}
    for name in _COUNTS:
        values = [getattr(step, name) for step in steps]
        totals[name] = None if None in values else sum(values)
    return totals


def add_statistics(steps: Sequence[StepCounters]) -> dict[str, int] | None:
    """The sum of what the device counted; ``None`` where it did not."""
    counted = [step.statistics for step in steps if step.statistics is not None]
    if not steps or len(counted) < len(steps):
        return None
    return {name: sum(statistics[name] for statistics in counted) for name in counted[0]}


def gigabytes_per_second(steps: Sequence[StepCounters], median_ms: float | None) -> float | None:
    """Declared bytes read and written over the median time, in 10^9 bytes a second."""
    if not median_ms or not steps:
        return None
    return round(sum(s.bytes_read + s.bytes_written for s in steps) / median_ms / 1e6, 6)


def driver_warnings(found: Sequence[Diagnostic]) -> list[dict[str, Any]]:
    """What the driver warned of (RG507) among a run's warnings: its words, the sub-pass and resource where known."""
    return [
        {"text": w.data["detail"], "subpass": w.data["scope"], "resource": w.data["resource"]}
        for w in found
        if w.code == "RG507"
    ]


def statistics_source(steps: Sequence[StepCounters], renderer: str) -> dict[str, Any]:
    """Where ``statistics`` come from, and what to beware of."""
    if not any(step.statistics is not None for step in steps):
        return {"source": None, "note": "not counted: no samples asked for, or no GL_ARB_pipeline_statistics_query"}
    note = "one frame of its own, not timed; fragments may include helper invocations of partly covered quads"
    if renderer.lower().startswith("llvmpipe"):
        note = "one frame of its own, not timed; llvmpipe counts fragments in whole 4x4 blocks"
    return {"source": "GL_ARB_pipeline_statistics_query", "note": note}
