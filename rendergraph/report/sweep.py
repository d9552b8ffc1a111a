"""``sweep.json``: time, bytes and error of every setting measured; ``docs/sweep.schema.json`` is its JSON Schema."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from math import prod
from typing import Any

import rendergraph
from rendergraph.measure.intervals import Interval
from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.outcome import Row, SweepOutcome
from rendergraph.measure.sweep.run import Sweep
from rendergraph.measure.sweep.times import ALPHA
from rendergraph.measure.sweep.trend import Trend
from rendergraph.measure.sweep.twin import twin_overrides
from rendergraph.report.accuracy import number

SCHEMA = "rendergraph.sweep/1"


def sweep_record(sweep: Sweep, outcome: SweepOutcome) -> dict[str, Any]:
    """The record as JSON-ready data; times in milliseconds."""
    job, frame = sweep.job, sweep.plan.graph.frame
    by_axis = {trend.axis.path: trend for trend in outcome.trends}
    choice = job.error
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": sweep.title,
        "size": [frame.width, frame.height],
        "graph": job.graph,
        "complete": sweep.complete,
        "device": sweep.stored.device,
        "design": {
            "frames": job.frames,
            "rounds": job.rounds,
            "seed": job.seed,
            "confidence": 1.0 - ALPHA,
            "sampled": len(sweep.points) < prod(len(axis.values) for axis in job.axes),
        },
        "limits": {"budget_ms": outcome.limits.budget_ms, "max_error": outcome.limits.max_error},
        "error": {
            "name": choice.name,
            "kind": choice.kind,
            "pass": choice.pass_name,
            "measure": choice.measure,
            "output": choice.output,
            "quantity": choice.quantity,
            "metric": choice.metric,
            "why": choice.why,
            "twin": list(twin_overrides(sweep.settings, ())) if choice.kind == "image" else [],
        },
        "axes": [_axis(axis, by_axis.get(axis.path)) for axis in job.axes],
        "control": _point(outcome.control, ()),
        "control_ms": _interval(outcome.control_ms),
        "points": [_point(row, row.point.overrides(job.axes) if row.point else ()) for row in outcome.rows],
        "chunks": [
            {
                "number": chunk.number,
                "contended": chunk.contended,
                "control": [list(frames) for frames in chunk.control.rounds],
            }
            for chunk in sweep.stored.chunks.values()
        ],
        "recommended": _recommended(sweep, outcome),
    }


def set_line(overrides: Sequence[str]) -> str:
    """Overrides as options to paste into a shell."""
    return " ".join(f"--set {shlex.quote(override)}" for override in overrides)


def _recommended(sweep: Sweep, outcome: SweepOutcome) -> dict[str, Any] | None:
    if outcome.recommended is None:
        return None
    row = outcome.rows[outcome.recommended]
    assert row.point is not None
    assert row.ms is not None
    return {
        "point": outcome.recommended,
        "set": set_line(row.point.overrides(sweep.job.axes)),
        "ms": row.ms.estimate,
        "bytes": row.result.bytes,
        "error": number(row.error),
    }


def _axis(axis: Axis, trend: Trend | None) -> dict[str, Any]:
    return {
        "name": axis.name,
        "path": axis.path,
        "values": list(axis.values),
        "quality": axis.quality,
        "pass": axis.passed,
        "errors": [number(error) for error in trend.errors] if trend else [],
        "shape": trend.shape if trend else "",
        "method": trend.method if trend else "",
        "at": list(trend.at) if trend else [],
    }


def _point(row: Row, overrides: Sequence[str]) -> dict[str, Any]:
    result, error = row.result, row.result.error
    return {
        "set": list(overrides),
        "own": row.own,
        "ms": _interval(row.ms) if row.ms else None,
        "relative": _interval(row.relative) if row.relative else None,
        "rounds": [list(frames) for frames in result.rounds],
        "chunk": result.chunk,
        "bytes": result.bytes,
        "error": number(row.error),
        "standard_error": number(error.standard_error) if error else 0.0,
        "tolerance": error.tolerance if error else None,
        "verdict": error.verdict if error else "refused",
        "reason": error.reason if error else result.refused,
        "steady": result.steady,
        "contended": row.contended,
        "front": row.front,
    }


def _interval(interval: Interval) -> dict[str, Any]:
    rounded = (round(limit, 6) for limit in (interval.estimate, interval.low, interval.high))
    estimate, low, high = rounded
    return {"estimate": estimate, "low": low, "high": number(high)}
