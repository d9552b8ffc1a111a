"""Rank tests without scipy: Mann-Whitney U for two samples, Wilcoxon's signed rank for pairs.

Exact null distributions for small samples without ties, else the normal approximation with tie correction, widened for
autocorrelated samples and read with Student's t for the few independent ones they amount to.

Sources: Mann and Whitney, "On a test of whether one of two random variables is stochastically larger than the other",
1947; Wilcoxon, "Individual comparisons by ranking methods", 1945.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import comb, inf, sqrt
from typing import Final

import numpy as np
import numpy.typing as npt

from rendergraph.measure.student import student_critical, two_sided_p

Floats = npt.NDArray[np.float64]

#: Largest samples with an exact distribution: their counts stay below 2**53, so float64 holds them exactly.
EXACT_BOTH: Final = 40
EXACT_PAIRS: Final = 50


@dataclass(frozen=True, slots=True)
class RankTest:
    """A rank statistic and its null distribution, symmetric on ``0 .. most``.

    ``lower_tail[k]`` is ``P(statistic <= k)`` where it is known exactly. ``deviation`` is the standard deviation of
    the approximation and ``freedom`` the degrees of freedom it is read with.
    """

    statistic: float
    most: int
    deviation: float
    freedom: float
    lower_tail: Floats | None = None

    def p_value(self) -> float:
        """Two-sided probability of a statistic at least as far from the middle, were there no difference."""
        nearest = min(self.statistic, self.most - self.statistic)
        if self.lower_tail is not None:
            return min(1.0, 2.0 * float(self.lower_tail[int(nearest)]))
        if self.deviation == 0.0:
            return 1.0
        distance = max(0.0, self.most / 2 - nearest - 0.5) / self.deviation  # half a step: continuity correction
        return two_sided_p(distance, self.freedom)

    def critical(self, alpha: float) -> int:
        """The largest statistic significant on the low side at two-sided ``alpha``; -1 when none is."""
        if self.lower_tail is not None:
            return int(np.searchsorted(self.lower_tail, alpha / 2, side="right")) - 1
        width = student_critical(alpha, self.freedom) * self.deviation
        return -1 if width > self.most / 2 else int(np.floor(self.most / 2 - width - 0.5))


def mann_whitney(a: Floats, b: Floats, inflation: float = 1.0, freedom: float = inf) -> RankTest:
    """U of ``b`` over ``a``, 1-d: how many of all pairs have the larger value in ``b``, ties a half.

    ``inflation`` (>= 1) samples are worth one independent one, an estimate of ``freedom`` degrees of freedom.
    """
    m, n = len(a), len(b)
    ordered = np.sort(a)
    below = np.searchsorted(ordered, b, side="left")
    upto = np.searchsorted(ordered, b, side="right")
    statistic = float((below + upto).sum()) / 2
    ties = _tie_sum(np.concatenate([a, b]))
    total = m + n
    exact = ties == 0 and total <= EXACT_BOTH and inflation == 1.0 and min(m, n) > 0
    spread = m * n / 12 * (total + 1 - ties / max(1, total * (total - 1)))
    tail = _u_tail(min(m, n), max(m, n)) if exact else None
    return RankTest(statistic, m * n, sqrt(max(0.0, spread) * inflation), min(freedom, total - 2), tail)


def signed_rank(differences: Floats, inflation: float = 1.0, freedom: float = inf) -> RankTest:
    """Wilcoxon's T+: the rank sum of the positive differences, 1-d; zeros are left out. The others as above."""
    d = differences[differences != 0]
    n = len(d)
    size = np.abs(d)
    statistic = float(average_ranks(size)[d > 0].sum())
    ties = _tie_sum(size)
    exact = ties == 0 and 0 < n <= EXACT_PAIRS and inflation == 1.0
    spread = n * (n + 1) * (2 * n + 1) / 24 - ties / 48
    tail = _signed_rank_tail(n) if exact else None
    return RankTest(statistic, n * (n + 1) // 2, sqrt(max(0.0, spread) * inflation), min(freedom, n - 1), tail)


def average_ranks(values: Floats) -> Floats:
    """Ranks from 1, 1-d, equal values sharing the mean of theirs."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    ranks: Floats = (last - (counts - 1) / 2)[inverse]
    return ranks


def _tie_sum(values: Floats) -> float:
    _, counts = np.unique(values, return_counts=True)
    tied = counts[counts > 1].astype(np.float64)
    return float((tied**3 - tied).sum())


@lru_cache(maxsize=64)
def _u_tail(m: int, n: int) -> Floats:
    """``P(U <= k)`` for k in 0 .. m*n: the Gaussian binomial coefficient ``[m+n choose m]`` counts the arrangements."""
    counts = np.zeros(m * n + 1)
    counts[0] = 1.0
    for i in range(1, m + 1):
        if n + i <= m * n:
            counts[n + i :] -= counts[: -(n + i)].copy()  # times (1 - q^(n+i))
        for start in range(i):  # divided by (1 - q^i)
            counts[start::i] = np.cumsum(counts[start::i])
    return np.asarray(np.cumsum(counts) / comb(m + n, m), dtype=np.float64)


@lru_cache(maxsize=64)
def _signed_rank_tail(n: int) -> Floats:
    """``P(T+ <= k)`` for k in 0 .. n(n+1)/2: subsets of the ranks 1 .. n by their sum."""
    counts = np.zeros(n * (n + 1) // 2 + 1)
    counts[0] = 1.0
    for rank in range(1, n + 1):
        counts[rank:] += counts[:-rank].copy()
    return np.asarray(np.cumsum(counts) / 2.0**n, dtype=np.float64)
