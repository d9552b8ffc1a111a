"""Local lights scattered over a volume by a seed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import F64, Light

#: The plastic number's 3D relative: increments of the R3 sequence (Roberts 2018, "The unreasonable effectiveness of
#: quasirandom sequences").
_R3 = np.array([1.2207440846057596**-k for k in (1, 2, 3)])
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
_NEAREST = 0.01  # metres: a light always reaches a little


def scatter_lights(
    count: int,
    low: F64,
    high: F64,
    *,
    seed: int,
    intensity: float,
    radius: float | None,
    cutoff: float,
    circle: float = 0.0,
) -> list[Light]:
    """``count`` point lights spread evenly over the box ``low``..``high`` (metres), in saturated, distinct hues.

    Without a ``radius`` a light reaches as far as its irradiance ``intensity / distance^2`` exceeds ``cutoff``. A
    larger count keeps the first lights where and as they were. Every light's brightest channel is ``intensity``.
    ``circle``: radius of the circles they run, metres; neighbours in number run opposite ways.
    """
    rng = np.random.default_rng(seed)
    shift, hue_shift = rng.random(3), rng.random()
    number = np.arange(count)
    positions = low + (high - low) * ((shift + number[:, None] * _R3) % 1.0)
    colors = _saturated((hue_shift + number * _GOLDEN) % 1.0, 0.7 + 0.3 * ((number * _R3[0]) % 1.0)) * intensity
    reach = radius if radius is not None else max(math.sqrt(intensity / cutoff), _NEAREST)
    return [
        Light((x, y, z), (r, g, b), reach, circle=-circle if index % 2 else circle, phase=index * _GOLDEN % 1.0)
        for index, ((x, y, z), (r, g, b)) in enumerate(zip(positions.tolist(), colors.tolist(), strict=True))
    ]


def _saturated(hue: npt.NDArray[Any], saturation: npt.NDArray[Any]) -> F64:
    """Linear rgb float64[n, 3] of hues 0..1, the largest channel 1."""
    wheel = np.abs((hue[:, None] * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0
    pure: F64 = np.clip(wheel, 0.0, 1.0)
    mixed: F64 = 1.0 - saturation[:, None] * (1.0 - pure)
    return np.asarray(mixed / mixed.max(axis=1, keepdims=True))
