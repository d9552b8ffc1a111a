"""A node whose error is known in closed form, and a graph of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.measure.truth.conftest import Install
from tests.measure.truth.conftest import install as install

RAMP = '''
"""A ramp in steps."""

from rendergraph.node.bindings import color
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Measure, Quantity, Reference


class RampParams(Params):
    """How finely, and how wrong."""

    steps: int = knob(4, "Steps.", ge=1, le=64, accurate="up")
    planted: int = knob(0, "Said to make it better, makes it worse.", ge=0, le=9, accurate="up")
    idle: int = knob(0, "Said to make it better, does nothing.", ge=0, le=9, accurate="up")


class Ramp(Node[RampParams]):
    """From 0 to 1."""

    outputs = {"value": Port("The ramp.", formats=("r32f",))}
    reference = Reference("analytic", {
        "ramp": Measure(Quantity.SHARE, "rmse", 0.1, "Its distance.", "value"),
        "vague": Measure(Quantity.SHARE, "rmse", 0.01, "A truth that is not sure of itself.", "value", ideal=False),
    })

    def build(self, b):
        """One draw."""
        p = self.params
        b.raster("draw", b.program("ramp.frag"), color=[color(b.output("value"))],
                 uniforms={"u_steps": float(p.steps), "u_planted": 0.01 * p.planted})
'''

RAMP_REFERENCE = '''
"""The truth about ramps."""

import numpy as np

from rendergraph.node.reference import Truth


def judge(run):
    height, width = run.outputs["value"].shape[:2]
    ramp = np.broadcast_to(((np.arange(width) + 0.5) / width)[None, :, None], (height, width, 1)).copy()
    return {"ramp": Truth(ramp), "vague": Truth(ramp, standard_error=0.1)}
'''

RAMP_SHADER = """\
#version 450
uniform float u_steps;
uniform float u_planted;
out float value;
void main() {
    float x = gl_FragCoord.x / 16.0;
    value = (floor(x * u_steps) + 0.5) / u_steps + u_planted;
}
"""

GRAPH = """\
rendergraph: 1
title: A ramp, and twice it
frame: {size: [16, 16]}
passes:
  ramp: {node: ramp, write: {value: half}}
  twice: {node: fullscreen, read: {u_half: half}, write: {color: image}, set: {shader: twice.frag}}
resources:
  half: {format: r32f}
outputs: {image: {file: image.npy, format: rgba32f}}
"""

TWICE = """\
#version 450
uniform sampler2D u_half;
out vec4 color;
void main() { color = vec4(vec3(2.0 * texelFetch(u_half, ivec2(gl_FragCoord.xy), 0).r), 1.0); }
"""


def ramp_error(steps: int, planted: int = 0) -> float:
    """Root mean square distance of the stepped ramp from the ramp, 16 texels wide, in exact terms."""
    centres = [(k + 0.5) / 16 for k in range(16)]
    squares = [((int(x * steps) + 0.5) / steps + 0.01 * planted - x) ** 2 for x in centres]
    return float((sum(squares) / 16) ** 0.5)


@pytest.fixture
def ramp_graph(install: Install, tmp_path: Path) -> Path:
    """``graph.yaml`` with the passes ``ramp`` and ``twice``."""
    install("ramp", {"__init__.py": RAMP, "reference.py": RAMP_REFERENCE, "ramp.frag": RAMP_SHADER})
    (tmp_path / "twice.frag").write_text(TWICE)
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    return path
