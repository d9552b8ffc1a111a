"""What plasma.frag must draw: the same sines in float64."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rendergraph.node.reference import PassRun, Truth

TAU = 2.0 * np.pi


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The colour, from the pass's own uniforms."""
    uniforms = run.params.uniforms  # type: ignore[attr-defined]
    height, width = run.outputs["color"].shape[:2]
    time = TAU * uniforms["u_speed"] * run.index
    u = (np.arange(width) + 0.5) / width - 0.5
    v = (np.arange(height) + 0.5) / height - 0.5
    x, y = np.meshgrid(u * run.frame.width / run.frame.height * uniforms["u_scale"], v * uniforms["u_scale"])
    wave = np.sin(TAU * x + time) + np.sin(TAU * (0.8 * y + 0.3 * np.sin(2.0 * x)) - time)
    wave += np.sin(TAU * np.hypot(x - 0.4 * np.sin(time), y - 0.4 * np.cos(time)))
    color = 0.5 + 0.5 * np.cos(0.9 * wave[..., None] + TAU * np.array(uniforms["u_tint"]))
    return {"color": Truth(np.concatenate([color, np.ones((height, width, 1))], axis=-1))}
