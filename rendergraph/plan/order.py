"""In which order the sub-passes run: depth first from the outputs, or searched for memory, or random but legal."""

from __future__ import annotations

import random

from rendergraph.plan.dependencies import Flow, find_needs
from rendergraph.plan.graph import Decision
from rendergraph.plan.index import Index
from rendergraph.plan.memory_order import MemorySearch, pick_ready
from rendergraph.plan.plan import PlanOptions


def order(index: Index, flow: Flow, live: list[bool], options: PlanOptions) -> tuple[list[int], list[Decision]]:
    """The live sub-passes in the order ``options.order`` asks for; the same for any order of the file.

    ``ValueError`` for an unknown kind of order, and for a list that is no legal order of what runs.
    """
    needs = [sorted(set(found)) for found in find_needs(index, flow, live)]
    default = _depth_first(index, flow, needs, live)
    if options.order == "default":
        return default, [Decision("order", "depth_first_from_outputs", "frame")]
    if options.order == "random":
        chance = random.Random(options.seed)
        found = pick_ready(needs, default, lambda ready: chance.randrange(len(ready)))
        return found, [Decision("order", "random_legal_order", "frame", {"seed": options.seed})]
    if options.order == "memory":
        search = MemorySearch(index, needs, default)
        found, trials = search.run(default, options.order_budget, options.seed)
        before, after = search.cost(default)[0], search.cost(found)[0]
        reason = "memory_search_improved" if after < before else "memory_search_found_no_better"
        return found, [Decision("order", reason, "frame", {"trials": trials, "load_before": before, "load": after})]
    if options.order == "listed":
        return _listed(index, needs, live, options.sequence), [Decision("order", "as_listed", "frame")]
    raise ValueError(f"no order '{options.order}': choose default, memory, random or listed")


def _depth_first(index: Index, flow: Flow, needs: list[list[int]], live: list[bool]) -> list[int]:
    """Post-order from the outputs: producers stay close to consumers. The deepest dependency goes first, so that what
    is made in one step is made last; a pass's own steps follow on each other.
    """
    depth = [0] * len(needs)
    for s in flow.order:
        if needs[s]:
            depth[s] = 1 + max(depth[n] for n in needs[s])
    pass_of = index.pass_of
    final, cells_of = flow.final, index.cells_of
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


def _listed(index: Index, needs: list[list[int]], live: list[bool], sequence: tuple[str, ...]) -> list[int]:
    """Sub-passes by name, each after all it needs."""
    number = {subpass.name: i for i, subpass in enumerate(index.subpasses) if live[i]}
    if sorted(number) != sorted(sequence):
        raise ValueError("the list does not name each sub-pass that runs once")
    found = [number[name] for name in sequence]
    place = {s: at for at, s in enumerate(found)}
    for s in found:
        for earlier in needs[s]:
            if place[earlier] > place[s]:
                raise ValueError(f"{index.subpasses[s].name} is listed before {index.subpasses[earlier].name}")
    return found
