"""`rg attribute`: errors of two passes that are known in closed form."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rendergraph.device.context import Device
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.attribute import AttributeOptions, attribute
from rendergraph.report.attribution import attribution_record, attribution_table
from rendergraph.report.attribution_shape import AttributionRecord
from tests.measure.truth.conftest import Install
from tests.measure.truth.conftest import install as install

#: Adds ``u_add`` to what it reads: by its knob, or so that only its truth knows better.
ADD = '''
"""An offset."""

from rendergraph.node.bindings import color, sample
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Measure, Quantity, Reference


class {name}Params(Params):
    """How wrong."""

    wrong: float = knob(0.0, "Added.", ge=0.0, le=1.0{accurate})


class {name}(Node[{name}Params]):
    """The input and something."""

    inputs = {{"value": Port("What is added to.", formats=("r32f",))}}
    outputs = {{"value": Port("The sum.", formats=("r32f",))}}
    {reference}

    def build(self, b):
        """One draw."""
        b.raster("draw", b.program("add.frag"), color=[color(b.output("value"))],
                 bind={{"u_value": sample(b.input("value"))}}, uniforms={{"u_add": self.params.wrong}})
'''
SHADER = """\
#version 450
uniform sampler2D u_value;
uniform float u_add;
out float value;
void main() { value = texelFetch(u_value, ivec2(gl_FragCoord.xy), 0).r + u_add; }
"""
TRUTH = '''
"""Nothing should be added."""

from rendergraph.node.reference import Truth


def judge(run):
    return {"sum": Truth(run.inputs["value"].copy())}
'''
REFERENCE = 'reference = Reference("analytic", {"sum": Measure(Quantity.SCALAR, "max", 0.0, "Off.", "value")})'
GRAPH = """\
rendergraph: 1
title: Two wrongs
frame: {size: [16, 16], count: 2}
passes:
  start: {node: fullscreen, write: {color: a}, set: {shader: start.frag}}
  first: {node: truthful, read: {value: a}, write: {value: b}, set: {wrong: 0.3}}
  second: {node: knobby, read: {value: b}, write: {value: c}, set: {wrong: 0.1}}
  show: {node: fullscreen, read: {u_c: c}, write: {color: image}, set: {shader: show.frag}}
resources:
  a: {format: r32f}
  b: {format: r32f}
  c: {format: r32f}
outputs: {image: {file: image.npy, format: r32f}}
"""


@pytest.fixture
def graph(install: Install, tmp_path: Path) -> Path:
    knobby = ADD.format(name="Knobby", accurate=', accurate="down"', reference="")
    truthful = ADD.format(name="Truthful", accurate="", reference=REFERENCE)
    install("knobby", {"__init__.py": knobby, "add.frag": SHADER})
    install("truthful", {"__init__.py": truthful, "reference.py": TRUTH, "add.frag": SHADER})
    (tmp_path / "start.frag").write_text("#version 450\nout float v;\nvoid main() { v = 0.25; }\n")
    show = SHADER.replace("u_value", "u_c").replace("+ u_add", "").replace("uniform float u_add;\n", "")
    (tmp_path / "show.frag").write_text(show)
    for name in ("start", "show"):  # exact, as far as they go: nothing of the error is theirs
        text = (tmp_path / f"{name}.frag").read_text()
        (tmp_path / f"{name}.frag").write_text(
            text.replace("out float v;", "out float color;").replace("v =", "color =")
        )
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH.replace("{color: image}", "{value: image}"))
    return path


@pytest.mark.gpu
def test_each_pass_is_given_its_own_error(graph: Path, device: Device) -> None:
    found, document, planned = attribute(str(graph), device)
    assert (found.output, found.quantity, found.metric, found.frame) == ("image", "radiance", "rel_mse", 1)
    by_name = {entry.name: entry for entry in found.passes}
    assert set(by_name) == {"first", "second"}
    assert by_name["first"].replacement.how == "truth"
    assert by_name["first"].replacement.by == ("sum",)
    assert by_name["second"].replacement.how == "setting"
    assert by_name["second"].replacement.by[0].startswith("passes.second.set.wrong=0")
    assert by_name["first"].left > by_name["second"].left > 0.0
    assert by_name["first"].removed > by_name["second"].removed > 0.0
    assert sum(entry.share for entry in found.passes) == pytest.approx(1.0)
    assert found.passes[0].error_per_ms >= found.passes[1].error_per_ms
    assert all(entry.ms > 0.0 and entry.bytes == 16 * 16 * 4 for entry in found.passes)
    record = attribution_record(found, planned, device, "graph.yaml", title=document.model.title)
    AttributionRecord.model_validate(json.loads(json.dumps(record)))
    attribution_table(record)


@pytest.mark.gpu
def test_a_pass_that_is_right_has_no_share(graph: Path, device: Device) -> None:
    found, _, _ = attribute(str(graph), device, AttributeOptions(overrides=("passes.first.set.wrong=0",)))
    by_name = {entry.name: entry for entry in found.passes}
    assert by_name["first"].left == 0.0
    assert by_name["first"].removed == 0.0
    assert by_name["second"].share == 1.0
    assert by_name["second"].left == by_name["second"].removed == found.error


@pytest.mark.gpu
def test_a_knob_at_its_most_accurate_is_named_as_such(graph: Path, device: Device) -> None:
    found, _, _ = attribute(str(graph), device, AttributeOptions(overrides=("passes.second.set.wrong=0",)))
    assert [entry.name for entry in found.passes] == ["first"]
    assert "second" in found.accurate


@pytest.mark.gpu
def test_nothing_to_attribute(graph: Path, device: Device) -> None:
    with pytest.raises(RenderGraphError) as refused:
        attribute("clear", device)
    assert refused.value.diagnostics[0].code == "RG763"
    with pytest.raises(RenderGraphError) as refused:
        attribute(str(graph), device, AttributeOptions(frame=2))
    assert refused.value.diagnostics[0].code == "RG763"
