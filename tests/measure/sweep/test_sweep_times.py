"""Times made comparable by the control."""

from __future__ import annotations

from math import inf

import pytest

from rendergraph.measure.sweep.errors import PointError
from rendergraph.measure.sweep.store import ChunkResult, PointResult
from rendergraph.measure.sweep.times import control_time, relative_time, scaled


def chunk(number: int, *rounds: float) -> ChunkResult:
    return ChunkResult(
        number, PointResult(-1, number, 0, PointError(0.0, "measured"), tuple((r,) for r in rounds)), ()
    )  # fmt: skip


def test_what_slows_both_down_is_not_in_the_ratio() -> None:
    control = [(1.0,), (3.0,), (1.5,), (2.0,), (7.0,), (1.0,)]
    rounds = [(2 * ms,) for (ms,) in control]
    found = relative_time(rounds, control)
    assert (found.estimate, found.low, found.high) == pytest.approx((2.0, 2.0, 2.0))


def test_the_limits_are_those_of_the_signed_rank() -> None:
    # Six differences of logarithms: at 5 % only the extreme Walsh averages are left out, which are the extremes.
    ratios = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
    found = relative_time([(r,) for r in ratios], [(1.0,)] * 6)
    assert (found.low, found.high) == pytest.approx((1.0, 32.0))
    assert found.estimate == pytest.approx(2.0**2.5)


def test_five_rounds_are_too_few_for_limits() -> None:
    found = relative_time([(2.0,)] * 5, [(1.0,)] * 5)
    assert found.estimate == pytest.approx(2.0)
    assert (found.low, found.high) == (0.0, inf)


def test_a_round_counts_by_its_median() -> None:
    found = relative_time([(2.0, 900.0, 2.0)] * 6, [(1.0, 1.0, 500.0)] * 6)
    assert found.estimate == pytest.approx(2.0)


def test_the_controls_own_time_over_all_chunks() -> None:
    # Eleven values: 2 P(B <= 1) = 2 * 12 / 2048 = 0.012, 2 P(B <= 2) = 2 * 67 / 2048 = 0.065, so the second from
    # either end.
    found = control_time([chunk(0, *range(1, 7)), chunk(1, *range(7, 12))])
    assert (found.estimate, found.low, found.high) == (6, 2, 10)
    few = control_time([chunk(0, 1, 2, 3)])
    assert (few.estimate, few.low, few.high) == (2, 0.0, inf)
    six = control_time([chunk(0, *range(1, 7))])
    assert (six.low, six.high) == (1, 6)


def test_scaling() -> None:
    found = scaled(relative_time([(2.0,)] * 6, [(1.0,)] * 6), 10.0)
    assert (found.estimate, found.low, found.high) == pytest.approx((20.0, 20.0, 20.0))
