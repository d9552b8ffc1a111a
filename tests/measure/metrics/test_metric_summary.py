"""Many errors as one number, by hand."""

from math import inf, log10, sqrt

import numpy as np
import pytest

from rendergraph.measure.metrics import summary


def test_rmse() -> None:
    assert summary.rmse(np.array([3.0, 4.0, 0.0, 0.0])) == sqrt(25 / 4)
    assert summary.rmse(np.array([[1.0, inf]])) == inf


@pytest.mark.parametrize(
    ("count", "percent", "expected"),
    # of 1..n the rank ceil(p n / 100)
    [(100, 99, 99), (101, 99, 100), (1, 99, 1), (10, 99, 10), (4, 50, 2), (5, 50, 3), (200, 99, 198), (1000, 1, 10)],
)
def test_percentile_is_a_value_that_occurred(count: int, percent: int, expected: float) -> None:
    shuffled = np.random.default_rng(1).permutation(np.arange(1.0, count + 1))
    assert summary.percentile(shuffled, percent) == expected


def test_percentile_beside_infinity() -> None:
    assert summary.percentile(np.array([0.0, 1.0, inf]), 50) == 1.0
    assert summary.percentile(np.array([0.0, 1.0, inf]), 99) == inf


def test_psnr() -> None:
    assert summary.psnr(0.01) == pytest.approx(20.0)
    assert summary.psnr(0.25, peak=2.0) == pytest.approx(10 * log10(16))
    assert summary.psnr(0.0) is None
    assert summary.psnr(inf) == -inf


def test_relative_mse() -> None:
    # 0.1^2 / (1 + 1e-3) and 0.1^2 / 1e-3, halved: the dark error weighs a thousand times more
    found = summary.relative_mse(np.array([0.1, 0.1]), np.array([1.0, 0.0]))
    assert found == pytest.approx((0.01 / 1.001 + 10.0) / 2)
    assert summary.relative_mse(np.array([0.0]), np.array([inf])) == 0.0
