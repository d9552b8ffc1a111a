"""Truth for forward shading: the light model in float64, and compositing of sorted transparent layers."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rendergraph.nodes.deferred_lighting.reference import shade

__all__ = ["composite", "shade"]

F64 = npt.NDArray[np.float64]


def composite(background: F64, layers: list[tuple[F64, float]]) -> F64:
    """``layers`` (radiance ``float64[..., 3]`` and coverage 0..1), farthest first, over ``background``."""
    result = background
    for radiance, coverage in layers:
        result = radiance * coverage + result * (1.0 - coverage)
    return np.asarray(result, dtype=np.float64)
