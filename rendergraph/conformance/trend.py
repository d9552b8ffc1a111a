"""The shape of an error along an axis, from several images of it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite, sqrt
from statistics import fmean, stdev

from rendergraph.measure.sweep.trend import SIGMAS, SLACK, Shape


def shape_over(samples: Sequence[Sequence[float]]) -> Shape:
    """The shape of errors, cheap first, of at least two images.

    Differences are taken image by image: what makes one image harder than another is common to all its values. A step
    counts where its mean is beyond half a percent of the largest mean and beyond three of its standard errors.
    """
    if not all(isfinite(error) for row in samples for error in row):
        return "unknown"
    columns = list(zip(*samples, strict=True))
    slack = SLACK * max(fmean(column) for column in columns)
    whole = _step(columns[0], columns[-1], slack)
    steps = [_step(a, b, slack) for a, b in pairwise(columns)]
    if whole > 0:
        return "rises"
    if any(step > 0 for step in steps):
        return "bumpy"
    return "falls" if whole < 0 else "flat"


def _step(before: Sequence[float], after: Sequence[float], slack: float) -> int:
    """1 where the error rises, -1 where it falls, 0 where that cannot be told."""
    differences = [b - a for a, b in zip(before, after, strict=True)]
    mean, error = fmean(differences), stdev(differences) / sqrt(len(differences))
    if abs(mean) <= max(slack, SIGMAS * error):
        return 0
    return 1 if mean > 0 else -1
