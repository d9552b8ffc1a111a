"""Where a frame holds the most transient memory, and who holds it."""

from __future__ import annotations

from dataclasses import dataclass

from rendergraph.plan.lifetimes import live_bytes, storage_bytes, transients
from rendergraph.plan.plan import Plan


@dataclass(frozen=True, slots=True)
class Peak:
    """The first sub-pass (index into ``Plan.order``) at which the most bytes are live, and who with their bytes,
    largest first. ``bytes`` is LOAD.
    """

    index: int
    bytes: int
    holders: tuple[tuple[str, int], ...]


def find_peak(plan: Plan) -> Peak | None:
    """The peak; ``None`` when the plan has no transient memory."""
    live = live_bytes(plan.graph, plan.lifetimes, len(plan.order))
    most = max(live, default=0)
    if not most:
        return None
    index = live.index(most)
    holders = [
        (name, storage_bytes(plan.graph.resources[name]))
        for name in transients(plan.graph, plan.lifetimes)
        if plan.lifetimes[name].first <= index <= plan.lifetimes[name].last
    ]
    return Peak(index, most, tuple(sorted(holders, key=lambda pair: (-pair[1], pair[0]))))
