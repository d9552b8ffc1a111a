"""What shaders/shading.glsl is compiled with and bound to, for every node that shades with it."""

from __future__ import annotations

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.bindings import Binding, read_buffer, sample
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Port
from rendergraph.node.params import Params, knob

#: Input ports of a node that takes the sun's shadow.
SHADOW_PORTS = {
    "shadow_map": Port("The sun's depth map; without it the sun casts no shadow.",
                       formats=("d32f", "d24", "d16"), optional=True, layers=None),
    "cascades": Port("The cascades of the shadow map.", buffer=True, optional=True),
}  # fmt: skip

#: Lights that the smallest uniform block OpenGL 4.5 allows for (16 KiB) has room for, at 64 bytes each.
MOST_UNIFORM_LIGHTS = 16384 // 64


class ShadowParams(Params):
    """How the sun's shadow is filtered: the parameters of every node that takes :data:`SHADOW_PORTS`."""

    shadow_taps: int = knob(
        3,
        "Width of the shadow filter: a box of this many bilinear taps a side.",
        unit="texel",
        ge=1,
        le=9,
        accurate="neither",
    )


def light_model(b: Builder, step: str, shadow_taps: int) -> tuple[dict[str, int], dict[str, Binding]]:
    """The defines and bindings of ``shading.glsl``: what the scene lacks is left out.

    Raises ``RenderGraphError`` RG225 when only one of the two shadow ports is connected.
    """
    connected = [port for port in SHADOW_PORTS if port in b.inputs]
    if len(connected) == 1:
        missing = next(port for port in SHADOW_PORTS if port not in b.inputs)
        problem = f"{connected[0]} is connected without {missing}"
        hint = "connect both outputs of the shadow_map pass, or neither"
        raise RenderGraphError([diagnose("RG225", b.position, name=b.pass_name, problem=problem, hint=hint)])
    sun = b.requires("sun", step)
    shadow = sun and bool(connected) and _may_shadow(b, step)
    local_lights = b.requires("local_lights", step) and _may_light(b, step)
    lights = max(1, b.features.local_lights)
    defines = {
        "SUN": int(sun),
        "SUN_SHADOW": int(shadow),
        "AMBIENT": int(b.requires("ambient", step)),
        "LOCAL_LIGHTS": int(local_lights),
        "SPOT_LIGHTS": int(local_lights and b.requires("spot_lights", step)),
        "UNIFORM_LIGHTS": lights if local_lights and lights <= MOST_UNIFORM_LIGHTS else 0,
    }
    if not shadow:
        return defines, {}
    layers = b.texture_desc(b.input("shadow_map")).layers
    defines |= {"SHADOW_TAPS": shadow_taps, "SHADOW_LAYERS": layers}
    bind = {
        "u_shadow_map": sample(b.input("shadow_map"), "compare"),
        "Cascades": read_buffer(b.input("cascades")),
    }
    return defines, bind


def _may_shadow(b: Builder, step: str) -> bool:
    """Whether the shadow map connected can hold a shadow that falls into view; one of unknown make always can."""
    if b.view is None or b.view.casters or b.holds.get("shadow_map") != "sun_shadow":
        return True
    b.leave_out("nothing_casts_into_view", step)
    return False


def _may_light(b: Builder, step: str) -> bool:
    """Whether a local light reaches the view: beyond its radius it is exactly dark."""
    if b.view is None or b.view.lit:
        return True
    b.leave_out("no_light_reaches_the_view", step, lights=b.features.local_lights)
    return False
