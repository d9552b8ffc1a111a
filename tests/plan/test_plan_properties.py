"""Every plan of a random graph keeps its promises; checked by other means than the planner's or the verifier's."""

from __future__ import annotations

import random
from dataclasses import replace

from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st
from plan_graphs import graphs
from symbolic_run import run_in_file_order, run_plan

from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import BufferDesc, Graph, Kind
from rendergraph.plan.plan import Plan, PlanOptions

bounded = settings(max_examples=80, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])


def plan_of(graph: Graph, **options: object) -> Plan:
    """The plan, or no example when the graph is rightly refused for being ambiguous."""
    try:
        return compile_plan(graph, PlanOptions(**options))[0]  # type: ignore[arg-type]
    except RenderGraphError as error:
        if {d.code for d in error.diagnostics} <= {"RG230", "RG233"}:
            reject()
        raise


@bounded
@given(graphs(explicit=True))
def test_a_plan_means_what_the_stated_order_says(graph: Graph) -> None:
    assert run_plan(compile_plan(graph)[0]) == run_in_file_order(graph)


@bounded
@given(graphs(), st.integers(0, 1000))
def test_options_never_change_the_result(graph: Graph, seed: int) -> None:
    expected = run_plan(plan_of(graph, alias=False, cull=False))
    for options in (
        PlanOptions(),
        PlanOptions(cull=False),
        PlanOptions(alias=False),
        PlanOptions(order="memory", order_budget=12, seed=seed),
        *(PlanOptions(order="random", seed=seed + i) for i in range(3)),
    ):
        assert run_plan(compile_plan(graph, options)[0]) == expected, options


@bounded
@given(graphs(), st.randoms(use_true_random=False))
def test_shuffling_the_file_changes_nothing(graph: Graph, chance: random.Random) -> None:
    plan = plan_of(graph)
    passes, resources = list(graph.passes.items()), list(graph.resources.items())
    chance.shuffle(passes)
    chance.shuffle(resources)
    shuffled = replace(graph, passes=dict(passes), resources=dict(resources))
    assert compile_plan(shuffled)[0] == plan


@bounded
@given(graphs(), st.sampled_from(["default", "random", "memory"]))
def test_no_two_live_resources_share_memory(graph: Graph, order: str) -> None:
    plan = plan_of(graph, order=order, order_budget=5)
    spans: dict[str, list[int]] = {}
    for at, step in enumerate(plan.order):
        for access in step.accesses:
            spans.setdefault(access.resource, []).append(at)
    for name in graph.outputs:
        spans[name].append(len(plan.order) - 1)
    pooled = [*plan.slot_of, *plan.buffer_of]
    assert all(graph.resources[name].kind is Kind.TRANSIENT for name in pooled)
    for i, a in enumerate(pooled):
        for b in pooled[:i]:
            if max(spans[a][0], spans[b][0]) <= min(spans[a][-1], spans[b][-1]):
                assert plan.slot_of.get(a, -1) != plan.slot_of.get(b, -2)
                if a in plan.buffer_of and b in plan.buffer_of:
                    one, two = plan.buffer_of[a], plan.buffer_of[b]
                    assert one.offset + one.bytes <= two.offset or two.offset + two.bytes <= one.offset


@bounded
@given(graphs())
def test_totals_are_in_order_and_load_is_reached_by_its_peak(graph: Graph) -> None:
    totals = plan_of(graph).totals
    assert totals.load <= totals.placed <= totals.view_pool <= totals.exact_pool <= totals.unshared
    assert totals.used == totals.view_pool
    sizes = 0
    for name in totals.peak:
        desc = graph.resources[name].desc
        sizes += -(-desc.bytes // 256) * 256 if isinstance(desc, BufferDesc) else desc.bytes
    assert sizes == totals.load
    apart = plan_of(graph, alias=False).totals
    assert apart.used == apart.unshared == totals.unshared


@bounded
@given(graphs())
def test_the_memory_order_is_never_worse(graph: Graph) -> None:
    searched = plan_of(graph, order="memory", order_budget=40)
    assert searched.totals.load <= plan_of(graph).totals.load
    assert searched == compile_plan(graph, searched.options)[0]
