"""Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004, "Image quality assessment", section III)."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

RADIUS: Final = 5  # an 11 x 11 window
SIGMA: Final = 1.5
C1: Final = 0.01**2  # (K1 L)^2, the values spanning L = 1
C2: Final = 0.03**2

_OFFSETS: Final = np.arange(-RADIUS, RADIUS + 1)
_WINDOW: Final = np.exp(-(_OFFSETS**2) / (2 * SIGMA**2)) / np.exp(-(_OFFSETS**2) / (2 * SIGMA**2)).sum()


def ssim_map(judged: F64, truth: F64, known: Mask | None = None) -> F64:
    """Similarity of the window around each texel, -1 to 1, the mean of the channels: float64[h, w].

    Both images are finite float64[h, w, c] with values in 0..1. A window's weights are those of the Gaussian on texels
    that are ``known`` (bool[h, w]) and inside the image, scaled to a sum of 1: away from masks and edges it is the
    paper's own value. What the result holds at a texel that is not known means nothing.
    """
    weight = np.ones(truth.shape[:2]) if known is None else known.astype(np.float64)
    share = 1.0 / np.maximum(_blur(weight), np.finfo(np.float64).tiny)
    total = np.zeros(truth.shape[:2])
    for channel in range(truth.shape[2]):
        x, y = judged[..., channel], truth[..., channel]
        if known is not None:
            x, y = np.where(known, x, 0.0), np.where(known, y, 0.0)
        mean_x, mean_y = _blur(x) * share, _blur(y) * share
        product, squares = mean_x * mean_y, mean_x**2 + mean_y**2
        covariance = _blur(x * y) * share - product
        variances = _blur(x * x + y * y) * share - squares
        total += (2 * product + C1) * (2 * covariance + C2) / ((squares + C1) * (variances + C2))
    similarity: F64 = total / truth.shape[2]
    return similarity


def _blur(field: F64) -> F64:
    """The Gaussian window's weighted sum around each texel, zeros beyond the edges; one axis after the other."""
    return _blur_rows(np.ascontiguousarray(_blur_rows(field).T)).T


def _blur_rows(field: F64) -> F64:
    # All rows in one correlation: the zeros between them are as wide as the window.
    height, width = field.shape
    padded = np.zeros((height, width + 2 * RADIUS))
    padded[:, :width] = field
    blurred: F64 = np.correlate(padded.ravel(), _WINDOW, "same").reshape(padded.shape)[:, :width]
    return blurred
