"""A format is narrowed where nobody can tell, and nowhere else."""

from __future__ import annotations

import pytest

from rendergraph.plan.graph import Decision, Graph, Kind
from rendergraph.plan.narrow_formats import narrow_formats
from tests.plan.plan_graphs import adds, make_graph, make_pass, reads, texture, writes

MAKER = make_pass("make", [writes("x", "clear")])
SHOW = make_pass("show", [reads("x"), writes("image")])


def narrowed(graph: Graph, format: str = "r8") -> tuple[str, list[Decision]]:
    """The format of x after the pass ``make`` declared that this one is enough."""
    decisions: list[Decision] = []
    found = narrow_formats(graph.resources, graph.passes, {"make": {"x": format}}, decisions)
    return found.get("x", graph.resources["x"]).desc.format, decisions  # type: ignore[union-attr]


def graph(*passes: object, outputs: tuple[str, ...] = ("image",), **more: object) -> Graph:
    return make_graph([MAKER, *passes], outputs, descs={"x": texture("rgba16f")}, **more)  # type: ignore[arg-type, list-item]


def test_what_one_pass_clears_and_another_samples_is_narrowed() -> None:
    format, (decision,) = narrowed(graph(SHOW))
    assert format == "r8"
    assert (decision.kind, decision.reason, decision.subject) == ("specialise", "format_narrowed", "x")
    assert decision.evidence == {"from": "rgba16f", "to": "r8", "by": "make", "saved": 16 * 16 * 7}


@pytest.mark.parametrize(
    "found",
    [
        pytest.param(graph(make_pass("show", [reads("x", "copy_from"), writes("image", "copy_to")])), id="copied"),
        pytest.param(graph(make_pass("show", [reads("x", "image_read"), writes("image")])), id="read as an image"),
        pytest.param(graph(make_pass("over", [adds("x")]), SHOW), id="written by another"),
        pytest.param(graph(SHOW, outputs=("image", "x")), id="an output"),
        pytest.param(
            graph(make_pass("show", [reads("x"), reads("last"), writes("image")]), history={"last": "x"}),
            id="a history",
        ),
        pytest.param(graph(SHOW, kinds={"x": Kind.IMPORTED}), id="a file"),
        pytest.param(graph(make_pass("show", [writes("image")])), id="read by nobody"),
    ],
)
def test_what_somebody_could_tell_stays(found: Graph) -> None:
    assert narrowed(found) == ("rgba16f", [])


def test_a_format_that_is_no_narrower_is_left() -> None:
    assert narrowed(graph(SHOW), "rgba32f") == ("rgba16f", [])
    assert narrowed(graph(SHOW), "rg32f") == ("rgba16f", [])
