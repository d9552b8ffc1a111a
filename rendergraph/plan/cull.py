"""What need not run: everything whose content flows into no output, no kept pass and no history in use."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rendergraph.plan.dependencies import Flow
from rendergraph.plan.graph import Decision, Kind
from rendergraph.plan.index import WRITES, Index

_SHOWN = 8  # names listed as evidence


def cull(index: Index, flow: Flow, enabled: bool) -> tuple[list[bool], list[Decision]]:
    """Whether each sub-pass runs, and a decision for each that does not, for each pass that is gone whole and for each
    resource that nothing touches any more.

    Reasons: ``nothing_reads_it``, ``overwritten_before_read``, ``no_reader_reaches_an_output``, ``writes_nothing``; of
    resources ``unused`` and ``only_culled_passes_use_it``.
    """
    if not enabled:
        return [True] * len(index.subpasses), []
    live = _mark(index, flow)
    if all(live):
        return live, _explain_resources(index, live)
    readers: list[list[int]] = [[] for _ in live]
    for subpass, sources in enumerate(flow.sources):
        for source in sources:
            readers[source].append(subpass)
    written: list[set[str]] = [set() for _ in live]
    for cell, touches in enumerate(index.touches):
        for subpass, flags in touches:
            if flags & WRITES and not live[subpass]:
                written[subpass].add(index.resources[index.resource_of[cell]].name)

    def explain(subject: str, group: Sequence[int]) -> Decision:
        names = sorted(set().union(*(written[s] for s in group)))
        outside = sorted({index.subpasses[r].name for s in group for r in readers[s] if r not in group})
        later = {r for s in group for r in flow.replaced_by.get(s, ()) if r not in group}
        replacing = {index.subpasses[r].name for r in later}
        if not names:
            reason = "writes_nothing"
        elif outside:
            reason = "no_reader_reaches_an_output"
        else:
            reason = "overwritten_before_read" if replacing else "nothing_reads_it"
        evidence = {"writes": names, "readers": outside[:_SHOWN], "overwritten_by": sorted(replacing)[:_SHOWN]}
        return Decision("cull", reason, subject, {key: value for key, value in evidence.items() if value})

    decisions: list[Decision] = []
    for found, steps in zip(index.passes, index.steps, strict=True):
        gone = [s for s in steps if not live[s]]
        if gone and len(gone) == len(steps):
            decisions.append(explain(found.name, steps))
        decisions += [explain(index.subpasses[s].name, (s,)) for s in gone]
    return live, decisions + _explain_resources(index, live)


def _mark(index: Index, flow: Flow) -> list[bool]:
    """Walk back over the data flow from what the graph is for."""
    live = [False] * len(index.subpasses)
    graph = index.graph

    def last_writers(resource: str) -> Iterable[int]:
        return (s for s in (flow.final[cell] for cell in index.cells_of[resource]) if s >= 0)

    stack = [s for name in graph.outputs for s in last_writers(name)]
    history: dict[int, list[int]] = {}  # sub-pass -> writers of what it reads a frame later
    for resource in index.resources:
        if resource.kind is Kind.HISTORY and resource.previous_of is not None:
            source = graph.resources[resource.previous_of]
            while source.previous_of is not None:  # the history of a history keeps the same content alive
                source = graph.resources[source.previous_of]
            writers = list(last_writers(source.name))
            if resource.name in graph.outputs:
                stack += writers
            for cell in index.cells_of[resource.name]:
                for subpass, _ in index.touches[cell]:
                    history.setdefault(subpass, []).extend(writers)
    stack += [s for found, steps in zip(index.passes, index.steps, strict=True) if found.keep for s in steps]
    while stack:
        subpass = stack.pop()
        if not live[subpass]:
            live[subpass] = True
            stack += flow.sources[subpass]
            stack += history.get(subpass, ())
    return live


def _explain_resources(index: Index, live: list[bool]) -> list[Decision]:
    """A decision for each resource that no live sub-pass touches."""
    decisions: list[Decision] = []
    for resource in index.resources:
        touching = {s for cell in index.cells_of[resource.name] for s, _ in index.touches[cell]}
        if not touching:
            if resource.name not in index.graph.outputs:
                decisions.append(Decision("cull", "unused", resource.name))
        elif not any(live[s] for s in touching):
            names = sorted(index.subpasses[s].name for s in touching)
            decisions.append(Decision("cull", "only_culled_passes_use_it", resource.name, {"by": names[:_SHOWN]}))
    return decisions
