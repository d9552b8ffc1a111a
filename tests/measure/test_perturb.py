"""Perturbed runs of a document on the device: what `rg render --bound` records, and what it leaves behind."""

from pathlib import Path

import pytest

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.measure.perturb import perturb_document
from rendergraph.measure.perturb_rounds import ROUNDS
from rendergraph.report.timing_shape import BoundRecord
from rendergraph.run.render import RenderOptions, render_document

pytestmark = pytest.mark.gpu

SHADER = """#version 450
out vec4 c;
void main() { float x = gl_FragCoord.x; for (int i = 0; i < 2000; ++i) x = fract(x * 1.7); c = vec4(x); }
"""
#: The copy fits at 64 x 36 alone.
GRAPH = """rendergraph: 1
frame: {size: [64, 36]}
resources: {fixed: {format: rgba8, fixed: [64, 36]}, image: {format: rgba8}}
passes:
  p: {node: fullscreen, write: {c: fixed}, set: {shader: p.frag}}
  q: {node: copy, read: {source: fixed}, write: {destination: image}}
outputs: {image: {file: image.png}}
"""


def test_a_shipped_graph_that_waits(device: Device) -> None:
    document = load_document("case_sync")
    seen: list[tuple[str, int, int]] = []
    owned = set(device.owned)
    options = RenderOptions(size=(320, 180), samples=0)
    found = perturb_document(document, options, lambda stage, done, total: seen.append((stage, done, total)))
    BoundRecord.model_validate(found)
    assert set(found["runs"]) == {"base", "half_resolution", "nothing_rasterised", "no_draws", "no_readback"}
    assert all(len(rounds) == ROUNDS for rounds in found["runs"].values())
    assert found["evidence"]["readback_bytes"] > 0
    assert seen == [("perturbed runs", done, ROUNDS) for done in range(ROUNDS + 1)]
    left = {delete for delete, _ in device.owned.keys() - owned}
    assert left <= {"glDeleteSamplers"}, "nothing stays but the samplers that all runs share"
    device.check()


def test_it_disturbs_no_later_render(device: Device) -> None:
    document, options = load_document("tonemap"), RenderOptions(size=(32, 18), samples=0)
    before = render_document(document, options).images
    perturb_document(document, options)
    after = render_document(document, options).images
    assert {name: pixels.tobytes() for name, pixels in before.items()} == {
        name: pixels.tobytes() for name, pixels in after.items()
    }


def test_a_graph_that_has_no_half_size(device: Device, tmp_path: Path) -> None:
    (tmp_path / "p.frag").write_text(SHADER)
    (tmp_path / "g.yaml").write_text(GRAPH)
    found = perturb_document(load_document(str(tmp_path / "g.yaml")), RenderOptions(samples=0))
    BoundRecord.model_validate(found)
    assert found["evidence"]["half_resolution"] is None
    assert "half_resolution" not in found["runs"]
