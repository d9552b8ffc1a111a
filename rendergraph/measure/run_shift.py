"""The shift in time between two sets of runs: rank test, interval, and how many independent samples it rests on.

Times vary in proportion to themselves, so they are compared by the logarithm of their ratio: a pass that takes half the
time is as far from unchanged as one that takes twice, and no interval reaches below no time at all. Milliseconds are
then those of the median before. Times of zero (below the clock's resolution) have no logarithm; where there are any,
differences are compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, inf, sqrt
from typing import Final

import numpy as np

from rendergraph.measure.clusters import Sampled, dependence_of_pairs, dependence_of_samples
from rendergraph.measure.intervals import Interval, shift_between, shift_of_pairs
from rendergraph.measure.rank_tests import Floats, mann_whitney, signed_rank
from rendergraph.measure.student import student_critical, two_sided_p

#: Values a side that are compared; longer runs are cut into as many stretches, and the medians of these compared.
MOST_COMPARED: Final = 256


@dataclass(frozen=True, slots=True)
class Runs:
    """Runs of consecutive samples (1-d, ms), in order of time, and the process that each was measured in."""

    samples: tuple[Floats, ...]
    processes: tuple[int, ...]

    @property
    def count(self) -> int:
        """Samples of all runs."""
        return sum(len(run) for run in self.samples)


@dataclass(frozen=True, slots=True)
class Shift:
    """``medians`` before and after, and ``p``, are None without samples. ``compared`` values (or pairs) of the smaller
    side amount to ``independent`` ones.
    """

    method: str  # "mann_whitney" | "signed_rank" | "clustered_t"
    samples: tuple[int, int]
    medians: tuple[float, float] | None
    p: float | None
    interval: Interval
    compared: int
    independent: float


def shift_of_runs(before: Runs, after: Runs, alpha: float) -> Shift:
    """Mann-Whitney on all samples; the interval is at confidence ``1 - alpha``."""
    samples = before.count, after.count
    if 0 in samples:
        return Shift("mann_whitney", samples, None, None, Interval(0.0, -inf, inf), 0, 0.0)
    of_before, of_after = _shorten(before), _shorten(after)
    dependence = dependence_of_samples(of_before, of_after)
    a, b = of_before.values, of_after.values
    test = mann_whitney(a, b, dependence.inflation, dependence.freedom)
    medians = float(_median(np.concatenate(before.samples))), float(_median(np.concatenate(after.samples)))
    least = min(len(a), len(b))
    if _have_logarithms(a, b):
        interval = _of_ratio(shift_between(np.log(a), np.log(b), test, alpha), medians[0])
    else:
        interval = _of_difference(shift_between(a, b, test, alpha), medians[0])
    return Shift("mann_whitney", samples, medians, test.p_value(), interval, least, least / dependence.inflation)


def shift_of_blocks(before: Runs, after: Runs, alpha: float) -> Shift:
    """Signed rank of the log ratios of medians, block by block: run i of one side ran next to run i of the other.

    Where the ratios of one process resemble each other, Student's t widened by their design effect.
    """
    pairs = [
        (_median(a), _median(b), process)
        for a, b, process in zip(before.samples, after.samples, before.processes, strict=True)
        if len(a) and len(b)
    ]
    samples = before.count, after.count
    if not pairs:
        return Shift("signed_rank", samples, None, None, Interval(0.0, -inf, inf), 0, 0.0)
    medians = np.array([pair[:2] for pair in pairs], np.float64)
    a, b = medians[:, 0], medians[:, 1]
    by_ratio = _have_logarithms(a, b)
    apart = np.log(b) - np.log(a) if by_ratio else b - a
    middle = float(_median(a)), float(_median(b))
    shortened = _shorten(Runs(tuple(apart.reshape(-1, 1)), tuple(pair[2] for pair in pairs)))
    in_ms = _of_ratio if by_ratio else _of_difference
    values, count = shortened.values, len(shortened.values)
    dependence = dependence_of_pairs(shortened)
    untied = signed_rank(np.arange(1.0, count + 1))
    interval = shift_of_pairs(values, untied, alpha)
    if dependence.inflation == 1.0:
        p = signed_rank(values).p_value()
        return Shift("signed_rank", samples, middle, p, in_ms(interval, middle[0]), count, count)
    error = float(values.std(ddof=1)) * sqrt(dependence.inflation / count)
    interval = _student_interval(interval.estimate, error, dependence.freedom, alpha)
    p = two_sided_p(interval.estimate / error, dependence.freedom) if error else 1.0
    return Shift("clustered_t", samples, middle, p, in_ms(interval, middle[0]), count, count / dependence.inflation)


def _have_logarithms(a: Floats, b: Floats) -> bool:
    return bool((a > 0).all() and (b > 0).all())


def _of_ratio(interval: Interval, before: float) -> Interval:
    """Log ratios as milliseconds more than ``before``; infinite limits stay so."""
    return Interval(*(before * _expm1(x) for x in (interval.estimate, interval.low, interval.high)))


def _expm1(log_ratio: float) -> float:
    """Of a shift that no double holds (Student's t reaches far on few processes), no limit is known."""
    if log_ratio == -inf:
        return -inf
    return expm1(log_ratio) if log_ratio < 700 else inf


def _of_difference(interval: Interval, before: float) -> Interval:
    """Differences in milliseconds; what took ``before`` cannot be faster by more than that."""
    return Interval(*(x if x == -inf else max(-before, x) for x in (interval.estimate, interval.low, interval.high)))


def _student_interval(estimate: float, error: float, freedom: float, alpha: float) -> Interval:
    """Ranks of few clusters cannot become significant however far apart the sides are; deviates can."""
    reach = student_critical(alpha, freedom) * error
    return Interval(estimate, estimate - reach, estimate + reach)


def _shorten(runs: Runs) -> Sampled:
    """At most about ``MOST_COMPARED`` values, medians of stretches of one length in a process, and their processes."""
    length = -(-runs.count // MOST_COMPARED)
    values: list[Floats] = []
    processes: list[int] = []
    for process in dict.fromkeys(runs.processes):
        own = np.concatenate([run for run, of in zip(runs.samples, runs.processes, strict=True) if of == process])
        if length > 1 and len(own):
            own = _medians(own, length)
        values.append(own)
        processes += [process] * len(own)
    return Sampled(np.concatenate(values), processes)


def _medians(values: Floats, length: int) -> Floats:
    """Medians of stretches of ``length`` values; a rest of half that or more counts too, and so does a lone one."""
    whole = len(values) - len(values) % length
    medians = _median(values[:whole].reshape(-1, length))
    rest = values[whole:]
    return np.append(medians, _median(rest)) if 2 * len(rest) >= length or not whole else medians


def _median(values: Floats) -> Floats:
    """Medians along the last axis. ``numpy.median`` would import masked arrays, a tenth of this command's time."""
    ordered, count = np.sort(values, axis=-1), values.shape[-1]
    return np.asarray((ordered[..., (count - 1) // 2] + ordered[..., count // 2]) / 2, dtype=np.float64)
