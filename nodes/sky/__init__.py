"""Fills what no geometry covers with a sky: Preetham's daylight and a sun disc, or a plain gradient."""

from __future__ import annotations

import math
from typing import Literal

from rendergraph.document.formats import DEPTH, HDR
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.plan.graph import DrawArrays, State


class SkyParams(Params):
    """The model, the state of the air, and the sun's disc."""

    model: Literal["gradient", "analytic"] = knob(
        "analytic",
        "analytic (Preetham 1999; a gradient where the scene has no sun) or gradient (the scene's ambient light).",
    )
    turbidity: float = knob(3.0, "Haze of the analytic model: 2 very clear, 10 hazy.", ge=2.0, le=10.0)
    sun_illuminance: float = knob(
        100.0,
        "Illuminance that the scene's sun stands for: sets the sky's brightness against the sun's.",
        unit="klx",
        gt=0,
        le=1000,
    )
    sun_radius: float = knob(0.2665, "Angular radius of the sun's disc; 0 for none.", unit="deg", ge=0.0, le=10.0)
    horizon: float = knob(0.02, "Sine of the elevation over which sky and ground blend.", gt=0.0, le=1.0)


class Sky(Node[SkyParams]):
    """Draws the sky where the depth is still at the far plane."""

    inputs = {
        "depth": Port(
            "The scene's depth; without it the sky covers everything.",
            formats=tuple(sorted(DEPTH)), optional=True, like="color", samples=(1, 2, 4, 8),
        ),
    }  # fmt: skip
    outputs = {
        "color": Port(
            "Scene-linear radiance.", formats=("rgba16f", *sorted(HDR - {"rgba16f"})), modify=True, samples=(1, 2, 4, 8)
        ),
    }
    needs_scene = True

    def build(self, b: Builder) -> None:
        """One triangle on the far plane, depth-tested where depth is connected."""
        p = self.params
        analytic = p.model == "analytic" and b.requires("sun", "draw")
        uniforms = {"u_horizon": p.horizon}
        if analytic:
            uniforms |= {
                "u_turbidity": p.turbidity,
                "u_sun_illuminance": p.sun_illuminance,
                "u_sun_radius": math.radians(p.sun_radius),
            }
        tested: Attachment | None = None
        if "depth" in b.inputs:
            tested = depth(b.input("depth"), read_only=True)
        fragment = "analytic.frag" if analytic else "gradient.frag"
        b.raster(
            "draw",
            b.program("sky.vert", fragment),
            color=[color(b.output("color"), load=True)],
            depth=tested,
            work=DrawArrays(3),
            state=State(depth_test="closer_equal" if tested else None, depth_write=False),
            uniforms=uniforms,
        )
