"""Are these times slower, faster, the same, or can it not be told?

A change counts only when it is significant after Holm's correction over all that is tested, and when its confidence
interval lies beyond a floor, relative and absolute, below which nobody cares. "Unchanged" is a finding too: the
interval lies inside the floor. Everything between is "inconclusive".

Frames of one run resemble each other, so samples are not taken for independent: how alike they are, within a process or
from one to the next, widens every test and interval, and what amounts to fewer than ``LEAST_INDEPENDENT`` samples is
inconclusive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import Final

from rendergraph.measure.multiple_testing import holm
from rendergraph.measure.run_shift import Runs, Shift, shift_of_blocks, shift_of_runs

#: Samples a side (or pairs) that a verdict needs, and how many independent ones they must amount to.
LEAST_COMPARED: Final = 10
LEAST_INDEPENDENT: Final = 5


class Verdict(StrEnum):
    """What became of a time."""

    SLOWER = "slower"
    INCONCLUSIVE = "inconclusive"
    FASTER = "faster"
    UNCHANGED = "unchanged"


@dataclass(frozen=True, slots=True)
class Thresholds:
    """When a difference counts. ``alpha`` is family-wise; ``relative`` is a share of the time before.

    Two processes differ by more than the frames inside either show (memory layout, clock frequency): where a side was
    measured in a single one, ``relative_alone`` takes the place of ``relative``.
    """

    alpha: float = 0.01
    relative: float = 0.03
    relative_alone: float = 0.05
    absolute_ms: float = 0.010


@dataclass(frozen=True, slots=True)
class Change:
    """A time before and after, in milliseconds: medians, Hodges-Lehmann shift (positive is slower) with its interval at
    confidence ``1 - alpha``, the floor it is held against, p-value and Holm's. ``compared`` values (or pairs) of the
    smaller side amount to ``independent`` ones.

    ``reason``: ``beyond_floor`` (slower, faster), ``inside_floor`` (unchanged); for inconclusive ones ``no_samples``,
    ``too_few_samples``, ``dependent`` or ``too_noisy``. ``low``, ``high`` and p are None where they mean nothing.
    """

    verdict: Verdict
    reason: str
    before: float | None
    after: float | None
    shift: float | None
    low: float | None
    high: float | None
    floor: float
    p: float | None
    p_adjusted: float | None
    samples: tuple[int, int]
    compared: int
    independent: float
    method: str  # "mann_whitney" | "signed_rank" | "clustered_t"

    @property
    def relative(self) -> float | None:
        """The shift as a share of the time before; None without one."""
        return self.shift / self.before if self.shift is not None and self.before else None


def compare_runs(before: Mapping[str, Runs], after: Mapping[str, Runs], thresholds: Thresholds) -> dict[str, Change]:
    """Stored records: Mann-Whitney, of every name that both have."""
    shifts = {n: shift_of_runs(before[n], after[n], thresholds.alpha) for n in before if n in after}
    return _judge(shifts, _alone(before, after), thresholds)


def compare_blocks(before: Mapping[str, Runs], after: Mapping[str, Runs], thresholds: Thresholds) -> dict[str, Change]:
    """Interleaved blocks: Wilcoxon's signed rank, of every name that both have. Run i of one side ran next to run i of
    the other.
    """
    shifts = {n: shift_of_blocks(before[n], after[n], thresholds.alpha) for n in before if n in after}
    return _judge(shifts, _alone(before, after), thresholds)


def _alone(before: Mapping[str, Runs], after: Mapping[str, Runs]) -> bool:
    """Whether one side knows a single process, and so nothing of how processes differ."""
    return any(len({p for runs in side.values() for p in runs.processes}) < 2 for side in (before, after))


def _judge(shifts: Mapping[str, Shift], alone: bool, thresholds: Thresholds) -> dict[str, Change]:
    """Verdicts. Only what can be tested enters Holm's family: the rest is inconclusive anyway."""
    tested = {name: shift.p for name, shift in shifts.items() if shift.p is not None and _enough(shift)}
    adjusted = dict(zip(tested, holm(list(tested.values())), strict=True))
    relative = thresholds.relative_alone if alone else thresholds.relative
    changes = {}
    for name, shift in shifts.items():
        before, after = shift.medians or (None, None)
        floor = max(relative * (before or 0.0), thresholds.absolute_ms)
        verdict, reason = _verdict(shift, adjusted.get(name), thresholds.alpha, floor)
        low, high = (
            x if before is not None and isfinite(x) else None for x in (shift.interval.low, shift.interval.high)
        )
        changes[name] = Change(
            verdict=verdict,
            reason=reason,
            before=before,
            after=after,
            shift=None if before is None else shift.interval.estimate,
            low=low,
            high=high,
            floor=floor,
            p=tested.get(name),
            p_adjusted=adjusted.get(name),
            samples=shift.samples,
            compared=shift.compared,
            independent=shift.independent,
            method=shift.method,
        )
    return changes


def _enough(shift: Shift) -> bool:
    return shift.compared >= LEAST_COMPARED and shift.independent >= LEAST_INDEPENDENT


def _verdict(shift: Shift, adjusted: float | None, alpha: float, floor: float) -> tuple[Verdict, str]:
    if shift.medians is None:
        return Verdict.INCONCLUSIVE, "no_samples"
    if adjusted is None:
        return Verdict.INCONCLUSIVE, "too_few_samples" if shift.compared < LEAST_COMPARED else "dependent"
    if adjusted < alpha and shift.interval.low > floor:
        return Verdict.SLOWER, "beyond_floor"
    if adjusted < alpha and shift.interval.high < -floor:
        return Verdict.FASTER, "beyond_floor"
    if -floor < shift.interval.low and shift.interval.high < floor:
        return Verdict.UNCHANGED, "inside_floor"
    return Verdict.INCONCLUSIVE, "too_noisy"
