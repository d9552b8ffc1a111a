"""Checks a finished plan. Shares no code and no table with the phases that made it: a second opinion, not an echo."""

from __future__ import annotations

from rendergraph.plan.plan import Plan
from rendergraph.plan.verify_barriers import check_barriers
from rendergraph.plan.verify_memory import check_memory
from rendergraph.plan.verify_order import check_order


def verify(plan: Plan) -> tuple[str, ...]:
    """Everything wrong with a plan, each with a word in front: order, culled, memory or barrier; empty when sound.

    - order: each sub-pass runs once or is culled; every access finds the content it should, whatever the file's order.
    - culled: nothing that runs, no output and no history misses what was left out.
    - memory: lifetimes are true; nobody shares memory while alive, across view classes, or against its kind.
    - barrier: two or more frames are played through with the barriers, and each hazard has its bit in between.
    """
    faults = check_order(plan)
    if not faults:  # the rest makes sense only of sub-passes that exist
        faults = [*check_memory(plan), *check_barriers(plan)]
    return tuple(faults)
