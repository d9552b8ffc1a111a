"""Which settings are worth having: the Pareto front over time, bytes and error, and the one to take under a budget."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rendergraph.measure.intervals import Interval


@dataclass(frozen=True, slots=True)
class Cost:
    """What one setting costs: median frame time in ms with its confidence limits, bytes of transient memory, error."""

    ms: Interval
    bytes: int
    error: float


def pareto_front(costs: Sequence[Cost]) -> tuple[bool, ...]:
    """Whether each setting is on the front: no other is as good in all three and better in one.

    Times count as better only where the confidence intervals do not overlap, and as equal where they do: noise neither
    dominates nor saves a setting. Two settings that cost the same in everything are both on the front.
    """
    return tuple(not any(_dominates(other, cost) for other in costs if other is not cost) for cost in costs)


def _dominates(a: Cost, b: Cost) -> bool:
    faster, slower = a.ms.high < b.ms.low, a.ms.low > b.ms.high
    if slower or a.bytes > b.bytes or not a.error <= b.error:
        return False
    return faster or a.bytes < b.bytes or a.error < b.error


def recommend(costs: Sequence[Cost], budget_ms: float | None = None, max_error: float | None = None) -> int | None:
    """The index of the setting to take: under ``budget_ms`` the most accurate one whose time is surely inside it (its
    upper limit is), under ``max_error`` the fastest one whose error is; ties go to fewer bytes. Without a limit, the
    setting of the front nearest to the best time and the best error at once, both as shares of their range over the
    front. None where no setting satisfies the limits.
    """
    allowed = [
        index
        for index, cost in enumerate(costs)
        if (budget_ms is None or cost.ms.high <= budget_ms) and (max_error is None or cost.error <= max_error)
    ]
    if not allowed:
        return None
    if budget_ms is not None:
        return min(allowed, key=lambda i: (costs[i].error, costs[i].ms.estimate, costs[i].bytes))
    if max_error is not None:
        return min(allowed, key=lambda i: (costs[i].ms.estimate, costs[i].bytes, costs[i].error))
    front = [index for index, on in enumerate(pareto_front(costs)) if on]
    times, errors = ([costs[i].ms.estimate for i in front], [costs[i].error for i in front])

    def distance(index: int) -> float:
        return _share(costs[index].ms.estimate, times) ** 2 + _share(costs[index].error, errors) ** 2

    return min(front, key=distance)


def _share(value: float, among: Sequence[float]) -> float:
    low, high = min(among), max(among)
    return (value - low) / (high - low) if high > low else 0.0
