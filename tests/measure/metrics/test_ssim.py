"""Structural similarity against hand arithmetic and the paper's sums written out."""

from math import exp, inf, nan

import numpy as np
import numpy.typing as npt
import pytest

from rendergraph.measure.metrics import compare, error_map
from rendergraph.measure.metrics.ssim import C2, ssim_map
from rendergraph.node.reference import Quantity

F64 = npt.NDArray[np.float64]
RANDOM = np.random.default_rng(7)


def pair(height: int = 24, width: int = 19, channels: int = 1) -> tuple[F64, F64]:
    truth = RANDOM.random((height, width, channels))
    return np.clip(truth + RANDOM.normal(0.0, 0.2, truth.shape), 0.0, 1.0), truth


def written_out(judged: F64, truth: F64, known: npt.NDArray[np.bool_], y: int, x: int) -> float:
    """The window around one texel, weight by weight (Wang et al. 2004, equations 13 to 16)."""
    height, width = known.shape
    window = [
        (exp(-((i - y) ** 2 + (j - x) ** 2) / (2 * 1.5**2)), judged[i, j, 0], truth[i, j, 0])
        for i in range(max(0, y - 5), min(height, y + 6))
        for j in range(max(0, x - 5), min(width, x + 6))
        if known[i, j]
    ]
    total = sum(w for w, _, _ in window)
    mean_a, mean_b = (sum(t[0] * t[k] for t in window) / total for k in (1, 2))
    variance_a, variance_b = (
        sum(t[0] * (t[k] - m) ** 2 for t in window) / total for k, m in ((1, mean_a), (2, mean_b))
    )
    covariance = sum(w * (a - mean_a) * (b - mean_b) for w, a, b in window) / total
    luminance = (2 * mean_a * mean_b + 0.0001) / (mean_a**2 + mean_b**2 + 0.0001)
    return float(luminance * (2 * covariance + 0.0009) / (variance_a + variance_b + 0.0009))


@pytest.mark.parametrize("masked", [False, True])
def test_every_window_as_the_paper_has_it(masked: bool) -> None:
    judged, truth = pair()
    known = RANDOM.random(truth.shape[:2]) > (0.3 if masked else -1)
    found = ssim_map(judged, truth, known if masked else None)
    expected = np.array([[written_out(judged, truth, known, y, x) for x in range(19)] for y in range(24)])
    np.testing.assert_allclose(found[known], expected[known], atol=1e-12)
    # the twin: without the mask's renormalisation the windows differ
    if masked:
        assert abs(ssim_map(judged, truth) - expected)[known].max() > 0.01


def test_uniform_images_by_hand() -> None:
    # no variance: (2 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4) = 0.2501 / 0.3126
    found = ssim_map(np.full((16, 16, 1), 0.5), np.full((16, 16, 1), 0.25))
    np.testing.assert_allclose(found, 0.2501 / 0.3126, rtol=1e-12)


def test_an_inverted_pattern_is_as_unlike_as_can_be() -> None:
    # A checkerboard of 0 and 1 and its inverse: means about 0.5, variances about 0.25, covariance the negative of it:
    # (-0.5 + C2) / (0.5 + C2), where the luminance term is 1
    board = (np.indices((32, 32)).sum(axis=0) % 2)[..., None].astype(np.float64)
    assert ssim_map(1 - board, board)[16, 16] == pytest.approx((-0.5 + C2) / (0.5 + C2), abs=1e-4)
    np.testing.assert_allclose(ssim_map(board, board), 1.0, rtol=1e-12)


@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 5, 3), (1, 40, 2), (40, 1, 1)])
def test_images_smaller_than_the_window(shape: tuple[int, int, int]) -> None:
    judged, truth = RANDOM.random(shape), RANDOM.random(shape)
    known = np.ones(shape[:2], bool)
    expected = np.mean([written_out(judged[..., c:], truth[..., c:], known, 0, 0) for c in range(shape[2])])
    assert ssim_map(judged, truth)[0, 0] == pytest.approx(expected)


def test_channels_are_averaged_and_alpha_is_left_out() -> None:
    judged, truth = pair(channels=4)
    each = [compare(Quantity.SHARE, judged[..., i : i + 1], truth[..., i : i + 1])["ssim"] for i in range(3)]
    assert None not in each
    assert compare(Quantity.SHARE, judged, truth)["ssim"] == pytest.approx(np.mean(np.array(each, float)))


@pytest.mark.parametrize("held", [0.0, 1e30, nan, inf])
def test_a_masked_texel_changes_nothing(held: float) -> None:
    judged, truth = pair(channels=3)
    mask = RANDOM.random(truth.shape[:2]) > 0.4
    expected = error_map(Quantity.DISPLAY, judged, truth, mask, "ssim")
    judged[~mask], truth[~mask] = held, 0.5
    np.testing.assert_array_equal(error_map(Quantity.DISPLAY, judged, truth, mask, "ssim"), expected)
    assert compare(Quantity.SHARE, judged, truth)["ssim"] != compare(Quantity.SHARE, judged, truth, mask)["ssim"]


def test_not_finite() -> None:
    judged, truth = pair()
    judged[2, 3] = nan
    assert compare(Quantity.SHARE, judged, truth)["ssim"] == -inf
    truth[2, 3] = nan
    both = compare(Quantity.SHARE, judged, truth)["ssim"]
    mask = np.ones(truth.shape[:2], bool)
    mask[2, 3] = False
    left_out = compare(Quantity.SHARE, judged, truth, mask)["ssim"]
    assert both is not None
    assert left_out is not None
    count = mask.size  # where both agree the texel counts as alike and is in no window
    assert both == pytest.approx((left_out * (count - 1) + 1) / count)
