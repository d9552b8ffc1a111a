"""How far a written image is from another, whatever its numbers mean: what ``rg diff`` says of image files.

``image`` is the one judged and ``truth`` what it is held against, equal shapes ``[height, width, channels]``; integers
are taken as shares of their type's full range. NaN or infinities that stand in both images at the same texel agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.measure.metrics.errors import F64, absolute_error
from rendergraph.measure.metrics.summary import mean_square, psnr, relative_mse

Pixels = npt.NDArray[Any]


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
    if image.shape != truth.shape or image.size == 0 or image.ndim != 3:
        raise ValueError(f"shapes {image.shape} and {truth.shape} are no two images of one size")
    judged, against = _unit(image), _unit(truth)
    error = absolute_error(judged, against)
    squared = mean_square(error)
    peak = np.asarray(error.max(axis=-1))
    y, x = np.unravel_index(int(np.argmax(peak)), peak.shape)
    return ImageError(
        max=float(peak.max()),
        mean=float(error.mean()),
        rmse=sqrt(squared),
        psnr=psnr(squared),
        rel_mse=relative_mse(error, against),
        worst_texel=(int(x), int(y)),
        differing=float((peak > 0).mean()),
    )


def _unit(pixels: Pixels) -> F64:
    values = pixels.astype(np.float64)
    return values / np.iinfo(pixels.dtype).max if np.issubdtype(pixels.dtype, np.integer) else values
