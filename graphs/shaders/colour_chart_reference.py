"""What colour_chart.frag must paint: hues along x, 16 stops of radiance along y."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rendergraph.node.reference import PassRun, Truth


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The radiance; not known on the border of the grey tenth."""
    height, width = run.outputs["color"].shape[:2]
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    hue = 6.0 * u
    pure = np.stack([np.abs(hue - 3.0) - 1.0, 2.0 - np.abs(hue - 2.0), 2.0 - np.abs(hue - 4.0)], axis=-1)
    tint = np.where((u >= 0.1)[..., None], np.clip(pure, 0.0, 1.0), 1.0)
    light = 0.18 * tint * 2.0 ** (16.0 * v - 8.0)[..., None]
    return {"color": Truth(np.concatenate([light, np.ones((height, width, 1))], axis=-1), mask=np.abs(u - 0.1) > 1e-6)}
