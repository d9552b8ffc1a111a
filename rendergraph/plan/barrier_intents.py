"""Compares the barriers that the author stated with those that the accesses call for.

To be stated: every hazard within the frame between two passes on one resource. What happens inside one pass, across
the frame boundary, or only because two resources share memory is the planner's business; stating it is allowed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.plan.graph import BarrierIntent, Graph
from rendergraph.plan.plan import Hazard


def compare_intents(
    graph: Graph, hazards: Iterable[tuple[Hazard, bool]], live: Mapping[str, str]
) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """Errors (missing) and remarks (redundant, wrong kind, culled). ``live`` maps each sub-pass that runs to its pass;
    a hazard comes with whether both ends lie in one frame. Nothing is compared when the author stated no barriers.
    """
    if graph.barriers is None:
        return [], []
    derived: dict[tuple[str, str, str], set[str]] = {}  # (resource, earlier, later), by pass and by sub-pass -> kinds
    due: dict[tuple[str, str, str, str], Hazard] = {}
    for hazard, same_frame in hazards:
        if hazard.resource != hazard.previous_resource:
            continue
        earlier, later = live[hazard.earlier], live[hazard.later]
        for a in (earlier, hazard.earlier):
            for b in (later, hazard.later):
                derived.setdefault((hazard.resource, a, b), set()).add(hazard.kind)
        if same_frame and earlier != later:
            due[hazard.resource, hazard.earlier, hazard.later, hazard.kind] = hazard
    stated = {(i.resource, i.after, i.before, i.kind) for i in graph.barriers}
    errors: list[Diagnostic] = []
    told: set[tuple[str, str, str, str]] = set()
    for hazard in due.values():
        earlier, later = live[hazard.earlier], live[hazard.later]
        ends = [(a, b) for a in (earlier, hazard.earlier) for b in (later, hazard.later)]
        if any((hazard.resource, a, b, hazard.kind) in stated for a, b in ends):
            continue
        if (key := (hazard.resource, earlier, later, hazard.kind)) not in told:
            told.add(key)
            data = {"resource": hazard.resource, "after": earlier, "before": later, "kind": hazard.kind}
            errors.append(diagnose("RG401", graph.passes[later].position, **data))
    present = {*live, *live.values()}
    remarks = [found for i in graph.barriers if (found := _remark(i, derived, present)) is not None]
    return errors, remarks


def _remark(
    intent: BarrierIntent, derived: Mapping[tuple[str, str, str], set[str]], present: set[str]
) -> Diagnostic | None:
    data = {"resource": intent.resource, "after": intent.after, "before": intent.before, "kind": intent.kind}
    gone = [name for name in (intent.after, intent.before) if name not in present]
    if gone:
        return diagnose("RG404", intent.position, **data, gone=gone[0])
    kinds = derived.get((intent.resource, intent.after, intent.before))
    if kinds is None:
        return diagnose("RG402", intent.position, **data)
    if intent.kind not in kinds:
        return diagnose("RG403", intent.position, **data, needed=", ".join(sorted(kinds)))
    return None
