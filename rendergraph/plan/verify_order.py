"""Is the order of a plan right, and was only the dead left out? Part of ``verify``; independent of the planner."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from rendergraph.plan.graph import Graph, Kind, TextureDesc
from rendergraph.plan.plan import Plan

Spot = tuple[str, int, int]  # a resource and one mip and layer that stands for all that are used alike


@dataclass(slots=True)
class _User:
    """What one pass does at one spot: its steps in program order as (position or -1, loads, writes)."""

    steps: list[tuple[int, bool, bool]]

    @property
    def writes(self) -> bool:
        return any(writes for _, _, writes in self.steps)

    @property
    def defines(self) -> bool:
        """Whether it begins afresh."""
        return self.writes and not self.steps[0][1]

    @property
    def borrows(self) -> bool:
        """Whether a step that runs needs content from another pass."""
        for position, loads, writes in self.steps:
            if loads and position >= 0:
                return True
            if writes:
                return False
        return False

    @property
    def leaves(self) -> bool:
        """Whether its last write runs."""
        return next((position >= 0 for position, _, writes in reversed(self.steps) if writes), True)


Users = dict[str, _User]


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
    spots = _use(plan.graph, position)
    reach = _Reach(plan.graph, spots)
    wanted = _wanted(plan.graph, spots)
    for spot, users in spots.items():
        faults += _check_within(spot, users)
        faults += _check_between(spot, users, reach)
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


def _use(graph: Graph, position: dict[str, int]) -> dict[Spot, Users]:
    """Who uses which spot."""
    mips: dict[str, set[int]] = defaultdict(set)
    layers: dict[str, set[int]] = defaultdict(set)
    steps = [(name, step) for name, found in graph.passes.items() for step in found.subpasses]
    for _, step in steps:
        for access in step.accesses:
            if access.mip is not None:
                mips[access.resource].add(access.mip)
            if access.layer is not None:
                layers[access.resource].add(access.layer)

    def choose(chosen: set[int], count: int) -> list[int]:
        rest = next((i for i in range(count) if i not in chosen), None)
        return sorted(chosen) if rest is None else [*sorted(chosen), rest]

    places: dict[str, list[tuple[int, int]]] = {}
    for name in {*mips, *layers}:
        desc = graph.resources[name].desc
        if isinstance(desc, TextureDesc):
            places[name] = [(m, a) for m in choose(mips[name], desc.mips) for a in choose(layers[name], desc.layers)]
    whole = [(0, 0)]
    spots: dict[Spot, Users] = defaultdict(dict)
    for owner, step in steps:
        at = position.get(step.name, -1)
        touched: dict[Spot, tuple[bool, bool]] = {}
        for access in step.accesses:
            name, writes = access.resource, access.usage.writes
            loads = access.load or not writes
            for mip, layer in places.get(name, whole):
                if (access.mip in (None, mip) and access.layer in (None, layer)) or name not in places:
                    spot = name, mip, layer
                    if spot in touched:
                        touched[spot] = touched[spot][0] or loads, touched[spot][1] or writes
                    else:
                        touched[spot] = loads, writes
        for spot, (loads, writes) in touched.items():
            users = spots[spot]
            if owner in users:
                users[owner].steps.append((at, loads, writes))
            else:
                users[owner] = _User([(at, loads, writes)])
    return spots


class _Reach:
    """Which pass is bound to run before which writer: by ``after``, by the one who defines, by what flows otherwise."""

    def __init__(self, graph: Graph, spots: dict[Spot, Users]) -> None:
        self._next: dict[str, set[str]] = {name: set() for name in graph.passes}
        contested: dict[Spot, list[str]] = {}
        for name, found in graph.passes.items():
            for other in found.after:
                if other in self._next:
                    self._next[other].add(name)
        for spot, users in spots.items():
            writers = [name for name, user in users.items() if user.writes]
            definers = [name for name in writers if users[name].defines]
            first = writers if len(writers) == 1 else definers
            if len(first) == 1:
                self._next[first[0]].update(name for name in users if name != first[0])
            if len(writers) > 1:
                contested[spot] = writers
        self._bit = {name: 1 << i for i, name in enumerate({n for names in contested.values() for n in names})}
        self._known: dict[str, int] = {}
        while contested:
            # A contest that is decided binds others: those who read between two writers, and the writers themselves.
            decided = {spot: chain for spot, writers in contested.items() if (chain := self._chain(writers))}
            if not decided:
                break
            edges = [edge for spot, chain in decided.items() for edge in self._thread(chain, spots[spot])]
            for before, after in edges:
                self._next[before].add(after)
            self._known.clear()
            contested = {spot: writers for spot, writers in contested.items() if spot not in decided}

    def _thread(self, chain: list[str], users: Users) -> Iterator[tuple[str, str]]:
        yield from pairwise(chain)
        for name in users:
            if not users[name].writes:
                place = next((i for i, writer in enumerate(chain) if self(name, writer)), len(chain))
                if place > 0:
                    yield chain[place - 1], name
                if place < len(chain):
                    yield name, chain[place]

    def _chain(self, writers: list[str]) -> list[str] | None:
        """The writers in their order, if every two of them have one."""
        if not self._known:
            self._explore()
        all_of_them = sum(self._bit[name] for name in writers)
        chain = sorted(writers, key=lambda name: -(self._known[name] & all_of_them).bit_count())
        return chain if all(self(a, b) for a, b in pairwise(chain)) else None

    def __call__(self, before: str, writer: str) -> bool:
        """Whether ``before`` is bound to run before ``writer``, a pass that shares a resource with other writers."""
        if not self._known:
            self._explore()
        return bool(self._known[before] & self._bit[writer])

    def _explore(self) -> None:
        for start in self._next:
            stack = [(start, False)]
            while stack:
                name, done = stack.pop()
                if done:
                    bits = 0
                    for later in self._next[name]:
                        bits |= self._known.get(later, 0) | self._bit.get(later, 0)
                    self._known[name] = bits
                elif name not in self._known:
                    self._known[name] = 0
                    stack.append((name, True))
                    stack += [(later, False) for later in self._next[name] if later not in self._known]


def _wanted(graph: Graph, spots: dict[Spot, Users]) -> set[str]:
    """Resources whose content outlives the frame: outputs, and what a history that is read was made from."""
    wanted = set(graph.outputs)
    for (name, _, _), users in spots.items():
        source = graph.resources[name].previous_of
        if source is not None and any(at >= 0 for user in users.values() for at, _, _ in user.steps):
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


def _check_between(spot: Spot, users: Users, reach: _Reach) -> Iterator[str]:
    """Writers do not interleave with anybody; who comes between two writers is bound to be there."""
    if len(users) == 1:
        return
    spans: list[tuple[int, int, str, bool]] = []
    for name, user in users.items():
        places = [at for at, _, _ in user.steps if at >= 0]
        if places:
            spans.append((min(places), max(places), name, user.writes))
    spans.sort()
    contested = sum(user.writes for user in users.values()) > 1
    previous: str | None = None  # the last writer
    waiting: list[str] = []  # readers since then
    writer_end = end = -1
    for low, high, name, writes in spans:
        if low <= (end if writes else writer_end):
            yield f"order: {name} touches {spot[0]} while another pass is writing it"
        if writes:
            for other in (*waiting, *([previous] if previous else ())):
                if not contested or not reach(other, name):
                    yield f"order: {other} touches {spot[0]} before {name} writes it, with no reason to"
            previous, waiting, writer_end = name, [], high
        else:
            if contested and previous is not None and reach(name, previous):
                yield f"order: {name} reads {spot[0]} after {previous}, but is bound to run before"
            waiting.append(name)
        end = max(end, high)


def _check_culled(spot: Spot, users: Users, reach: _Reach, wanted: bool) -> Iterator[str]:
    """Whoever runs finds the content of a writer that was left out replaced before it looks."""
    writers = [name for name, user in users.items() if user.writes]
    for gone in writers:
        if users[gone].leaves:
            continue
        fresh = [name for name in writers if name != gone and users[name].defines and reach(gone, name)]
        if wanted and not fresh:
            yield f"culled: the last word of {gone} on {spot[0]}, which outlives the frame"
        for name, user in users.items():
            if name == gone or not user.borrows or (len(writers) > 1 and reach(name, gone)):
                continue
            if all(reach(name, other) for other in fresh):
                yield f"culled: what {gone} writes to {spot[0]}, which {name} loads"


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
