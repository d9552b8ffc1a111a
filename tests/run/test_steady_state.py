"""From the second frame on nothing is created, compiled or uploaded; and history really is the last frame."""

import ctypes
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from rendergraph.device.context import open_device
from rendergraph.device.gl import SIGNATURES
from rendergraph.document.load import load_document
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.run.result import SteadyState

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


def test_no_raw_call_creates_or_uploads_after_the_first_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    """The counters see what goes through the device layer; this sees every entry point."""
    gl = open_device().gl
    made: Counter[str] = Counter()
    makers = ("glCreate", "glGenTextures", "glNamedBuffer", "glTextureSubImage", "glTextureStorage", "glTextureView")
    for name in SIGNATURES:
        if name.startswith(makers):

            def counted(*arguments: object, name: str = name, call: object = getattr(gl, name)) -> object:
                made[name] += 1
                return call(*arguments)  # type: ignore[operator]

            monkeypatch.setattr(gl, name, counted)
    totals = []
    for frames in (1, 5):
        made.clear()
        options = RenderOptions(size=(96, 54), frames=frames, samples=0)
        render_document(load_document("deferred_shading", SMALL), options)
        totals.append(dict(made))
    # More frames need larger blocks of frame constants, not more calls.
    assert totals[0] == totals[1]
    assert sum(totals[0].values()) > 50


def test_objects_carry_the_graphs_names() -> None:
    device = open_device()
    seen: dict[str, set[str]] = {}

    def remember(identifier: int, name: int, label: str) -> None:
        given = ctypes.create_string_buffer(256)
        original(identifier, name, label)
        device.gl.glGetObjectLabel(identifier, name, len(given), None, given)
        seen.setdefault(hex(identifier), set()).add(given.value.decode())

    original = device.name
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(device), "name", staticmethod(remember))
        device.programs.clear()
        document = load_document("deferred_shading", SMALL)
        result = render_document(document, RenderOptions(size=(96, 54), samples=0))
    textures, buffers, framebuffers, programs = (seen[hex(kind)] for kind in (0x1702, 0x82E0, 0x8D40, 0x82E2))
    # A texture that several resources use in turn names them all.
    named = {name for label in textures for name in label.split(", ")}
    assert set(result.plan.slot_of) | {"image"} <= named
    assert {"Frame", "Instances", "transient buffers"} <= buffers
    assert "light.light" in framebuffers
    assert any("deferred_lighting.frag" in label for label in programs)


def test_frames_are_handed_over_as_they_come_and_not_kept(tmp_path: Path) -> None:
    (tmp_path / "g.yaml").write_text(COUNTER.replace("now_{frame}.npy", '"now_{frame}.npy"').replace('""', '"'))
    (tmp_path / "step.frag").write_text(STEP.lstrip())
    taken: dict[str, float] = {}

    def take(file: str, pixels: np.ndarray) -> None:
        taken[file] = float(pixels.max())
        if len(taken) == 3:
            raise KeyboardInterrupt

    options = RenderOptions(frames=5, samples=0, take_frame=take)
    with pytest.raises(KeyboardInterrupt):
        render_document(load_document(tmp_path / "g.yaml"), options)
    assert taken == {"now_0000.npy": 1.0, "now_0001.npy": 3.0, "now_0002.npy": 7.0}
    result = render_document(
        load_document(tmp_path / "g.yaml"), RenderOptions(frames=2, samples=0, take_frame=lambda *_: None)
    )
    assert not result.images
    assert list(result.files.values()) == ["now_0000.npy", "now_0001.npy"]


def test_a_run_leaves_the_contexts_state_as_it_was_opened() -> None:
    gl = open_device().gl
    render_document(load_document("deferred_shading", SMALL), RenderOptions(size=(96, 54), samples=0))
    assert gl.integer(0x0B72) == 1  # depth write mask
    assert not any(gl.glIsEnabled(capability) for capability in (0x0B71, 0x0B44, 0x8037, 0x864F, 0x0BE2))
    assert (gl.integer(0x0B46), gl.integer(0x8B8D), gl.integer(0x8CA6)) == (0x0901, 0, 0)


def test_moving_lights_move_and_upload_nothing() -> None:
    points = "scene.lights.points={count: 24, seed: 3, intensity: 1.5, circle: 1.5}"
    document = load_document("deferred_lighting", ["scene.detail=0.05", points, "outputs.image.file=f_{frame}.png"])
    result = render_document(document, RenderOptions(size=(96, 54), frames=4, samples=0))
    frames = [result.images[f"image@{i}"].astype(int) for i in range(4)]
    assert all(np.abs(a - b).max() > 20 for a, b in pairwise(frames))
    assert result.steady == SteadyState(0, 0, 0)
    fixed = [
        "scene.detail=0.05",
        points.replace("1.5}", "0}"),
        "passes.tonemap.set.dither=none",
    ]  # dither has a frame's seed
    still = load_document("deferred_lighting", fixed)
    images = [render_document(still, RenderOptions(size=(96, 54), frames=n, samples=0)).images["image"] for n in (1, 3)]
    assert (images[0] == images[1]).all()
