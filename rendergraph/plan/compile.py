"""From a graph to a plan: the phases in the order they run, each in a file of its own. Needs no GPU."""

from __future__ import annotations

from rendergraph.document.collector import collector_paused
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.plan.alias import assign_memory
from rendergraph.plan.barrier_intents import compare_intents
from rendergraph.plan.barriers import derive_barriers
from rendergraph.plan.cull import cull
from rendergraph.plan.dependencies import find_flow
from rendergraph.plan.graph import Graph
from rendergraph.plan.index import index_graph
from rendergraph.plan.lifetimes import find_lifetimes
from rendergraph.plan.order import order
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.plan.verify import verify


class PlanError(RuntimeError):
    """The planner broke one of its own rules: a defect of this library, never the user's mistake."""


@collector_paused()
def compile_plan(graph: Graph, options: PlanOptions | None = None) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """Plan a graph; also warnings and notes. Equal graphs give equal plans, however their passes are listed.

    Raises ``RenderGraphError`` with all mistakes of the graph, ``ValueError`` for an unknown kind of order, and
    ``PlanError`` when the independent check of the finished plan finds a fault.
    """
    options = options or PlanOptions()
    # Names become numbers, resources become cells as fine as any access needs.
    index = index_graph(graph)
    # Whose content flows into whom, once it is clear who touches what before whom.
    flow = find_flow(index)
    # Walk back from the outputs; what is not reached does not run.
    live, culled = cull(index, flow, options.cull)
    # One order that keeps every read after its write, and so on.
    numbers, ordered = order(index, flow, live, options)
    steps = tuple(index.subpasses[n] for n in numbers)
    # First and last use, then memory: who may take whose place.
    lifetimes = find_lifetimes(graph, steps)
    memory = assign_memory(graph, lifetimes, options.alias)
    # Barriers are derived on storage, so they come after sharing is known.
    barriers = derive_barriers(graph, steps, memory.slot_of, memory.buffer_of)
    errors, remarks = compare_intents(graph, barriers.hazards, {step.name: step.parent for step in steps})
    if errors:
        raise RenderGraphError(errors)
    plan = Plan(
        graph=graph,
        options=options,
        order=steps,
        culled=tuple(s.name for s, runs in zip(index.subpasses, live, strict=True) if not runs),
        lifetimes=lifetimes,
        slots=memory.slots,
        slot_of=memory.slot_of,
        buffer_of=memory.buffer_of,
        heap_bytes=memory.heap_bytes,
        barriers=barriers.barriers,
        totals=memory.totals,
        decisions=(
            *graph.decisions,
            *culled,
            *flow.decisions,
            *ordered,
            *memory.decisions,
            *barriers.decisions,
        ),
    )
    faults = verify(plan)
    if faults:
        raise PlanError("internal error: the plan breaks its own rules: " + "; ".join(faults[:10]))
    notes = [
        diagnose("RG239", found.position, name=found.name)
        for found, steps_ in zip(index.passes, index.steps, strict=True)
        if steps_ and not any(live[s] for s in steps_)
    ]
    return plan, (*notes, *remarks)
