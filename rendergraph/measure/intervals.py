"""The Hodges-Lehmann shift and its confidence interval: the rank test turned round.

Source: Hodges and Lehmann, "Estimates of location based on rank tests", 1963. The interval holds every shift that the
test at its level would not refuse.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from rendergraph.measure.rank_tests import Floats, RankTest


@dataclass(frozen=True, slots=True)
class Interval:
    """An estimate between its confidence limits; infinite limits where the samples are too few for the level."""

    estimate: float
    low: float
    high: float


def shift_between(a: Floats, b: Floats, test: RankTest, alpha: float) -> Interval:
    """How much larger ``b`` is than ``a``: the median of all differences ``b - a``, at confidence ``1 - alpha``.

    ``a`` and ``b`` are 1-d with at least one value, ``test`` their Mann-Whitney test; memory is the product of their
    lengths.
    """
    return _from_ordered(np.subtract.outer(b, a).ravel(), test.critical(alpha))


def shift_of_pairs(differences: Floats, test: RankTest, alpha: float) -> Interval:
    """The pseudo-median of 1-d differences: the median of the means of all pairs (Walsh averages).

    ``test`` is the signed-rank test of as many differences, none of them zero: zeros do not say which side is larger,
    but they do say that the shift is small.
    """
    first, second = np.triu_indices(len(differences))
    return _from_ordered((differences[first] + differences[second]) / 2, test.critical(alpha))


def _from_ordered(values: Floats, critical: int) -> Interval:
    """The median, and the values that have ``critical`` others outside on either side."""
    values = np.sort(values)
    estimate = float((values[(len(values) - 1) // 2] + values[len(values) // 2]) / 2)
    if critical < 0 or 2 * (critical + 1) > len(values):
        return Interval(estimate, -inf, inf)
    return Interval(estimate, float(values[critical]), float(values[-1 - critical]))
