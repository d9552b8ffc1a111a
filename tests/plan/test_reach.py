"""Knowing step by step who comes after whom is the same as finding it out anew; the verifier agrees."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st
from plan_graphs import adds, make_graph, make_pass, reads, writes

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import Graph
from rendergraph.plan.reach import Reach
from rendergraph.plan.verify_reach import Reach as VerifiedReach
from rendergraph.plan.verify_users import find_users

bounded = settings(max_examples=150, deadline=None, derandomize=True)

PASSES = 10
EDGES = st.lists(
    st.tuples(st.integers(0, PASSES - 1), st.integers(0, PASSES - 1)).filter(lambda e: e[0] < e[1]), max_size=14
)


def closure(edges: list[tuple[int, int]]) -> set[tuple[int, int]]:
    """All pairs that the edges, chained, order."""
    found = set(edges)
    while more := {(a, d) for a, b in found for c, d in found if b == c} - found:
        found |= more
    return found


@bounded
@given(EDGES, st.lists(EDGES, max_size=3), st.sets(st.integers(0, PASSES - 1), min_size=1))
def test_added_edges_are_known_to_all_who_are_asked(
    first: list[tuple[int, int]], rounds: list[list[tuple[int, int]]], asked: set[int]
) -> None:
    followers: list[dict[int, str]] = [{} for _ in range(PASSES)]
    for a, b in first:
        followers[a][b] = ""
    reach = Reach(followers, range(PASSES), range(PASSES))
    known = list(first)
    for edges in rounds:
        new = [(a, b) for a, b in edges if a in asked and b in asked]  # only contests still open add any
        for a, b in new:
            followers[a][b] = ""
        before = closure(known)
        known += new
        grown = reach.add(followers, new, asked)
        after = closure(known)
        learnt = {a for a, b in after - before}
        assert learnt & asked <= grown <= learnt
        for p in asked:
            assert {w for w in range(PASSES) if reach(p, w)} == {w for w in range(PASSES) if (p, w) in after}


def test_a_circle_is_seen() -> None:
    followers: list[dict[int, str]] = [{1: ""}, {2: ""}, {}]
    reach = Reach(followers, [0, 1, 2], [0, 1, 2])
    assert not reach.in_circle([0, 1, 2])
    followers[2][0] = ""
    assert reach.in_circle(reach.add(followers, [(2, 0)], {0, 1, 2}))


def test_writers_without_an_order_make_no_chain() -> None:
    followers: list[dict[int, str]] = [{1: "", 2: ""}, {}, {}]
    reach = Reach(followers, [0, 1, 2], [0, 1, 2])
    assert reach.chain([1, 0]) == [0, 1]
    assert reach.chain([0, 1, 2]) is None


def ladder(rungs: int) -> Graph:
    """Each rung adds to two resources and reads the one before: who adds first follows from the rung below."""
    names = [f"t{i}" for i in range(rungs + 1)]
    made = [make_pass(f"make{name}", [writes(name)]) for name in names]
    climbing = [
        make_pass(f"rung{i}", [*([reads(f"t{i - 1}")] if i else []), adds(f"t{i}"), adds(f"t{i + 1}")])
        for i in range(rungs)
    ]
    return make_graph([*made, *climbing], [names[-1]])


def test_a_ladder_is_climbed_rung_by_rung() -> None:
    plan, _ = compile_plan(ladder(9))
    rungs = [step.parent for step in plan.order if step.parent.startswith("rung")]
    assert rungs == [f"rung{i}" for i in range(9)]


def test_the_verifier_climbs_it_too() -> None:
    graph = ladder(9)
    plan, _ = compile_plan(graph)
    reach = VerifiedReach(graph, find_users(graph, {step.name: at for at, step in enumerate(plan.order)}))
    assert reach.chains["t4", 0, 0] == ["maket4", "rung3", "rung4"]
    assert all(reach("rung0", f"rung{i}") for i in range(1, 9))
    assert not any(reach(f"rung{i}", "rung0") for i in range(1, 9))
