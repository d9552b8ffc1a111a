"""Errors as shares of what is allowed, which differs from texel to texel: 1 is the most that any of them may err."""

from __future__ import annotations

import numpy as np

from rendergraph.measure.truth.decode import F64

#: What an error counts as where nothing is allowed, while elsewhere something is.
_NOTHING = 1e-30


def as_shares(judged: F64, value: F64, allowed: F64) -> tuple[F64, F64, float]:
    """(judged, value, tolerance) to compare by their largest difference: 1 where texels may differ by ``allowed``
    (float64 of the shape of ``value``), 0 where nothing may differ anywhere.
    """
    inexact = bool(allowed.any())
    size = np.where(allowed > 0.0, allowed, _NOTHING if inexact else 1.0)
    with np.errstate(invalid="ignore"):  # NaN stays NaN
        return judged / size, value / size, 1.0 if inexact else 0.0
