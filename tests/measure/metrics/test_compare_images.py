"""Written images against each other, by hand."""

from math import inf, log10, sqrt

import numpy as np
import pytest

from rendergraph.measure.metrics import compare_images
from rendergraph.measure.metrics.summary import EPSILON, psnr


def image(*values: float, dtype: type = np.float32) -> np.ndarray:
    """Texels of one channel in a row."""
    return np.array(values, dtype).reshape(1, -1, 1)


def test_by_hand() -> None:
    # differences 0, 0.25, 0.5, 0; squares 0, 1/16, 1/4, 0
    error = compare_images(image(0, 0.5, 0.5, 1), image(0, 0.25, 1, 1))
    assert error.max == 0.5
    assert error.mean == 0.75 / 4
    assert error.rmse == pytest.approx(sqrt(0.3125 / 4))
    assert error.psnr == pytest.approx(10 * log10(4 / 0.3125))
    assert error.rel_mse == pytest.approx((0.0625 / (0.0625 + EPSILON) + 0.25 / (1 + EPSILON)) / 4)
    assert error.worst_texel == (2, 0)
    assert error.differing == 0.5


def test_channels_count_apart_for_the_mean_and_together_for_texels() -> None:
    a = np.zeros((2, 2, 3), np.float32)
    b = a.copy()
    b[1, 0] = (0.3, 0.6, 0.0)
    error = compare_images(b, a)
    assert error.mean == pytest.approx(0.9 / 12)
    assert error.worst_texel == (0, 1)
    assert error.differing == 0.25


def test_eight_bit_values_are_shares_of_255() -> None:
    error = compare_images(image(51, 255, dtype=np.uint8), image(0, 255, dtype=np.uint8))
    assert error.max == 0.2
    assert error.psnr == pytest.approx(10 * log10(2 / 0.04))


def test_unsigned_values_do_not_wrap() -> None:
    assert compare_images(image(0, dtype=np.uint8), image(255, dtype=np.uint8)).max == 1.0


def test_equal_images_have_no_psnr() -> None:
    error = compare_images(image(0.1, 0.2), image(0.1, 0.2))
    assert (error.max, error.mean, error.rmse, error.psnr, error.rel_mse) == (0, 0, 0, None, 0)
    assert psnr(0.25, peak=2.0) == pytest.approx(10 * log10(16))


def test_relative_error_is_held_against_the_truth() -> None:
    assert compare_images(image(0.0), image(1.0)).rel_mse == pytest.approx(1 / (1 + EPSILON))
    assert compare_images(image(1.0), image(0.0)).rel_mse == pytest.approx(1 / EPSILON)


def test_nan_on_one_side_is_infinitely_wrong_and_on_both_equal() -> None:
    assert compare_images(image(np.nan, 0.5), image(np.nan, 0.5)).max == 0.0
    assert compare_images(image(inf, 0.5), image(inf, 0.5)).max == 0.0
    error = compare_images(image(np.nan, 0.5), image(0.5, 0.5))
    assert error.max == inf
    assert error.worst_texel == (0, 0)
    assert error.psnr == -inf


@pytest.mark.parametrize("shape", [(1, 3, 1), (1, 2, 3), (0, 0, 1)])
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError):
        compare_images(np.zeros(shape), image(0, 1))
    with pytest.raises(ValueError):
        compare_images(np.zeros((0, 2, 3)), np.zeros((0, 2, 3)))
