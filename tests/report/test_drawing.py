"""Drawings of graphs: every pass and connection is there, nothing overlaps."""

from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import pytest

from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.drawing import draw_graph, drawing
from rendergraph.report.layered import Box, lay_out

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("name", ["deferred_shading", "compute", "copy"])
@pytest.mark.parametrize("subpasses", [False, True])
def test_svg_is_well_formed_and_complete(name: str, subpasses: bool) -> None:
    plan, _ = plan_without_scene(load_document(name), PlanOptions(cull=False))
    root = ElementTree.fromstring(draw_graph(plan, "svg", subpasses=subpasses))
    texts = {element.text for element in root.iter(f"{SVG}text")}
    graph = drawing(plan, subpasses=subpasses)
    assert set(graph.nodes) <= texts
    assert {c.resource for c in graph.contents} <= texts
    edges = sum(len(c.readers) + (c.writer is not None) for c in graph.contents) + len(graph.history)
    assert len([p for p in root.iter(f"{SVG}path") if "edge" in p.get("class", "")]) == edges


def test_each_content_of_a_resource_is_its_own() -> None:
    plan, _ = plan_without_scene(load_document("deferred_shading"), PlanOptions())
    hdr = [(c.writer, c.readers) for c in drawing(plan).contents if c.resource == "hdr"]
    assert hdr == [("light", ("sky",)), ("sky", ("glass",)), ("glass", ("meter", "tonemap"))]


def test_history_points_back(tmp_path: Path) -> None:
    plan, _ = plan_without_scene(load_document("compute"), PlanOptions())
    graph = drawing(plan)
    assert len(graph.history) == 1
    kinds = {c.key: c.kind for c in graph.contents}
    assert kinds[graph.history[0][1]] == "history"
    assert "-. next frame .->" in draw_graph(plan, "mermaid")
    assert "style=dashed" in draw_graph(plan, "dot")


def overlap(a: Box, b: Box) -> bool:
    """Whether two boxes share area."""
    return a.x < b.x + b.width and b.x < a.x + a.width and a.y < b.y + b.height and b.y < a.y + a.height


def test_layout_keeps_boxes_apart_and_edges_forward() -> None:
    names = [f"n{i}" for i in range(30)]
    edges = [(a, b) for i, a in enumerate(names) for j, b in enumerate(names) if i < j and (i * 7 + j * 3) % 11 == 0]
    layout = lay_out({name: (40.0 + 3 * i, 20.0) for i, name in enumerate(names)}, edges)
    assert not any(overlap(a, b) for a, b in combinations(layout.boxes.values(), 2))
    for points in layout.routes.values():
        xs = [x for x, _ in points]
        assert xs == sorted(xs)
    assert all(b.x >= 0 and b.x + b.width <= layout.width and b.y >= 0 for b in layout.boxes.values())
    assert max(b.y + b.height for b in layout.boxes.values()) <= layout.height


def test_long_edges_do_not_cross_boxes_between() -> None:
    """A -> b -> c and a -> c: the long edge gets a lane of its own beside b."""
    layout = lay_out({"a": (30.0, 20.0), "b": (30.0, 20.0), "c": (30.0, 20.0)}, [("a", "b"), ("b", "c"), ("a", "c")])
    b, route = layout.boxes["b"], layout.routes["a", "c"]
    inside = [y for x, y in route if b.x <= x <= b.x + b.width]
    assert inside
    assert all(y < b.y or y > b.y + b.height for y in inside)
