"""Who uses what in a graph, and who is bound to run before whom. Part of ``verify``; independent of the planner."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

from rendergraph.plan.graph import Graph, TextureDesc

Spot = tuple[str, int, int]  # a resource and one mip and layer that stands for all that are used alike


@dataclass(slots=True)
class User:
    """What one pass does at one spot: its steps in program order as (position or -1, loads, writes).

    ``defines``: it writes, and begins afresh; ``replaces``: nothing from before is left when it is done.
    """

    steps: list[tuple[int, bool, bool]] = field(default_factory=list)
    writes: bool = False
    defines: bool = False
    replaces: bool = False

    def add(self, position: int, loads: bool, writes: bool) -> None:
        """The next step."""
        if writes and not loads:
            self.replaces = True
            self.defines = self.defines or not self.steps
        self.writes = self.writes or writes
        self.steps.append((position, loads, writes))

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


Users = dict[str, User]


def find_users(graph: Graph, position: dict[str, int]) -> dict[Spot, Users]:
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
            user = users.get(owner)
            if user is None:
                user = users[owner] = User()
            user.add(at, loads, writes)
    return spots


class Reach:
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
