"""Barriers of random graphs: every hazard covered, nothing more, by comparison with all pairs of accesses."""

from __future__ import annotations

from dataclasses import replace

from hazard_pairs import hazards, uncovered
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from plan_graphs import graphs
from test_plan_properties import plan_of

from rendergraph.plan.graph import Graph
from rendergraph.plan.plan import Plan
from rendergraph.plan.verify import verify

bounded = settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])


def without(plan: Plan, number: int, bit: int) -> Plan:
    """The plan with one bit (0: the texture barrier) of one barrier taken away."""
    old = plan.barriers[number]
    new = replace(old, bits=old.bits & ~bit, texture_barrier=old.texture_barrier and bit != 0)
    rest = [*plan.barriers[:number], new, *plan.barriers[number + 1 :]]
    return replace(plan, barriers=tuple(b for b in rest if b.bits or b.texture_barrier))


@bounded
@given(graphs(max_passes=6), st.booleans(), st.sampled_from(["default", "random"]))
def test_every_hazard_is_covered_and_every_bit_needed(graph: Graph, alias: bool, order: str) -> None:
    plan = plan_of(graph, alias=alias, order=order)
    found = hazards(plan)
    assert not uncovered(plan, found)
    for number, barrier in enumerate(plan.barriers):
        bits = [1 << k for k in range(16) if barrier.bits >> k & 1] + ([0] if barrier.texture_barrier else [])
        for bit in bits:
            poorer = without(plan, number, bit)
            assert uncovered(poorer, found), f"bit {bit:#x} before {barrier.index} is not needed"
            assert any("barrier" in fault for fault in verify(poorer))


@bounded
@given(graphs(max_passes=6))
def test_every_hazard_named_is_real(graph: Graph) -> None:
    plan = plan_of(graph)
    length = len(plan.order)
    names = [step.name for step in plan.order]
    pairs = {(names[a % length], names[b % length]) for a, b, _ in hazards(plan)}
    for barrier in plan.barriers:
        assert barrier.hazards
        for hazard in barrier.hazards:
            assert (hazard.earlier, hazard.later) in pairs
