"""What a sweep says: each setting's cost and error, the front, what to take, and how the error runs along the knobs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.measure.intervals import Interval
from rendergraph.measure.sweep.errors import PointError
from rendergraph.measure.sweep.front import Cost, pareto_front, recommend
from rendergraph.measure.sweep.points import Point
from rendergraph.measure.sweep.run import Sweep
from rendergraph.measure.sweep.store import CONTROL, ChunkResult, PointResult
from rendergraph.measure.sweep.times import control_time, relative_time, scaled
from rendergraph.measure.sweep.trend import Trend, trends


@dataclass(frozen=True, slots=True)
class Limits:
    """What the setting to take must keep: milliseconds a frame, or an error; at most one of them."""

    budget_ms: float | None = None
    max_error: float | None = None


@dataclass(frozen=True, slots=True)
class Row:
    """One setting: times in milliseconds and relative to the document's own setting (None: refused), and whether it is
    on the front. ``point`` is None for the document's own setting where that is none of those swept.
    """

    point: Point | None
    result: PointResult
    own: bool
    ms: Interval | None
    relative: Interval | None
    contended: bool
    front: bool = False

    @property
    def error(self) -> float | None:
        """Its error, where there is one."""
        return self.result.error.value if self.result.error is not None else None


@dataclass(frozen=True, slots=True)
class SweepOutcome:
    """``rows`` of what was measured, in the sweep's order; ``control`` the document's own setting; ``recommended`` an
    index into ``rows``.
    """

    rows: tuple[Row, ...]
    control: Row
    control_ms: Interval
    trends: tuple[Trend, ...]
    recommended: int | None
    limits: Limits
    findings: tuple[Diagnostic, ...]


def sweep_outcome(sweep: Sweep, limits: Limits | None = None) -> SweepOutcome:
    """What is known by now; at least one chunk must be there."""
    limits = limits or Limits()
    chunks = list(sweep.stored.chunks.values())
    control_ms = control_time(chunks)
    control = _control_row(chunks, control_ms)
    by_index = {result.index: (result, chunk) for chunk in chunks for result in chunk.points}
    rows = []
    for point in sweep.points:
        index = sweep.result_of(point)
        if index == CONTROL:
            rows.append(_row(point, control.result, None, control_ms))
        elif index in by_index:
            rows.append(_row(point, *by_index[index], control_ms))
    costs = {
        at: Cost(row.ms, row.result.bytes, row.error)
        for at, row in enumerate(rows)
        if row.ms is not None and row.error is not None and isfinite(row.error)
    }
    on_front = dict(zip(costs, pareto_front(list(costs.values())), strict=True))
    marked = tuple(_marked(row, on_front.get(at, False)) for at, row in enumerate(rows))
    budget = limits.budget_ms
    if budget is not None:  # surely inside: also were the control as slow as its upper limit
        budget *= control_ms.estimate / control_ms.high
    taken = recommend(list(costs.values()), budget, limits.max_error) if costs else None
    recommended = list(costs)[taken] if taken is not None else None
    errors = {row.point.index: row.result.error for row in rows if row.point and row.result.error is not None}
    found = trends(sweep.job.axes, sweep.points, errors, sweep.held)
    outcome = SweepOutcome(marked, control, control_ms, found, recommended, limits, ())
    return SweepOutcome(marked, control, control_ms, found, recommended, limits, tuple(_findings(sweep, outcome)))


def _control_row(chunks: list[ChunkResult], ms: Interval) -> Row:
    first = chunks[0].control
    rounds = tuple(frames for chunk in chunks for frames in chunk.control.rounds)
    steady = all(chunk.control.steady for chunk in chunks)
    whole = PointResult(CONTROL, first.chunk, first.bytes, first.error, rounds, steady, first.run_ms)
    one = Interval(1.0, 1.0, 1.0)
    return Row(None, whole, True, scaled(one, ms.estimate), one, any(chunk.contended for chunk in chunks))


def _row(point: Point, result: PointResult, chunk: ChunkResult | None, control_ms: Interval) -> Row:
    if result.refused:
        return Row(point, result, False, None, None, False)
    if chunk is None:
        one = Interval(1.0, 1.0, 1.0)
        return Row(point, result, True, scaled(one, control_ms.estimate), one, False)
    relative = relative_time(result.rounds, chunk.control.rounds)
    return Row(point, result, False, scaled(relative, control_ms.estimate), relative, chunk.contended)


def _marked(row: Row, front: bool) -> Row:
    return Row(row.point, row.result, row.own, row.ms, row.relative, row.contended, front)


# ---- findings


def _findings(sweep: Sweep, outcome: SweepOutcome) -> Iterator[Diagnostic]:
    unjudged = [row.result.error for row in outcome.rows if row.result.error and row.error is None]
    yield from _unjudged(sweep, [error for error in unjudged if error is not None])
    refused = [row.result.refused for row in outcome.rows if row.result.refused]
    if refused:
        yield diagnose("RG762", count=len(refused), reason=refused[0])
    if sweep.complete:
        for trend in outcome.trends:
            if trend.shape not in ("falls", "unknown"):
                yield _trend_finding(trend)
    limits = outcome.limits
    if outcome.recommended is None and (limits.budget_ms is not None or limits.max_error is not None):
        yield _no_setting(outcome)


def _unjudged(sweep: Sweep, errors: list[PointError]) -> Iterator[Diagnostic]:
    if errors:
        reasons = {
            "standard_error": "three standard errors of the truth are above the tolerance",
            "all_masked": "the truth is known nowhere",
        }
        reason = reasons.get(errors[0].reason, errors[0].reason)
        yield diagnose("RG756", count=len(errors), error=sweep.job.error.name, reason=reason)


def _trend_finding(trend: Trend) -> Diagnostic:
    shapes = {"flat": "it stays as it is", "rises": "it rises", "bumpy": "it rises on the way"}
    pairs = zip(trend.axis.values, trend.errors, strict=True)
    values = ", ".join(f"{value}: {error:.4g}" for value, error in pairs if error is not None)
    hint = "take the cheapest value, or look for what limits the error"
    return diagnose("RG757", axis=trend.axis.name, shape=shapes[trend.shape], values=values, hint=hint)


def _no_setting(outcome: SweepOutcome) -> Diagnostic:
    limits = outcome.limits
    timed = [row.ms for row in outcome.rows if row.ms is not None]
    errors = [row.error for row in outcome.rows if row.error is not None]
    if limits.budget_ms is not None:
        least = min((ms.estimate for ms in timed), default=float("nan"))
        return diagnose(
            "RG760", limit=f"{limits.budget_ms:g} ms a frame", nearest=f"the fastest takes {least:.4g} ms"
        )  # fmt: skip
    least = min(errors, default=float("nan"))
    return diagnose("RG760", limit=f"an error of {limits.max_error:g}", nearest=f"the least error is {least:.4g}")
