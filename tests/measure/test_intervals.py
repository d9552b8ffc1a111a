"""Hodges-Lehmann shifts, their intervals, and Holm's correction, against hand computation and textbook examples."""

import numpy as np
import pytest

from rendergraph.measure.intervals import shift_between, shift_of_pairs
from rendergraph.measure.multiple_testing import holm
from rendergraph.measure.rank_tests import mann_whitney, signed_rank


def test_the_shift_is_the_median_of_all_differences() -> None:
    a, b = np.array([1.0, 2.0, 4.0]), np.array([2.5, 6.0])
    # differences: 1.5, 0.5, -1.5, 5, 4, 2; sorted -1.5 0.5 1.5 2 4 5
    found = shift_between(a, b, mann_whitney(a, b), 0.05)
    assert found.estimate == 1.75
    assert (found.low, found.high) == (-np.inf, np.inf)  # six pairs never reach 95 %


def test_the_interval_is_cut_at_the_critical_value() -> None:
    # Five and five: U <= 2 is significant at 0.05, so two of the 25 differences lie outside on either side.
    a, b = np.array([1.0, 2.1, 3.3, 4.6, 6.0]), np.array([3.05, 5.2, 7.45, 9.8, 12.25])
    differences = np.sort(np.subtract.outer(b, a).ravel())
    found = shift_between(a, b, mann_whitney(a, b), 0.05)
    assert (found.low, found.high) == (differences[2], differences[-3])


def test_depression_scores_of_hollander_and_wolfe() -> None:
    """Hollander and Wolfe, "Nonparametric Statistical Methods", table 3.1: shift -0.46, 95 % -0.786 .. -0.010."""
    before = np.array([1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30])
    after = np.array([0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29])
    test = signed_rank(after - before)
    found = shift_of_pairs(after - before, test, 0.05)
    assert test.statistic == 5
    assert test.p_value() == pytest.approx(0.0390625)
    assert found.estimate == pytest.approx(-0.46, abs=5e-3)
    assert (found.low, found.high) == (pytest.approx(-0.786, abs=1e-3), pytest.approx(-0.010, abs=1e-3))


@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_the_interval_holds_the_true_shift_as_often_as_it_says(shift: float) -> None:
    rng = np.random.default_rng(3)
    held = paired = 0
    for _ in range(400):
        a, b = rng.normal(size=15), rng.normal(shift, size=15)
        between = shift_between(a, b, mann_whitney(a, b), 0.05)
        held += between.low <= shift <= between.high
        of_pairs = shift_of_pairs(b - a, signed_rank(b - a), 0.05)
        paired += of_pairs.low <= shift <= of_pairs.high
    assert 0.92 <= held / 400 <= 0.985
    assert 0.92 <= paired / 400 <= 0.985


def test_holm_by_hand() -> None:
    # sorted 0.01 0.02 0.03 0.04 times 4 3 2 1 -> 0.04 0.06 0.06 0.04, made monotone: 0.04 0.06 0.06 0.06
    assert holm([0.04, 0.01, 0.03, 0.02]) == pytest.approx([0.06, 0.04, 0.06, 0.06])
    assert holm([]) == []
    assert holm([0.7, 0.9]) == [1.0, 1.0]
