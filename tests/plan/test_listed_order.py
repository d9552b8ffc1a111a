"""An order by names is taken when it is legal, and refused when it is not."""

from __future__ import annotations

import pytest

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.plan import PlanOptions
from tests.plan.plan_graphs import make_graph, make_pass, reads, writes

GRAPH = make_graph(
    [
        make_pass("a", [writes("x")]),
        make_pass("b", [writes("y")]),
        make_pass("c", [reads("x"), reads("y"), writes("z")]),
        make_pass("gone", [writes("w")]),
    ],
    ["z"],
)


def listed(*names: str) -> tuple[str, ...]:
    """The order planned for a list."""
    options = PlanOptions(order="listed", sequence=tuple(f"{name}.0" for name in names))
    return tuple(step.parent for step in compile_plan(GRAPH, options)[0].order)


def test_each_legal_order_is_taken() -> None:
    assert listed("a", "b", "c") == ("a", "b", "c")
    assert listed("b", "a", "c") == ("b", "a", "c")


@pytest.mark.parametrize(
    "names",
    [("c", "a", "b"), ("a", "c", "b"), ("a", "b"), ("a", "b", "c", "gone"), ("a", "a", "b", "c"), ("a", "b", "d")],
)
def test_what_is_no_legal_order_of_what_runs_is_refused(names: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match="list"):
        listed(*names)
