"""Many errors as one number. Each takes at least one error, float64 of any shape, all of them at least 0."""

from __future__ import annotations

from math import inf, log10, sqrt
from typing import Final

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]

#: Added to the squared truth in :func:`relative_mse`, so that black does not divide by zero.
EPSILON: Final = 1e-3


def rmse(errors: F64) -> float:
    """Root of the mean square."""
    return sqrt(mean_square(errors))


def mean_square(errors: F64) -> float:
    """Mean of the squares."""
    with np.errstate(over="ignore"):
        return float(np.square(errors).mean())  # not a dot product, whose last digits depend on BLAS's threads


def percentile(errors: F64, percent: int) -> float:
    """The smallest error that at least ``percent`` % of all do not exceed (nearest rank): one that occurred."""
    rank = -(-percent * errors.size // 100) - 1
    return float(np.partition(errors.ravel(), rank)[rank])


def psnr(mean_squared: float, peak: float = 1.0) -> float | None:
    """Peak signal-to-noise ratio in dB for a mean squared error; None for 0, where it would be infinite."""
    if mean_squared == 0.0:
        return None
    return 10.0 * log10(peak * peak / mean_squared) if mean_squared < inf else -inf


def relative_mse(errors: F64, truth: F64) -> float:
    """Mean of ``error^2 / (truth^2 + EPSILON)``: an error in the dark weighs as much as one in the light."""
    against = np.where(np.isfinite(truth), truth, 0.0)
    with np.errstate(over="ignore"):
        return float(np.mean(errors**2 / (against**2 + EPSILON)))
