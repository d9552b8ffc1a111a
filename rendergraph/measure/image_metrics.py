"""How far an image is from another: plain numpy metrics, float64, over all texels and channels.

``image`` is the one judged and ``truth`` what it is held against, equal shapes ``[height, width, channels]``; integers
are taken as shares of their type's full range. NaN or infinities that stand in both images at the same texel agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log10, sqrt
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[Any]

#: Added to the squared truth in :func:`relative_mse`, so that black does not divide by zero.
EPSILON: Final = 1e-3


@dataclass(frozen=True, slots=True)
class ImageError:
    """All metrics of one comparison. ``psnr`` is None for equal images, in dB otherwise."""

    max: float
    mean: float
    rmse: float
    psnr: float | None
    rel_mse: float
    worst_texel: tuple[int, int]  # x, y from the lower left
    differing: float  # share of texels


def compare_images(image: Pixels, truth: Pixels) -> ImageError:
    """Every metric at once. Raises ``ValueError`` for unequal shapes or empty images."""
    difference = absolute_difference(image, truth)
    squared = float(np.mean(difference**2))
    peak = np.asarray(difference.max(axis=-1))
    y, x = np.unravel_index(int(np.argmax(peak)), peak.shape)
    return ImageError(
        max=float(peak.max()),
        mean=float(difference.mean()),
        rmse=sqrt(squared),
        psnr=psnr(squared),
        rel_mse=relative_mse(image, truth),
        worst_texel=(int(x), int(y)),
        differing=float((peak > 0).mean()),
    )


def absolute_difference(image: Pixels, truth: Pixels) -> npt.NDArray[np.float64]:
    """``|image - truth|`` a channel; infinite where only one of the two is finite. Raises ``ValueError``."""
    if image.shape != truth.shape or image.size == 0 or image.ndim != 3:
        raise ValueError(f"shapes {image.shape} and {truth.shape} are no two images of one size")
    a, b = _unit(image), _unit(truth)
    with np.errstate(invalid="ignore"):
        difference = np.abs(a - b)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    return np.where(same, 0.0, np.where(np.isfinite(difference), difference, inf))


def relative_mse(image: Pixels, truth: Pixels) -> float:
    """Mean of ``(image - truth)^2 / (truth^2 + EPSILON)``: an error in the dark weighs as much as one in the light."""
    difference = absolute_difference(image, truth)
    against = np.nan_to_num(_unit(truth), nan=0.0, posinf=0.0, neginf=0.0)
    return float(np.mean(difference**2 / (against**2 + EPSILON)))


def psnr(mean_squared: float, peak: float = 1.0) -> float | None:
    """Peak signal-to-noise ratio in dB for a mean squared error; None for 0, where it would be infinite."""
    if mean_squared == 0.0:
        return None
    return 10.0 * log10(peak * peak / mean_squared) if mean_squared < inf else -inf


def _unit(pixels: Pixels) -> npt.NDArray[np.float64]:
    values = pixels.astype(np.float64)
    return values / np.iinfo(pixels.dtype).max if np.issubdtype(pixels.dtype, np.integer) else values
