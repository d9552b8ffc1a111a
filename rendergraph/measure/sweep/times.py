"""Frame times of settings measured at different moments, made comparable by the one that was measured beside all."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import exp, inf, isfinite, log
from statistics import median
from typing import Final

import numpy as np

from rendergraph.measure.intervals import Interval, shift_of_pairs
from rendergraph.measure.rank_tests import signed_rank
from rendergraph.measure.sweep.store import ChunkResult

#: Two-sided error probability of all intervals; six rounds are the fewest that allow it.
ALPHA: Final = 0.05

Rounds = Sequence[Sequence[float]]


def relative_time(rounds: Rounds, control: Rounds) -> Interval:
    """How many times as long a setting's frames take as the control's of the same rounds: the pseudo-median of the
    ratios of the rounds' medians, with the limits that Wilcoxon's signed-rank test gives their logarithms.

    What slows both down in a round, as other processes on the machine do, is not in the ratio.
    """
    pairs = zip(rounds, control, strict=True)
    logs = np.array([log(_middle(frames) / _middle(beside)) for frames, beside in pairs])
    # The distribution depends on the count alone; a difference of zero has its place in it too.
    found = shift_of_pairs(logs, signed_rank(np.arange(1.0, len(logs) + 1.0)), ALPHA)
    return Interval(exp(found.estimate), exp(found.low), exp(found.high) if isfinite(found.high) else inf)


def control_time(chunks: Iterable[ChunkResult]) -> Interval:
    """The control's milliseconds a frame, over all chunks: the median of its rounds, with the limits of the sign test,
    which asks nothing of how the machine's speed wandered over the sweep.
    """
    values = sorted(_middle(frames) for chunk in chunks for frames in chunk.control.rounds)
    count = len(values)
    tail, at = 0.5**count, 0
    probability = tail
    while 2 * probability <= ALPHA and at < count // 2:
        at += 1
        tail *= (count - at + 1) / at
        probability += tail
    low, high = (values[at - 1], values[count - at]) if at else (0.0, inf)
    return Interval(median(values), low, high)


def scaled(relative: Interval, control_ms: float) -> Interval:
    """A relative time in milliseconds: to compare settings of one sweep by. How well the control's own time is known is
    not in it, since all settings share that.
    """
    return Interval(*(limit * control_ms for limit in (relative.estimate, relative.low, relative.high)))


def _middle(frames: Sequence[float]) -> float:
    return max(median(frames), 1e-6)
