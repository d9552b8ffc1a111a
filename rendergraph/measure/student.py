"""Student's t by way of the normal distribution, near enough to decide by: at 4 degrees of freedom 1.5 % too wide.

Source: Wallace, "Bounds on normal approximations to Student's and the chi-square distributions", 1959.
"""

from __future__ import annotations

from math import exp, inf, log1p, sqrt
from statistics import NormalDist

_NORMAL = NormalDist()


def two_sided_p(t: float, freedom: float) -> float:
    """Probability of a value at least as far from zero as ``t``; 1 without degrees of freedom."""
    if freedom <= 0:
        return 1.0
    if freedom == inf:
        return min(1.0, 2.0 * _NORMAL.cdf(-abs(t)))
    deviate = (8 * freedom + 1) / (8 * freedom + 3) * sqrt(freedom * log1p(t * t / freedom))
    return min(1.0, 2.0 * _NORMAL.cdf(-deviate))


def student_critical(alpha: float, freedom: float) -> float:
    """The value with two-sided probability ``alpha``; infinite without degrees of freedom."""
    deviate = -_NORMAL.inv_cdf(alpha / 2)
    if freedom <= 0:
        return inf
    if freedom == inf:
        return deviate
    power = (deviate * (8 * freedom + 3) / (8 * freedom + 1)) ** 2 / freedom
    return sqrt(freedom * (exp(power) - 1)) if power < 700 else inf
