"""Is the order of a plan right, and was only the dead left out? Part of ``verify``; independent of the planner."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from itertools import pairwise

from rendergraph.plan.graph import Graph, Kind
from rendergraph.plan.plan import Plan
from rendergraph.plan.verify_reach import Reach
from rendergraph.plan.verify_users import Spot, Users, find_users


def check_order(plan: Plan) -> list[str]:
    """Faults of ``plan.order`` and ``plan.culled``."""
    position = {step.name: at for at, step in enumerate(plan.order)}
    known = {step.name: step for found in plan.graph.passes.values() for step in found.subpasses}
    strangers = [step.name for step in plan.order if known.get(step.name) is not step]
    faults = [f"order: {name} is not of the graph" for name in strangers]
    if len(position) != len(plan.order):
        faults.append("order: a sub-pass runs twice")
    gone = set(plan.culled)
    faults += [f"order: {name} neither runs nor is culled" for name in known if (name in position) == (name in gone)]
    if faults:
        return faults
    faults += [*_check_after(plan.graph, position), *_check_defined(plan)]
    spots = find_users(plan.graph, position)
    reach = Reach(plan.graph, spots)
    wanted = _wanted(plan.graph, spots)
    for spot, users in spots.items():
        faults += _check_within(spot, users)
        if len(users) > 1:
            faults += _check_between(spot, users, reach)
        if gone:
            faults += _check_culled(spot, users, reach, spot[0] in wanted)
    kept = (step.name for found in plan.graph.passes.values() if found.keep for step in found.subpasses)
    return faults + [f"culled: {name} is to be kept" for name in kept if name in gone]


def _check_after(graph: Graph, position: dict[str, int]) -> Iterator[str]:
    span = {}
    for name, found in graph.passes.items():
        places = [position[step.name] for step in found.subpasses if step.name in position]
        if places:
            span[name] = min(places), max(places)
    for name, found in graph.passes.items():
        for other in found.after:
            if name in span and other in span and span[name][0] < span[other][1]:
                yield f"order: {name} does not wait for {other}"


def _wanted(graph: Graph, spots: dict[Spot, Users]) -> set[str]:
    """Resources whose content outlives the frame: outputs, and what a history that is read was made from."""
    wanted = set(graph.outputs)
    for (name, _, _), users in spots.items():
        if graph.resources[name].previous_of and any(at >= 0 for user in users.values() for at, _, _ in user.steps):
            wanted.add(name)
    for name in tuple(wanted):
        source = graph.resources[name].previous_of
        while source is not None:
            wanted.add(source)
            source = graph.resources[source].previous_of
    return wanted


def _check_within(spot: Spot, users: Users) -> Iterator[str]:
    """The steps of one pass keep their program order wherever one of two writes, and miss no content of their own."""
    for name, user in users.items():
        if len(user.steps) == 1:
            continue
        wrote, used, missing = -1, -1, False
        for at, loads, writes in user.steps:
            if at < 0:
                missing = missing or writes
                continue
            if loads and missing:
                yield f"culled: a step of {name} whose {spot[0]} another one of its steps loads"
            if at < (used if writes else wrote):
                yield f"order: the steps of {name} touch {spot[0]} out of order"
            used = max(used, at)
            if writes:
                wrote, missing = at, False


def _check_between(spot: Spot, users: Users, reach: Reach) -> Iterator[str]:
    """Writers follow on each other, nobody looks on while one is writing, and who comes before a writer is bound to."""
    writers: list[tuple[int, int, int, int, str]] = []  # first and last write, first and last touch, name
    readers: list[tuple[int, int, str]] = []
    contested = 0
    for name, user in users.items():
        contested += user.writes
        touched = [at for at, _, _ in user.steps if at >= 0]
        wrote = [at for at, _, writes in user.steps if writes and at >= 0] if user.writes else []
        if wrote:
            writers.append((min(wrote), max(wrote), min(touched), max(touched), name))
        elif touched:
            readers.append((min(touched), max(touched), name))
    if not writers:
        return
    if contested == 1:
        done = writers[0][1]
        for first, _, name in readers:
            if first <= done:
                yield f"order: {name} reads {spot[0]} before {writers[0][4]} has written it"
        return
    writers.sort()
    for (_, wrote_last, _, last, name), (wrote_first, _, first, _, other) in pairwise(writers):
        if first < wrote_last or wrote_first < last:
            yield f"order: {other} touches {spot[0]} before {name} is done with it"
        if not reach(name, other):
            yield f"order: {name} writes {spot[0]} before {other}, with no reason to"
    for first, last, name in readers:
        at = bisect_right(writers, (last,))
        if at and writers[at - 1][1] > first:
            yield f"order: {name} touches {spot[0]} while {writers[at - 1][4]} is writing it"
        if at and reach(name, writers[at - 1][4]):
            yield f"order: {name} reads {spot[0]} after {writers[at - 1][4]}, but is bound to run before"
        if at < len(writers) and not reach(name, writers[at][4]):
            yield f"order: {name} reads {spot[0]} before {writers[at][4]} writes it, with no reason to"


def _check_culled(spot: Spot, users: Users, reach: Reach, wanted: bool) -> Iterator[str]:
    """Whoever runs finds the content of a writer that was left out replaced before it looks."""
    writers = [name for name, user in users.items() if user.writes]
    gone = [name for name in writers if not users[name].leaves]
    if not gone:
        return
    if len(writers) > 1 and spot not in reach.chains:
        yield f"culled: {gone[0]}, though nothing orders the writers of {spot[0]}"
        return
    chain = reach.chains.get(spot, writers)
    place = {name: at for at, name in enumerate(chain)}  # who borrows at a place sees what was left before it
    borrowers = sorted(
        (place[name] if user.writes else reach.place(name, chain) if len(chain) > 1 else 1, name)
        for name, user in users.items()
        if user.borrows
    )
    replaced = [at for at, name in enumerate(chain) if users[name].replaces]
    for name in gone:
        next_one = bisect_right(replaced, place[name])
        end = replaced[next_one] if next_one < len(replaced) else len(chain)
        if wanted and end == len(chain):
            yield f"culled: the last word of {name} on {spot[0]}, which outlives the frame"
        for at in range(bisect_left(borrowers, (place[name] + 1,)), bisect_left(borrowers, (end + 1,))):
            yield f"culled: what {name} writes to {spot[0]}, which {borrowers[at][1]} loads"


def _check_defined(plan: Plan) -> Iterator[str]:
    """Nothing is loaded before anything of it was written."""
    written: set[str] = set()
    for step in plan.order:
        for access in step.accesses:
            if access.load and access.resource not in written:
                kind = plan.graph.resources[access.resource].kind
                if kind is not Kind.HISTORY and kind is not Kind.IMPORTED:
                    yield f"order: {step.name} loads {access.resource}, which holds nothing yet"
        written.update(access.resource for access in step.accesses if access.usage.writes)
