"""Counters of graphs that can be counted by hand, and the device's own counts beside them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from rendergraph.device.context import Device, open_device
from rendergraph.device.statistics import count_statistics, has_statistics
from rendergraph.document.load import load_document
from rendergraph.run.counting import triangles_of
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.run.result import FrameResult, StepCounters

pytestmark = pytest.mark.gpu

FRAG = "#version 450\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"
#: A square over a quarter of the target, two triangles.
VERT = """#version 450
void main() {
    vec2 p = vec2[](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1))[gl_VertexID % 6];
    gl_Position = vec4(p - 1.0, 0.5, 1.0);
}
"""
#: Arguments of two draws, of 6 vertices twice and of 3 vertices once; and of a dispatch of 2 x 3 x 4 groups.
ARGUMENTS = """#version 450
layout(local_size_x = 1) in;
buffer Draws { uint words[]; };
void main() {
    uint w[16] = uint[](6, 2, 0, 0, 3, 1, 0, 0, 2, 3, 4, 0, 0, 0, 0, 0);
    for (int i = 0; i < 16; ++i) words[i] = w[i];
}
"""
ADD = """#version 450
layout(local_size_x = 8) in;
buffer Out { uint words[]; };
void main() { atomicAdd(words[0], 1u); }
"""
FILL = {"node": "fullscreen", "write": {"c": "a"}, "set": {"shader": "a.frag"}}


def run(folder: Path, passes: dict[str, Any], samples: int = 1, **resources: Any) -> FrameResult:
    """A 64 x 32 frame."""
    for name, text in {"a.frag": FRAG, "a.vert": VERT, "args.comp": ARGUMENTS, "add.comp": ADD}.items():
        (folder / name).write_text(text)
    graph = {
        "rendergraph": 1, "frame": {"size": [64, 32]}, "resources": {"a": {"format": "rgba8"}, **resources},
        "passes": passes, "outputs": {"a": {"file": "a.png"}},
    }  # fmt: skip
    (folder / "g.yaml").write_text(yaml.safe_dump(graph, sort_keys=False))
    return render_document(load_document(folder / "g.yaml"), RenderOptions(samples=samples))


def draw(**settings: Any) -> dict[str, Any]:
    return {"node": "draw", "write": {"c": "a"}, "set": {"vertex": "a.vert", "fragment": "a.frag", **settings}}


def counters(result: FrameResult, step: str) -> StepCounters:
    return next(c for c in result.counters if c.name == step)


def test_a_full_screen_pass(tmp_path: Path) -> None:
    found = counters(run(tmp_path, {"p": FILL}), "p.draw")
    assert (found.draws, found.draw_calls, found.triangles, found.dispatches) == (1, 1, 1, 0)
    assert (found.bytes_read, found.bytes_written) == (0, 64 * 32 * 4)
    if has_statistics(open_device()):
        assert found.statistics is not None
        assert found.statistics["vertices"] == 3
        assert found.statistics["primitives"] == 1
        # Every texel is shaded once; helpers of the triangle's edge, outside the target, may be counted with it.
        assert 64 * 32 <= found.statistics["fragments"] <= 2 * 64 * 32
        assert found.statistics["compute_invocations"] == 0


@pytest.mark.parametrize(
    ("settings", "draws", "calls", "triangles"),
    [
        ({"vertices": 6}, 1, 1, 2),
        ({"vertices": 6, "instances": 5}, 1, 1, 10),
        ({"vertices": 6, "instances": 5, "separate": True}, 5, 5, 10),
        ({"vertices": 6, "topology": "points"}, 1, 1, 0),
        ({"vertices": 6, "topology": "triangle_strip"}, 1, 1, 4),
    ],
)
def test_draws(tmp_path: Path, settings: dict[str, Any], draws: int, calls: int, triangles: int) -> None:
    found = counters(run(tmp_path, {"p": draw(**settings)}), "p.draw")
    assert (found.draws, found.draw_calls, found.triangles) == (draws, calls, triangles)
    if found.statistics is not None and settings.get("topology") != "points":
        assert found.statistics["primitives"] == triangles
    if found.statistics is not None:
        assert found.statistics["vertices"] == 6 * settings.get("instances", 1)


def test_indirect_work_is_counted_by_its_arguments(tmp_path: Path) -> None:
    passes = {
        "args": {"node": "compute", "write": {"Draws": "args"}, "set": {"shader": "args.comp", "groups": [1, 1, 1]}},
        "p": {**draw(indirect="args", draws=2), "read": {"args": "args"}},
    }
    result = run(tmp_path, passes, args={"bytes": 64})
    found = counters(result, "p.draw")
    assert (found.draws, found.draw_calls, found.triangles) == (2, 1, 2 * 2 + 1)
    assert found.bytes_read == 32
    assert counters(result, "args.dispatch").groups == 1
    untold = counters(run(tmp_path, passes, samples=0, args={"bytes": 64}), "p.draw")
    assert untold.triangles is None, "without a counted frame nobody knows"
    assert (untold.draws, untold.statistics) == (2, None)


def test_dispatches(tmp_path: Path) -> None:
    passes = {
        "zero": {"node": "clear", "write": {"target": "n"}, "set": {"value": 0}},
        "add": {
            "node": "compute", "write": {"Out": "n"}, "keep": True,
            "set": {"shader": "add.comp", "groups": [2, 3, 4], "update": ["Out"]},
        },
        "p": FILL,
    }  # fmt: skip
    found = counters(run(tmp_path, passes, n={"bytes": 256}), "add.dispatch")
    assert (found.dispatches, found.groups, found.draws) == (1, 24, 0)
    assert (found.bytes_read, found.bytes_written) == (256, 256)
    if found.statistics is not None:
        assert found.statistics["compute_invocations"] >= 24 * 8


def test_scene_draws_count_every_instance() -> None:
    result = render_document(load_document("gbuffer"), RenderOptions(size=(32, 18), samples=1))
    drawn = [c for c in result.counters if c.draws]
    assert sum(c.draws for c in drawn) >= sum(c.draw_calls for c in drawn) > 0
    for found in drawn:
        if found.statistics is not None:
            assert found.statistics["primitives"] == found.triangles
            assert found.triangles is not None
            assert found.statistics["vertices"] == 3 * found.triangles


def test_counting_is_not_timing_and_leaves_no_query(tmp_path: Path) -> None:
    device = open_device()
    before = device.counters.snapshot()
    owned = set(device.owned)
    ran: list[int] = []
    count_statistics(device, lambda: ran.append(1))
    assert ran == [1]
    assert device.counters == before
    assert set(device.owned) == owned


def test_a_device_that_does_not_count_still_runs(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rendergraph.device.statistics.EXTENSION", "GL_none")
    ran: list[int] = []
    assert count_statistics(device, lambda: ran.append(1)) is None
    assert ran == [1]


def test_topologies() -> None:
    assert [triangles_of("triangles", v) for v in (0, 2, 3, 7)] == [0, 0, 1, 2]
    assert [triangles_of("triangle_strip", v) for v in (0, 2, 3, 7)] == [0, 0, 1, 5]
    assert triangles_of("patches", 6) == 2
    assert triangles_of("lines", 6) == triangles_of("points", 6) == 0


def test_a_copy_through_the_host_keeps_every_bit_and_is_counted(tmp_path: Path) -> None:
    noise = "#version 450\nout vec4 c;\nvoid main() { c = fract(gl_FragCoord.xyxy * vec4(0.37, 0.71, 0.013, 0.19)); }\n"
    (tmp_path / "n.frag").write_text(noise)
    passes = {
        "n": {"node": "fullscreen", "write": {"c": "s"}, "set": {"shader": "n.frag"}},
        "h": {"node": "copy", "read": {"source": "s"}, "write": {"destination": "a"}, "set": {"path": "host"}},
        "k": {"node": "copy", "read": {"source": "s"}, "write": {"destination": "d"}, "keep": True},
    }
    size = {"fixed": [64, 32]}
    for format in ("rgba8", "r11g11b10f", "rgba16f", "rgb10_a2"):
        result = run(tmp_path, passes, a={"format": format}, s={"format": format}, d={"format": format, **size})
        found = counters(result, "h.copy")
        texel = 8 if format == "rgba16f" else 4
        assert found.host_bytes == found.bytes_written == 64 * 32 * texel
        assert counters(result, "k.copy").host_bytes == 0
        captured = render_document(load_document(tmp_path / "g.yaml"), RenderOptions(samples=0, captures=("d",)))
        assert np.array_equal(captured.images["a"], captured.captures["d"])
        assert np.ptp(captured.captures["d"].astype(np.float64)) > 0
