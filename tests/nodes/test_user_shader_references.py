"""The truths of the shipped graphs' shaders, told by Python beside them, and mistakes put into those shaders."""

from __future__ import annotations

import pytest
from judged import judge_node, judge_run, passes_of
from observed import mistake

from rendergraph.device.context import Device

pytestmark = pytest.mark.gpu

#: Graph, node, pass.
TOLD = [
    ("fullscreen", "fullscreen", "plasma"), ("compute", "compute", "step"), ("compute", "fullscreen", "show"),
    ("draw", "draw", "cubes"), ("clear", "fullscreen", "plasma"), ("clear", "compute", "count"),
    ("clear", "fullscreen", "show"), ("fxaa", "fullscreen", "star"), ("tonemap", "fullscreen", "paint"),
]  # fmt: skip


@pytest.mark.parametrize(("graph", "node", "name"), TOLD)
@pytest.mark.parametrize("size", ["[96, 54]", "[61, 77]"])
def test_within_tolerance(device: Device, graph: str, node: str, name: str, size: str) -> None:
    frames = ("frame.count=5",) if graph == "compute" else ()
    judged = judge_run(node, passes_of(device, graph, node, f"frame.size={size}", *frames)[name])
    assert judged.above == ()
    assert judged.within


@pytest.mark.parametrize("count", [1, 2])
def test_the_first_generation_and_the_next(device: Device, count: int) -> None:
    assert judge_node(device, "compute", f"frame.count={count}").within == ("u_cells",)


@pytest.mark.parametrize(("graph", "node", "name", "file", "right", "wrong"), [
    ("fullscreen", "fullscreen", "plasma", "plasma.frag", "p.y * 0.8", "p.y * 0.81"),
    ("fullscreen", "fullscreen", "plasma", "plasma.frag", "v_uv - 0.5", "v_uv - 0.5 + 0.5 * frame.viewport.zw"),
    ("compute", "compute", "step", "life.comp", "neighbours == 3u", "neighbours >= 3u"),
    ("compute", "compute", "step", "life.comp", "before * 15u", "before * 14u"),
    ("compute", "fullscreen", "show", "life.frag", "trail * trail", "trail"),
    ("draw", "draw", "cubes", "ring.vert", "0.16 * corner", "0.17 * corner"),
    ("draw", "draw", "cubes", "ring.vert", "view.x * focal / aspect,", "view.x * focal / aspect + view.z / 96.0,"),
    ("draw", "draw", "cubes", "ring.frag", "0.45))), 0.0)", "0.45))), 0.2)"),
    ("fxaa", "fullscreen", "star", "star.frag", "0.4 * floor", "0.41 * floor"),
    ("tonemap", "fullscreen", "paint", "colour_chart.frag", "16.0 - 8.0", "16.0 - 7.99"),
    ("clear", "compute", "count", "histogram.comp", "brightness * 64.0)", "brightness * 63.0)"),
    ("clear", "fullscreen", "show", "histogram.frag", "6.0 * mean", "5.0 * mean"),
])  # fmt: skip
def test_mistakes_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, graph: str, node: str, name: str, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    frames = ("frame.count=5",) if graph == "compute" else ()
    assert judge_run(node, passes_of(device, graph, node, *frames)[name]).above
