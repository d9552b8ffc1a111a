"""Outputs replaced by their truths."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rendergraph.device.context import Device
from rendergraph.document.formats import FORMATS
from rendergraph.document.load import load_document
from rendergraph.measure.truth.decode import decode
from rendergraph.measure.truth.storage import storage_error
from rendergraph.measure.truth.substitute import composited, encode, ideal_measures, replace_outputs
from rendergraph.node.reference import Truth
from rendergraph.plan.graph import TextureDesc
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document

RAMP = '''
"""A ramp in steps."""

from rendergraph.node.bindings import color
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params
from rendergraph.node.reference import Measure, Quantity, Reference


class Ramp(Node[Params]):
    """From 0 to 1, in quarters."""

    outputs = {"value": Port("The ramp.", formats=("rg32f",))}
    reference = Reference("analytic", {"ramp": Measure(Quantity.SHARE, "rmse", 0.1, "Its distance.", "value")})

    def build(self, b):
        """One draw."""
        b.raster("draw", b.program("ramp.frag"), color=[color(b.output("value"))])
'''
TRUTH = '''
"""The truth about ramps: of the first channel, left of the last four texels."""

import numpy as np

from rendergraph.node.reference import Truth


def judge(run):
    ramp = np.broadcast_to(((np.arange(16) + 0.5) / 16)[None, :, None], (16, 16, 1)).copy()
    mask = np.ones((16, 16), bool)
    mask[:, 12:] = False
    return {"ramp": Truth(ramp, run.outputs["value"][..., :1], mask=mask)}
'''
SHADER = """\
#version 450
out vec2 value;
void main() { value = vec2((floor(gl_FragCoord.x / 4.0) + 0.5) / 4.0, 7.0); }
"""
GRAPH = """\
rendergraph: 1
frame: {{size: [16, 16], count: {count}}}
passes:
  ramp: {{node: ramp, write: {{value: half}}}}
  twice: {{node: fullscreen, read: {{u_half: half{more_read}}}, write: {{color: image}}, set: {{shader: twice.frag}}}}
resources:
  half: {{format: rg32f}}
{more}
outputs: {{image: {{file: image.npy, format: rgba32f}}}}
"""
TWICE = """\
#version 450
uniform sampler2D u_half;
out vec4 color;
void main() { color = vec4(2.0 * texelFetch(u_half, ivec2(gl_FragCoord.xy), 0).rg, 0.0, 1.0); }
"""
SUMMING = """\
#version 450
uniform sampler2D u_half;
uniform sampler2D u_last;
out vec4 color;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    color = vec4(texelFetch(u_half, at, 0).rg + texelFetch(u_last, at, 0).rg, 0.0, 1.0);
}
"""


@pytest.fixture
def graph(install: Any, tmp_path: Path) -> Path:
    install("ramp", {"__init__.py": RAMP, "reference.py": TRUTH, "ramp.frag": SHADER})
    (tmp_path / "twice.frag").write_text(TWICE)
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH.format(count=1, more="", more_read=""))
    return path


def ramp() -> tuple[Any, Any]:
    """The ramp as it is and as it should be, float64[16]."""
    at = np.arange(16)
    return (at // 4 + 0.5) / 4, np.where(at < 12, (at + 0.5) / 16, (at // 4 + 0.5) / 4)


def images(path: Path, device: Device, passes: list[str]) -> tuple[Any, Any]:
    document = load_document(path)
    found = replace_outputs(document, plan_document(document, PlanOptions()), device, passes)
    return found.images["image"], found.measures


@pytest.mark.gpu
def test_what_follows_sees_the_truth_where_it_is_known(graph: Path, device: Device) -> None:
    stepped, true = ramp()
    plain, nothing = images(graph, device, [])
    assert nothing == {}
    assert np.allclose(plain[..., 0], 2 * stepped)
    replaced, measures = images(graph, device, ["ramp", "twice"])
    assert measures == {"ramp": ("ramp",)}
    assert np.allclose(replaced[..., 0], 2 * true)
    assert np.array_equal(replaced[..., 1], plain[..., 1]), "channels that the truth does not tell are as they were"


@pytest.mark.gpu
def test_histories_hold_the_truths_of_earlier_frames(graph: Path, device: Device) -> None:
    graph.write_text(GRAPH.format(count=3, more="  last: {previous: image}", more_read=", u_last: last"))
    (graph.parent / "twice.frag").write_text(SUMMING)
    stepped, true = ramp()
    assert np.allclose(images(graph, device, [])[0][..., 0], 3 * stepped)
    assert np.allclose(images(graph, device, ["ramp"])[0][..., 0], 3 * true, atol=1e-5)


@pytest.mark.gpu
def test_an_antialiased_image_becomes_the_supersampled_one(device: Device) -> None:
    document = load_document("fxaa", ["frame.size=[48, 27]"])
    planned = plan_document(document, PlanOptions())
    assert list(ideal_measures(document, "antialias")) == ["coverage"]
    plain = replace_outputs(document, planned, device, []).images["image"]
    found = replace_outputs(document, planned, device, ["antialias"])
    assert found.measures == {"antialias": ("coverage",)}
    levels = len(np.unique(found.images["image"]))
    assert levels > 20
    assert not np.array_equal(found.images["image"], plain)


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_encoding_is_the_inverse_of_decoding(name: str) -> None:
    row = FORMATS[name]
    values = np.linspace(0.0, 1.0, 4 * 16 * row.channels).reshape(4, 16, row.channels)
    if row.channel.value in ("uint", "int"):
        values = np.rint(values * 3)
    stored = encode(values, name)
    back = decode(stored, name)
    assert stored.flags["C_CONTIGUOUS"]
    assert (np.abs(back - values) <= storage_error(name, values) + 1e-6).all()
    if np.issubdtype(stored.dtype, np.integer):
        assert np.array_equal(encode(back, name), stored), "what is stored already stays"


def test_values_beyond_the_range_go_to_its_ends() -> None:
    values = np.array([[[-0.5, 2.0, 0.5, 1.0]]])
    assert encode(values, "rgba8").tolist() == [[[0, 255, 128, 255]]]
    assert encode(np.array([[[1e9]]]), "r16f").tolist() == [[[65504.0]]]


DESC = TextureDesc("rg32f", 4, 4)


@pytest.mark.parametrize(
    ("truth", "possible"),
    [
        (Truth(np.ones((4, 4, 1))), True),
        (Truth(np.ones((4, 4, 2))), True),
        (Truth(np.ones((4, 4, 3))), False),
        (Truth(np.ones((5, 4, 1))), False),
        (Truth(np.ones((4, 4, 1)), np.zeros((4, 4, 1))), True),
        (Truth(np.ones((4, 4, 1)), np.full((4, 4, 1), 0.5)), False),
    ],
)
def test_a_truth_of_something_else_than_the_output_does_not_stand_in(truth: Truth, possible: bool) -> None:
    found = composited(truth, np.zeros((4, 4, 2)), DESC)
    assert (found is not None) == possible
