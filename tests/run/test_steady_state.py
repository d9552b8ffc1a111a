"""From the second frame on nothing is created, compiled or uploaded; and history really is the last frame."""

from pathlib import Path

import numpy as np
import pytest

from rendergraph.device.context import open_device
from rendergraph.document.load import load_document
from rendergraph.run.render import RenderOptions, render_document

pytestmark = pytest.mark.gpu

SMALL = ["scene.detail=0.05", "resources.shadow.fixed=[256, 256]"]


def test_steady_frames_create_nothing_even_when_the_camera_moves() -> None:
    document = load_document("deferred_shading", [*SMALL, "scene.camera.orbit={turns: 1}"])
    result = render_document(document, RenderOptions(size=(96, 54), frames=4, samples=2))
    assert result.steady.objects_created == 0
    assert result.steady.programs_compiled == 0
    assert result.steady.bytes_uploaded == 0


def test_the_counters_count() -> None:
    """The twin of the test above: preparing a run does create, compile and upload."""
    device = open_device()
    device.programs.clear()
    before = device.counters.snapshot()
    render_document(load_document("deferred_shading", SMALL), RenderOptions(size=(96, 54), samples=0))
    made = device.counters - before
    assert made.objects_created > 20
    assert made.programs_compiled >= 8
    assert made.bytes_uploaded > 1000


def test_a_run_leaves_no_objects_behind() -> None:
    device = open_device()
    render_document(load_document("deferred_shading", SMALL), RenderOptions(size=(96, 54), samples=1))
    before = set(device.owned)
    render_document(load_document("deferred_shading", SMALL), RenderOptions(size=(96, 54), samples=1))
    assert {name for name, _ in set(device.owned) - before} <= {"glDeleteSamplers"}


COUNTER = """
rendergraph: 1
frame: {size: [4, 4]}
resources:
  now:    {format: r32f}
  before: {previous: now}
passes:
  step: {node: fullscreen, read: {u_before: before}, write: {o_now: now}, set: {shader: step.frag}}
outputs: {now: {file: now_{frame}.npy}}
"""

STEP = """
#version 450
uniform sampler2D u_before;
out float o_now;
void main() { o_now = texelFetch(u_before, ivec2(gl_FragCoord.xy), 0).r * 2.0 + 1.0; }
"""


def test_history_is_last_frames_content(tmp_path: Path) -> None:
    (tmp_path / "g.yaml").write_text(COUNTER.replace("now_{frame}.npy", '"now_{frame}.npy"').replace('""', '"'))
    (tmp_path / "step.frag").write_text(STEP.lstrip())
    result = render_document(load_document(tmp_path / "g.yaml"), RenderOptions(frames=5, samples=0, poison=True))
    # x -> 2x + 1 from 0: 1, 3, 7, 15, 31
    values = [float(np.unique(result.images[f"now@{i}"])[0]) for i in range(5)]
    assert values == [1.0, 3.0, 7.0, 15.0, 31.0]
    assert result.files["now@3"] == "now_0003.npy"
