"""A small node for tests, as files of a package: unit normals of a height field, its truth, and a random sibling."""

from __future__ import annotations

SLOPE = '''
"""Normals of a height field."""

from typing import Literal

from rendergraph.node.bindings import color, sample
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Measure, Quantity, Reference


class SlopeParams(Params):
    """How steep, and how finely."""

    strength: float = knob(4.0, "Height of one unit, in texels.", gt=0)
    detail: Literal["coarse", "fine"] = knob("fine", "Steps of the result.", accurate=("coarse", "fine"))


class Slope(Node[SlopeParams]):
    """Normals of a height field by central differences."""

    inputs = {"height": Port("Heights.", formats=("r32f", "rgba32f"))}
    outputs = {"normal": Port("Unit normals.", formats=("rgba32f",), like="height")}
    reference = Reference(
        "float64", {"normal": Measure(Quantity.NORMAL, "max", 0.01, "The same differences in float64.", "normal")},
        source="Newton",
    )
    bounds = {"normal": (-1.0, 1.0)}

    def build(self, b):
        """One draw."""
        uniforms = {"u_strength": self.params.strength, "u_steps": 16.0 if self.params.detail == "coarse" else 0.0}
        b.raster("draw", b.program("slope.frag"), color=[color(b.output("normal"))],
                 bind={"u_height": sample(b.input("height"), "linear")}, uniforms=uniforms)
'''

SLOPE_REFERENCE = '''
"""The truth about slopes."""

import numpy as np

from rendergraph.node.reference import Truth


def judge(run):
    height = np.pad(run.inputs["height"][..., 0], 1, mode="edge")
    dx = height[1:-1, 2:] - height[1:-1, :-2]
    dy = height[2:, 1:-1] - height[:-2, 1:-1]
    normal = np.stack([-run.params.strength * dx, -run.params.strength * dy, np.ones_like(dx)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return {"normal": Truth(normal, run.outputs["normal"][..., :3])}


def invariants(run):
    length = np.linalg.norm(run.outputs["normal"][..., :3], axis=-1)
    if np.abs(length - 1).max() > 1e-3:
        yield f"a normal has length {length.flat[np.abs(length - 1).argmax()]:.4f}"
'''

SLOPE_SHADER = """\
#version 450
uniform sampler2D u_height;
uniform float u_strength;
uniform float u_steps;
out vec4 normal;
float height(vec2 at) { return texture(u_height, at / vec2(textureSize(u_height, 0))).r; }
void main() {
    vec2 at = gl_FragCoord.xy;
    float dx = height(at + vec2(1, 0)) - height(at - vec2(1, 0));
    float dy = height(at + vec2(0, 1)) - height(at - vec2(0, 1));
    vec3 n = normalize(vec3(-u_strength * dx, -u_strength * dy, 1.0));
    if (u_steps > 0.0) n = normalize(round(n * u_steps) / u_steps);
    normal = vec4(n, 1.0);
}
"""

#: What a hurried author may get wrong, as replacements in the shader.
MISTAKES = {
    "sign": ("vec3(-u_strength * dx,", "vec3(u_strength * dx,"),
    "no_normalise": ("vec3 n = normalize(vec3(", "vec3 n = (vec3("),
    "half_texel": ("vec2 at = gl_FragCoord.xy;", "vec2 at = gl_FragCoord.xy - 0.5;"),
}

#: Smooth heights that no shift or mirror maps onto themselves.
HEIGHT_SHADER = """\
#version 450
out vec4 color;
void main() {
    vec2 p = gl_FragCoord.xy / 32.0;
    color = vec4(sin(5.0 * p.x + 2.0 * p.y * p.y) * 0.5 + 0.3 * p.x * p.y, 0.0, 0.0, 1.0);
}
"""

DAPPLE = '''
"""Random specks."""

from rendergraph.node.bindings import color, uniform_block
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Measure, Quantity, Reference


class DappleParams(Params):
    """How much light, and how wrong."""

    share: float = knob(0.3, "Mean.", ge=0, le=1)
    bias: float = knob(0.0, "What is added and should not be.")


class Dapple(Node[DappleParams]):
    """White noise about a mean, other in each frame."""

    outputs = {"light": Port("Light.", formats=("r32f",))}
    reference = Reference(
        "analytic", {"mean": Measure(Quantity.SHARE, "rmse", 0.0, "The mean.", "light")}, stochastic=True
    )

    def build(self, b):
        """One draw."""
        b.raster("draw", b.program("dapple.frag"), color=[color(b.output("light"))],
                 uniforms={"u_share": self.params.share + self.params.bias})
'''

DAPPLE_REFERENCE = '''
"""The truth about specks."""

import numpy as np

from rendergraph.node.reference import Truth


def judge(run):
    desc = run.descs["light"]
    return {"mean": Truth(np.full((desc.height, desc.width, 1), run.params.share))}
'''

DAPPLE_SHADER = """\
#version 450
#include <frame.glsl>
uniform float u_share;
out float light;
void main() {
    uvec3 v = uvec3(uvec2(gl_FragCoord.xy), frame.counts.x) * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    light = u_share + 0.5 * (float(v.x >> 8u) / 16777216.0 - 0.5);
}
"""
