"""The Pareto front and the setting to take, against answers worked out by hand."""

from __future__ import annotations

import pytest

from rendergraph.measure.intervals import Interval
from rendergraph.measure.sweep.front import Cost, pareto_front, recommend


def cost(ms: float, error: float, *, bytes: int = 0, spread: float = 0.0) -> Cost:
    return Cost(Interval(ms, ms - spread, ms + spread), bytes, error)


def test_a_staircase_and_what_lies_behind_it() -> None:
    costs = [cost(1, 9), cost(2, 5), cost(3, 6), cost(4, 1), cost(5, 1)]
    # 3 is slower and worse than 2; 5 is slower than 4 and no better.
    assert pareto_front(costs) == (True, True, False, True, False)


def test_overlapping_times_are_equal_times() -> None:
    near = [cost(1.0, 5, spread=0.2), cost(1.1, 4, spread=0.2)]
    assert pareto_front(near) == (False, True), "as fast as can be told, and better"
    apart = [cost(1.0, 5, spread=0.01), cost(1.1, 4, spread=0.01)]
    assert pareto_front(apart) == (True, True)


def test_touching_limits_overlap() -> None:
    assert pareto_front([cost(1.0, 5, spread=0.5), cost(2.0, 4, spread=0.5)]) == (False, True)


def test_bytes_count() -> None:
    assert pareto_front([cost(1, 1, bytes=10), cost(1, 1, bytes=20)]) == (True, False)
    assert pareto_front([cost(1, 2, bytes=10), cost(1, 1, bytes=20)]) == (True, True)


def test_twins_are_both_on_the_front_and_nothing_else_than_one_is() -> None:
    assert pareto_front([cost(1, 1), cost(1, 1)]) == (True, True)
    assert pareto_front([cost(7, 7)]) == (True,)
    assert pareto_front([]) == ()


def test_an_error_that_is_no_number_dominates_nothing() -> None:
    assert pareto_front([cost(1, float("nan")), cost(2, 3)])[1]


COSTS = [cost(1, 9, spread=0.1), cost(2, 5, spread=0.1), cost(4, 2, spread=0.5), cost(8, 1, spread=0.1)]


@pytest.mark.parametrize(
    ("budget", "taken"),
    [(10.0, 3), (8.05, 2), (4.5, 2), (4.49, 1), (1.1, 0), (1.05, None)],
)
def test_under_a_budget_the_most_accurate_that_is_surely_inside(budget: float, taken: int | None) -> None:
    assert recommend(COSTS, budget_ms=budget) == taken


@pytest.mark.parametrize(("most", "taken"), [(9.0, 0), (8.9, 1), (2.0, 2), (1.0, 3), (0.5, None)])
def test_under_an_error_the_fastest(most: float, taken: int | None) -> None:
    assert recommend(COSTS, max_error=most) == taken


def test_ties_go_to_fewer_bytes() -> None:
    assert recommend([cost(1, 1, bytes=9), cost(1, 1, bytes=3)], budget_ms=5) == 1
    assert recommend([cost(1, 1, bytes=9), cost(1, 1, bytes=3)], max_error=5) == 1


def test_without_a_limit_the_knee() -> None:
    # As shares of the ranges (time 0..7, error 0..8): (0, 1), (1/7, 1/2), (3/7, 1/8), (1, 0); squares of the distances
    # 1, 0.27, 0.199, 1.
    assert recommend(COSTS) == 2
    assert recommend([cost(3, 3)]) == 0
    assert recommend([]) is None
