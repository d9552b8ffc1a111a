"""Why each resource shares memory or does not, as decisions."""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence

from rendergraph.plan.graph import Decision, Graph, Kind, Resource
from rendergraph.plan.packing import Block
from rendergraph.plan.plan import Lifetime

_SHOWN = 8  # names listed as evidence
_RUN = 64  # resources looked at together


def explain_never_pooled(graph: Graph, lifetimes: Mapping[str, Lifetime]) -> list[Decision]:
    """Resources that are used but keep memory of their own."""
    found = [graph.resources[name] for name in lifetimes if graph.resources[name].kind is not Kind.TRANSIENT]
    return [Decision("alias", f"never_pooled_{r.kind.value}", r.name, _history_evidence(r)) for r in found]


def _history_evidence(resource: Resource) -> dict[str, str]:
    return {"previous_of": resource.previous_of} if resource.previous_of else {}


def explain_textures(
    members: Sequence[str], groups: Sequence[Sequence[str]], base: int, lifetimes: Mapping[str, Lifetime]
) -> list[Decision]:
    """Each texture of a view class: with whom it shares a slot, ``base`` being the first, or why with none."""
    decisions: list[Decision] = []
    overlaps: _Overlaps | None = None
    for number, tenants in enumerate(groups):
        for name in tenants:
            if len(tenants) > 1:
                others = [t for t in tenants[: _SHOWN + 1] if t != name]
                evidence = {"slot": base + number, "with": others[:_SHOWN]}
                decisions.append(Decision("alias", "shares_slot", name, evidence))
            elif len(members) == 1:
                decisions.append(Decision("alias", "only_one_in_class", name))
            else:
                overlaps = overlaps or _Overlaps(members, lifetimes)
                decisions.append(Decision("alias", "overlaps_in_time", name, {"with": overlaps.find(name)}))
    return decisions


class _Overlaps:
    """The first few of some resources, in their order, that are live at the same time as one of them.

    They are looked for in runs, each with the time that all of it spans: where hundreds of resources wait for the end
    of a frame, they need not each be compared with all that came and went before.
    """

    def __init__(self, members: Sequence[str], lifetimes: Mapping[str, Lifetime]) -> None:
        self._lifetimes = lifetimes
        self._runs: list[tuple[int, int, Sequence[str]]] = []
        for start in range(0, len(members), _RUN):
            run = members[start : start + _RUN]
            lives = [lifetimes[name] for name in run]
            self._runs.append((min(life.first for life in lives), max(life.last for life in lives), run))

    def find(self, name: str) -> list[str]:
        """At most ``_SHOWN`` others."""
        life = self._lifetimes[name]
        found: list[str] = []
        for first, last, run in self._runs:
            if first <= life.last and life.first <= last:
                for other in run:
                    lived = self._lifetimes[other]
                    if other != name and lived.first <= life.last and life.first <= lived.last:
                        found.append(other)
                        if len(found) == _SHOWN:
                            return found
        return found


def explain_buffers(names: Sequence[str], blocks: Sequence[Block], offsets: Sequence[int]) -> list[Decision]:
    """Buffers whose bytes are used again by another share the heap; the rest are alone, and why."""
    decisions: list[Decision] = []
    by_offset = sorted(range(len(names)), key=offsets.__getitem__)
    sharing: dict[int, list[str]] = {i: [] for i in by_offset}
    active: list[tuple[int, int]] = []  # (end, buffer)
    for i in by_offset:
        while active and active[0][0] <= offsets[i]:
            heapq.heappop(active)
        for _, a in active[:_SHOWN]:  # some of those below whose bytes reach up here
            sharing[a].append(names[i])
            sharing[i].append(names[a])
        heapq.heappush(active, (offsets[i] + blocks[i].bytes, i))
    latest_start, earliest_end = max((b.first for b in blocks), default=0), min((b.last for b in blocks), default=0)
    for i, name in enumerate(names):
        if sharing[i]:
            decisions.append(Decision("alias", "shares_heap_range", name, {"with": sorted(sharing[i])[:_SHOWN]}))
        elif len(names) == 1:
            decisions.append(Decision("alias", "only_one_in_class", name))
        else:
            apart = latest_start > blocks[i].last or earliest_end < blocks[i].first
            decisions.append(Decision("alias", "sharing_saves_nothing" if apart else "overlaps_in_time", name))
    return decisions
