"""The error of single values against arithmetic done by hand."""

from collections.abc import Callable
from math import acos, cos, degrees, inf, nan, pi, radians, sin

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.measure.metrics import errors

F64 = npt.NDArray[np.float64]


def texels(*values: float) -> F64:
    return np.array(values, np.float64)[:, None]


def vectors(*values: tuple[float, float, float]) -> F64:
    return np.array(values, np.float64)


def test_absolute() -> None:
    assert errors.absolute_error(texels(0.5, -1, 3), texels(0.75, 1, 3)).tolist() == [[0.25], [2], [0]]


def test_relative() -> None:
    # |3 - 4| / 4, |-2 - 2| / 2, |1 - -4| / 4; nothing against 0 but 0 itself
    found = errors.relative_error(texels(3, -2, 1, 0, 1e-9), texels(4, 2, -4, 0, 0))
    assert found.tolist() == [[0.25], [2], [1.25], [0], [inf]]


def test_relative_error_of_reversed_depth_is_that_of_z() -> None:
    # depth = near / z: 0.1 / 50 = 0.002, and at z = 50.05 (0.1 % off) 0.1 / 50.05; first order, so 0.1 % of 0.1 % aside
    assert errors.relative_error(texels(0.1 / 50.05), texels(0.1 / 50))[0, 0] == pytest.approx(0.001, rel=2e-3)


@pytest.mark.parametrize(
    ("judged", "truth", "steps"),
    [
        (1.0, 1.0 + 2**-23, 1),  # neighbours above 1 are 2^-23 apart
        (1.0, 1.0 - 2**-24, 1),  # and 2^-24 below
        (0.5, 1.0, 2**23),  # a binade holds 2^23
        (0.0, -0.0, 0),
        (2**-149, 0.0, 1),  # the smallest number there is
        (2**-149, -(2**-149), 2),
        (-(2**-149), 0.0, 1),
        (1.0, -1.0, 2 * 127 * 2**23),  # 1.0 has the exponent code 127
        (inf, 3.4028234663852886e38, inf),  # neighbours as bits, but no finite number is near infinity
        (inf, inf, 0),
        (nan, nan, 0),
        (nan, 1.0, inf),
        (1e39, 1.0, 255 * 2**23 - 127 * 2**23),  # more than float32 holds is its infinity, which is still counted
    ],
)
def test_ulp(judged: float, truth: float, steps: float) -> None:
    assert errors.ulp_distance(texels(judged), texels(truth)).tolist() == [[steps]]
    assert errors.ulp_distance(texels(truth), texels(judged)).tolist() == [[steps]]
    assert errors.ulp_distance(texels(-judged), texels(-truth)).tolist() == [[steps]]


@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.floats(width=32, allow_nan=False, allow_infinity=False), st.integers(1, 100))
def test_ulp_counts_steps(start: float, steps: int) -> None:
    value = np.float32(start)
    for _ in range(steps):
        value = np.nextafter(value, np.float32(inf))
    if np.isfinite(value):
        assert errors.ulp_distance(texels(float(value)), texels(start)).tolist() == [[steps]]


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 0.01, 1.0, 45.0, 90.0, 179.0, 179.999999, 180.0])
@pytest.mark.parametrize("length", [1.0, 5e-324, 1e-200, 1e200])
def test_angles_are_exact_at_both_ends(angle: float, length: float) -> None:
    judged = vectors((cos(radians(angle)), sin(radians(angle)), 0.0))
    found = errors.angular_error(judged, length * vectors((1.0, 0.0, 0.0)))
    assert found.shape == (1, 1)
    assert found[0, 0] == pytest.approx(angle, rel=1e-9, abs=3e-14)


def test_the_arc_cosine_would_lose_small_angles() -> None:
    # The twin: cos(1e-9) rounds to 1, so that acos says 0.
    assert degrees(acos(min(1.0, cos(1e-9)))) == 0.0
    found = errors.angular_error(vectors((cos(1e-9), sin(1e-9), 0.0)), vectors((1.0, 0.0, 0.0)))
    assert found[0, 0] == pytest.approx(1e-9 * 180 / pi, rel=1e-6)


def test_angles_by_hand() -> None:
    # (1, 1, 0) . (1, 0, 1) = 1 over sqrt(2) sqrt(2): 60 degrees; (1, 2, 2) . (2, 1, -2) = 0
    judged = vectors((1, 1, 0), (1, 2, 2), (0, 0, 3), (0, 0, 1), (0, 0, 0), (0, 0, 0), (0, 1, 0))
    truth = vectors((1, 0, 1), (2, 1, -2), (0, 0, 0.5), (0, 0, -1), (0, 0, 1), (0, 0, 0), (0, 0, 0))
    found = errors.angular_error(judged, truth)[:, 0]
    assert found == pytest.approx([60, 90, 0, 180, 180, 0, 180])  # a zero vector has no direction


def test_angles_that_are_not_finite() -> None:
    judged = vectors((nan, 0, 1), (inf, 0, 1), (nan, 0, 1), (0, 0, 1), (inf, 1, 0))
    truth = vectors((0, 0, 1), (0, 0, 1), (nan, 0, 1), (0, nan, 1), (inf, 1, 0))
    assert errors.angular_error(judged, truth)[:, 0].tolist() == [inf, inf, 0, inf, 0]


@pytest.mark.parametrize("channels", [1, 2, 4])
def test_a_normal_has_three_channels(channels: int) -> None:
    with pytest.raises(ValueError):
        errors.angular_error(np.ones((2, channels)), np.ones((2, channels)))


def test_length_shows_what_angles_do_not() -> None:
    judged, truth = vectors((0, 0, 0.5), (3, 4, 0), (0, 0, 0), (nan, 0, 0)), vectors(*[(0, 0, 1)] * 4)
    assert errors.angular_error(judged[:1], truth[:1]).tolist() == [[0]]
    assert errors.length_error(judged, truth)[:, 0].tolist() == [0.5, 4, 1, inf]


def test_mismatch() -> None:
    judged = np.array([[1.0, 2], [1, 3], [nan, 2], [nan, 2], [2**32 - 1, 0]])
    truth = np.array([[1.0, 2], [1, 2], [1, 2], [nan, 2], [2**32 - 2, 0]])
    assert errors.mismatch(judged, truth)[:, 0].tolist() == [0, 1, 1, 0, 1]


@pytest.mark.parametrize("error", [errors.absolute_error, errors.relative_error, errors.ulp_distance])
def test_not_finite_is_infinitely_wrong_unless_both_are_alike(error: Callable[[F64, F64], F64]) -> None:
    found = error(texels(nan, inf, -inf, 1, nan, inf, -inf, inf), texels(1, 1, 1, nan, nan, inf, -inf, -inf))
    assert found[:, 0].tolist() == [inf, inf, inf, inf, 0, 0, 0, inf]


def test_not_finite_counts_texels_of_the_judged_side_alone() -> None:
    judged = np.array([[nan, nan], [1.0, inf], [nan, 1], [1, 1], [inf, 1]])
    truth = np.array([[1.0, 1], [1, 1], [nan, 1], [nan, 1], [-inf, 1]])
    assert errors.not_finite(judged, truth).tolist() == [True, True, False, False, True]
