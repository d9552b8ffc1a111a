"""Does the error fall along a knob?"""

from __future__ import annotations

import pytest

from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.errors import PointError
from rendergraph.measure.sweep.points import Point, all_points, hypercube
from rendergraph.measure.sweep.trend import shape_of, trends


@pytest.mark.parametrize(
    ("errors", "noise", "shape"),
    [
        ((4.0, 2.0, 1.0), 0.0, "falls"),
        ((4.0, 4.0, 1.0), 0.0, "falls"),
        ((4.0, 1.0, 2.0), 0.0, "bumpy"),
        ((4.0, 1.0, 4.0), 0.0, "bumpy"),
        ((1.0, 1.0, 1.0), 0.0, "flat"),
        ((0.0, 0.0), 0.0, "flat"),
        ((1.0, 2.0), 0.0, "rises"),
        ((1.0, 0.5, 2.0), 0.0, "rises"),
        ((1.0, 0.999), 0.0, "flat"),
        ((1.0, 0.9), 0.3, "flat"),
        ((1.0, 0.2, 0.3), 0.2, "falls"),
        ((1.0, None), 0.0, "unknown"),
        ((float("inf"), 1.0), 0.0, "unknown"),
    ],
)
def test_shapes(errors: tuple[float | None, ...], noise: float, shape: str) -> None:
    assert shape_of(errors, noise) == shape


A = Axis("p.a", "passes.p.set.a", ("0", "1", "2"), "up", "p")
B = Axis("p.b", "passes.p.set.b", ("0", "1"), "up", "p")
C = Axis("p.c", "passes.p.set.c", ("x", "y"))


def errors_of(points: tuple[Point, ...], error: dict[tuple[int, ...], float] | None = None) -> dict[int, PointError]:
    return {p.index: PointError((error or {}).get(p.choice, float(sum(p.choice))), "measured") for p in points}


def test_an_axis_is_seen_where_the_others_are_held() -> None:
    points = all_points([A, B, C])
    error = {(k, 1, 0): 10.0 - k for k in range(3)} | {(2, 0, 0): 9.0}
    along_a, along_b = trends([A, B, C], points, errors_of(points, error), (2, 1, 0))
    assert (along_a.errors, along_a.shape, along_a.method) == ((10.0, 9.0, 8.0), "falls", "slice")
    assert along_a.at == ("p.b=1", "p.c=x")
    assert (along_b.errors, along_b.shape) == ((9.0, 8.0), "falls")


def test_a_knob_that_does_not_help_is_told_from_one_that_does() -> None:
    points = all_points([A, B])
    worse = {p.choice: 1.0 + p.choice[0] - 0.1 * p.choice[1] for p in points}
    along_a, along_b = trends([A, B], points, errors_of(points, worse), (0, 0))
    assert (along_a.shape, along_b.shape) == ("rises", "falls")


def test_settings_that_are_missing_leave_it_unknown() -> None:
    points = all_points([A])
    (trend,) = trends([A], points, errors_of(points[:2]), (0,))
    assert (trend.errors, trend.shape) == ((0.0, 1.0, None), "unknown")


def test_in_a_hypercube_by_means() -> None:
    axes = [Axis(f"p.{n}", f"passes.p.set.{n}", tuple("0123456789"), "up", "p") for n in "abc"]
    points = hypercube(axes, 10, 1)
    errors = {p.index: PointError(10.0 - p.choice[0], "measured") for p in points}
    found = trends(axes, points, errors, (0, 0, 0))
    assert (found[0].method, found[0].shape) == ("mean", "falls")
    assert found[0].errors == tuple(10.0 - k for k in range(10))


def test_random_errors_are_as_sure_as_their_noise() -> None:
    points = all_points([A])
    errors = {p.index: PointError(1.0 - 0.05 * p.index, "above", standard_error=0.1) for p in points}
    assert trends([A], points, errors, (0,))[0].shape == "flat"
