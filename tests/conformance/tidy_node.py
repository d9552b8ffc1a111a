"""A small node that meets every demand, as files of a package; bad nodes are it with one thing changed."""

from __future__ import annotations

from collections.abc import Mapping

NODE = '''
"""Steps of brightness."""

from rendergraph.node.bindings import color, sample
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference


class TidyParams(Params):
    """How finely, and how bright."""

    levels: int = knob(64, "Steps that a value is stored in.", ge=2, le=4096, accurate="up")
    gain: float = knob(1.0, "What values are multiplied by.", ge=0.0, le=4.0, accurate="neither")


class Tidy(Node[TidyParams]):
    """Multiplies an image and keeps it in steps."""

    inputs = {"color": Port("What is multiplied.", formats=("r32f",))}
    outputs = {"color": Port("The product, in steps, 0 to 4.", formats=("r32f",), like="color")}
    reference = Reference(
        "analytic", {"color": Measure(Quantity.SCALAR, "max", 0.008, "The product.", "color")}, source="Arithmetic."
    )
    bounds = {"color": (0.0, 4.0)}
    extremes = (Extreme("black", "No gain.", ("passes.step.set.gain=0",)),)

    def build(self, b):
        """Two draws: the product, then its steps."""
        scratch = b.texture("scratch", "r32f")
        b.raster("multiply", b.program("multiply.frag"), color=[color(scratch)],
                 bind={"u_color": sample(b.input("color"))}, uniforms={"u_gain": self.params.gain})
        b.raster("quantise", b.program("quantise.frag"), color=[color(b.output("color"))],
                 bind={"u_color": sample(scratch)}, uniforms={"u_levels": float(self.params.levels)})
'''

MULTIPLY = """\
#version 450
uniform sampler2D u_color;
uniform float u_gain;
out vec4 color;
void main() {
    float value = texelFetch(u_color, ivec2(gl_FragCoord.xy), 0).r;
    bool bad = (floatBitsToUint(value) & 0x7fffffffu) >= 0x7f800000u;
    color = vec4(u_gain * clamp(bad ? 0.0 : value, 0.0, 1.0));
}
"""

QUANTISE = """\
#version 450
uniform sampler2D u_color;
uniform float u_levels;
out vec4 color;
void main() { color = vec4(round(texelFetch(u_color, ivec2(gl_FragCoord.xy), 0).r * u_levels) / u_levels); }
"""

REFERENCE = '''
"""The truth about tidy."""

import numpy as np

from rendergraph.node.reference import Truth


def judge(run):
    return {"color": Truth(run.params.gain * np.clip(np.nan_to_num(run.inputs["color"]), 0, 1))}
'''

README = """\
# tidy

Multiplies an image and keeps it in steps.

**Pick it** to test a suite of tests. **Not** for pictures: `tonemap` has better curves.

**Cost.** One fetch and one write a texel, twice.

**Accuracy.** Half a step, which is 0.0078 for 64 of them.

**Source.** Arithmetic, as taught at school.
"""

GRAPH = """\
rendergraph: 1
title: Tidy
frame: {size: [64, 36]}
resources:
  ramp: {format: r32f}
passes:
  paint: {node: fullscreen, write: {color: ramp}, set: {shader: ramp.frag}}
  step: {node: tidy, read: {color: ramp}, write: {color: image}}
outputs: {image: {file: image.npy}}
"""

RAMP = """\
#version 450
in vec2 v_uv;
out vec4 color;
void main() { color = vec4(fract(0.37 * v_uv.x + 0.61 * v_uv.y)); }
"""

FILES: Mapping[str, str] = {
    "__init__.py": NODE,
    "multiply.frag": MULTIPLY,
    "quantise.frag": QUANTISE,
    "reference.py": REFERENCE,
    "README.md": README,
    "example.yaml": GRAPH,
    "ramp.frag": RAMP,
}


def changed(**changes: tuple[str, str]) -> dict[str, str]:
    """The files, with text replaced in some of them: ``changed(node=("levels", "steps"))``."""
    found = dict(FILES)
    names = {"node": "__init__.py", "reference": "reference.py", "readme": "README.md", "graph": "example.yaml"}
    for key, (old, new) in changes.items():
        name = names.get(key, f"{key}.frag")
        assert old in found[name], f"{name} has no {old!r}"
        found[name] = found[name].replace(old, new)
    return found
