"""What star.frag must draw: the arm that each pixel's centre lies in."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rendergraph.node.reference import PassRun, Truth

ARMS = 12
RADIUS = 0.45
#: Share of an arm, and of the height, within which float32 may put a centre on the other side of an edge.
DOUBT = 1e-4


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The colour; not known where a centre lies on an edge, or in the very middle."""
    height, width = run.outputs["color"].shape[:2]
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    radius = np.hypot(x, y) / height
    turn = (np.arctan2(y, x) / (2.0 * np.pi) + 0.0103 + 0.003 * run.index) % 1.0 * ARMS
    within = (turn % 1.0 <= 0.5) & (radius <= RADIUS)
    strength = np.where(within, 2.0 ** (-0.4 * np.floor(turn)), 0.0)[..., None]
    color = (1.0 - strength) * np.array([0.08, 0.1, 0.14]) + strength * np.array([0.95, 0.9, 0.8])
    on_edge = (np.abs(turn * 2.0 - np.round(turn * 2.0)) < 2.0 * DOUBT) & (radius <= RADIUS + DOUBT)
    on_rim = np.abs(radius - RADIUS) < DOUBT
    opaque = np.ones((height, width, 1))
    return {"color": Truth(np.concatenate([color, opaque], axis=-1), mask=~(on_edge | on_rim | (radius == 0.0)))}
