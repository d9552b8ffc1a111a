"""In which order the sub-passes run: depth first from the outputs, or searched for memory, or random but legal."""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable

from rendergraph.plan.dependencies import Dependencies
from rendergraph.plan.graph import Decision
from rendergraph.plan.index import Index
from rendergraph.plan.lifetimes import LiveBytes
from rendergraph.plan.plan import PlanOptions


def order(
    index: Index, dependencies: Dependencies, live: list[bool], options: PlanOptions
) -> tuple[list[int], list[Decision]]:
    """The live sub-passes in the order ``options.order`` asks for; the same for any order of the file.

    ``ValueError`` for an unknown kind of order.
    """
    needs = [sorted({n for n in found if live[n]}) if live[s] else [] for s, found in enumerate(dependencies.needs)]
    default = _depth_first(index, dependencies, needs, live)
    if options.order == "default":
        return default, []
    if options.order == "random":
        found = _pick_ready(needs, default, _any(random.Random(options.seed)))
        return found, [Decision("order", "random_legal_order", "frame", {"seed": options.seed})]
    if options.order == "memory":
        return _search(index, needs, default, options)
    raise ValueError(f"no order '{options.order}': choose default, memory or random")


def _depth_first(index: Index, dependencies: Dependencies, needs: list[list[int]], live: list[bool]) -> list[int]:
    """Post-order from the outputs: producers stay close to consumers. The deepest dependency goes first, so that what
    is made in one step is made last; a pass's own steps follow on each other."""
    depth = [0] * len(needs)
    for s in dependencies.order:
        if needs[s]:
            depth[s] = 1 + max(depth[n] for n in needs[s])
    pass_of = index.pass_of
    final, cells_of = dependencies.final, index.cells_of
    roots = [final[cell] for name in sorted(index.graph.outputs) for cell in cells_of[name] if final[cell] >= 0]
    roots += [s for s in range(len(live)) if live[s]]
    seen = [not alive for alive in live]
    result: list[int] = []
    for root in roots:
        stack = [root]
        while stack:
            s = stack.pop()
            if s < 0:
                result.append(~s)
            elif not seen[s]:
                seen[s] = True
                stack.append(~s)
                waiting = [n for n in needs[s] if not seen[n]]
                if len(waiting) > 1:  # the last one pushed is visited first
                    own = pass_of[s]
                    waiting.sort(key=lambda n: (pass_of[n] != own, depth[n], -n))
                stack += waiting
    return result


Choose = Callable[[list[int]], int]


def _any(chance: random.Random) -> Choose:
    return lambda ready: chance.randrange(len(ready))


def _pick_ready(needs: list[list[int]], members: list[int], choose: Choose) -> list[int]:
    """A topological order of ``members``: ``choose`` picks the index of the next among those that are ready."""
    followers: dict[int, list[int]] = {s: [] for s in members}
    waiting = {s: len(needs[s]) for s in members}
    for s in members:
        for n in needs[s]:
            followers[n].append(s)
    ready = sorted(s for s in members if not waiting[s])
    result: list[int] = []
    while ready:
        at = choose(ready)
        ready[at], ready[-1] = ready[-1], ready[at]
        s = ready.pop()
        result.append(s)
        for later in followers[s]:
            waiting[later] -= 1
            if not waiting[later]:
                ready.append(later)
    return result
