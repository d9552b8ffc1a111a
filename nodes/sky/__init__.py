"""Fills what no geometry covers with a sky: Preetham's daylight and a sun disc, or a plain gradient."""

from __future__ import annotations

import math
from typing import Literal

from rendergraph.document.formats import DEPTH, HDR
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.plan.graph import DrawArrays, State

EXTREMES = (
    Extreme("clearest_air", "The lower end of turbidity.", ("passes.sky.set.turbidity=2",)),
    Extreme("haziest_air", "The upper end of turbidity.", ("passes.sky.set.turbidity=10",)),
    Extreme("no_disc", "A sun without a disc.", ("passes.sky.set.sun_radius=0",)),
    Extreme("tiny_disc", "A disc whose radiance leaves half floats.", ("passes.sky.set.sun_radius=0.0001",)),
    Extreme("largest_disc", "A disc of twenty degrees.", ("passes.sky.set.sun_radius=10",)),
    Extreme("sharp_horizon", "A horizon without a blend.", ("passes.sky.set.horizon=1.0e-6",)),
    Extreme("no_horizon", "Sky and ground blended over the whole sphere.", ("passes.sky.set.horizon=1",)),
    Extreme("brightest_sky", "A sun that stands for next to nothing.", ("passes.sky.set.sun_illuminance=0.001",)),
    Extreme("gradient", "The scene's ambient light.", ("passes.sky.set.model=gradient",)),
    Extreme("sun_at_zenith", "A sun straight above.", ("scene.lights.sun.direction=[0, -1, 0]",)),
    Extreme("sun_on_horizon", "A level sun.", ("scene.lights.sun.direction=[0, 0, 1]",)),
    Extreme("twilight", "A sun three degrees below.", ("scene.lights.sun.direction=[0, 0.0524, 1]",)),
    Extreme("night", "A sun straight below.", ("scene.lights.sun.direction=[0, 1, 0]",)),
    Extreme("wide_angle", "A field of view of 170 degrees.", ("scene.camera.fov=170",)),
    Extreme("far_away", "A camera a thousand kilometres out.",
            ("scene.camera.position=[1.0e6, 1.5, 0]", "scene.camera.target=[0, 1.0e5, 0]")),
    Extreme("standard_depth", "The far plane at one.", ("frame.depth=standard", "scene.camera.far=50")),
    Extreme("packed_radiance", "Radiance of eleven bits.", ("resources.hdr.format=r11g11b10f",)),
    Extreme("display_target", "A format that holds no radiance.", ("resources.hdr.format=rgba8",), refused="RG320"),
)  # fmt: skip


class SkyParams(Params):
    """The model, the state of the air, and the sun's disc."""

    model: Literal["gradient", "analytic"] = knob(
        "analytic",
        "analytic (Preetham 1999; a gradient where the scene has no sun) or gradient (the scene's ambient light).",
        accurate=("gradient", "analytic"),
    )
    turbidity: float = knob(
        3.0, "Haze of the analytic model: 2 very clear, 10 hazy.", ge=2.0, le=10.0, accurate="neither"
    )
    sun_illuminance: float = knob(
        100.0,
        "Illuminance that the scene's sun stands for: sets the sky's brightness against the sun's.",
        unit="klx",
        gt=0,
        le=1000,
        accurate="neither",
    )
    sun_radius: float = knob(
        0.2665, "Angular radius of the sun's disc; 0 for none.", unit="deg", ge=0.0, le=10.0, accurate="neither"
    )
    horizon: float = knob(
        0.02, "Sine of the elevation over which sky and ground blend.", gt=0.0, le=1.0, accurate="neither"
    )


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
    reference = Reference(
        "analytic",
        {
            "radiance": Measure(
                Quantity.RADIANCE, "rel_mse", 1.06e-6, "The model asked for, in float64; what was there before where "
                "geometry covers it.", port="color", ideal=False,
            ),
            "daylight": Measure(
                Quantity.RADIANCE, "rel_mse", 1.06e-6, "Preetham's daylight, whatever model was asked for.",
                port="color",
            ),
        },
        source="Preetham, Shirley and Smits 1999",
    )  # fmt: skip
    bounds = {"color": (0.0, 65504.0)}
    extremes = EXTREMES

    def build(self, b: Builder) -> None:
        """One triangle on the far plane, depth-tested where depth is connected."""
        p = self.params
        if b.holds.get("depth") == "scene_depth" and b.view is not None and b.view.covered:
            b.leave_out("scene_covers_the_frame", "draw")
            return
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
