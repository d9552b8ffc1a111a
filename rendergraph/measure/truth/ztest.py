"""A z-test a texel, for outputs that are random: is their mean over frames the truth?

The mean of N frames is off by its standard error even where nothing is wrong. A texel is accepted while it is off by no
more than chance explains at the significance that Sidak's correction leaves to one of many, and the image while the
share of accepted values is high enough: a few outliers of heavy-tailed noise are no bias.

Sources: Sidak, "Rectangular confidence regions for the means of multivariate normal distributions", 1967; Mitsuba 3,
src/render/tests/test_renders.py (significance 0.01, 99.75 % of pixels, variances of at least 1e-4).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, log1p, sqrt

import numpy as np
import numpy.typing as npt

from rendergraph.measure.student import student_critical
from rendergraph.measure.truth.judgement import ZScore

F64 = npt.NDArray[np.float64]

ALPHA = 0.01
REQUIRED = 0.9975
#: The least variance of one frame. A value that never changed in the frames seen may still be a rare event's: taken at
#: its word, it would have to equal the truth exactly.
VARIANCE_FLOOR = 1e-4


class Moments:
    """Mean and variance of images added one by one (Welford, "Note on a method for calculating corrected sums of
    squares and products", 1962): float64 of the images' shape.
    """

    def __init__(self) -> None:
        self.count = 0
        self.mean: F64 = np.zeros(())
        self._squares: F64 = np.zeros(())

    def add(self, image: F64) -> None:
        """Take one more image in."""
        self.count += 1
        step = image - self.mean
        self.mean = self.mean + step / self.count
        self._squares = self._squares + step * (image - self.mean)

    @property
    def variance(self) -> F64:
        """Of one image, without bias; infinite where fewer than two were seen."""
        if self.count < 2:
            return np.full_like(self.mean, np.inf)
        return np.asarray(self._squares / (self.count - 1))


@dataclass(frozen=True, slots=True)
class ZTest:
    """A finished test: ``z`` float64[h, w, c], how many standard errors each value is off; NaN where masked."""

    z: F64
    score: ZScore

    @property
    def passed(self) -> bool:
        """Whether enough values are explained by chance."""
        return self.score.accepted >= self.score.required


def z_test(
    deviation: F64,
    variance: F64,
    frames: int,
    *,
    truth_error: F64 | float = 0.0,
    allowance: float = 0.0,
    mask: npt.NDArray[np.bool_] | None = None,
    alpha: float = ALPHA,
    required: float = REQUIRED,
    floor: float = VARIANCE_FLOOR,
) -> ZTest:
    """Test ``deviation`` float64[h, w, c], the mean over ``frames`` of what was judged less the truth.

    ``variance`` is of one frame, estimated from the same frames, so that Student's t with ``frames - 1`` degrees of
    freedom says what chance explains. ``truth_error`` is the truth's own standard error, ``allowance`` the bias that is
    no fault. What is not finite is never accepted. Raises ``ValueError`` for fewer than two frames.
    """
    if frames < 2:
        raise ValueError(f"{frames} frames have no variance")
    known = np.ones(deviation.shape[:2], bool) if mask is None else mask
    error = np.sqrt(np.maximum(variance, floor) / frames + np.square(truth_error))
    beyond = np.maximum(np.abs(deviation) - allowance, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = np.where(beyond == 0.0, 0.0, beyond / error)
    z = np.where(known[..., None], np.where(np.isfinite(z), z, np.inf), np.nan)
    tested = z[known]
    alpha_texel = sidak(alpha, tested.size)
    accepted = float((tested <= student_critical(alpha_texel, frames - 1)).mean()) if tested.size else 1.0
    largest = float(tested.max()) if tested.size else 0.0
    return ZTest(z, ZScore(frames, accepted, required, alpha_texel, largest))


def sidak(alpha: float, count: int) -> float:
    """The significance of one of ``count`` independent tests, so that any of them fails by chance with ``alpha``."""
    return -expm1(log1p(-alpha) / max(1, count))


def standard_error(variance: F64, frames: int, floor: float = VARIANCE_FLOOR) -> float:
    """Root mean square over the image of the standard error of a mean of ``frames``."""
    return sqrt(float(np.mean(np.maximum(variance, floor))) / frames)
