"""Who is bound to run before whom. Part of ``verify``; independent of the planner."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise

from rendergraph.plan.graph import Graph
from rendergraph.plan.verify_users import Spot, Users


class Reach:
    """Which pass is bound to run before which writer: by ``after``, by the one who defines, by what flows otherwise.

    ``chains``: the writers of each spot that has several, in the order they are bound to; none where they are not.
    """

    def __init__(self, graph: Graph, spots: dict[Spot, Users]) -> None:
        self._next: dict[str, set[str]] = {name: set() for name in graph.passes}
        self.chains: dict[Spot, list[str]] = {}
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
        self._known: dict[str, int] = {}  # per pass, the writers after it as bits
        self._previous: dict[str, list[str]] = defaultdict(list)
        self._idle: set[str] = set()
        if contested:
            self._decide(spots, contested)

    def __call__(self, before: str, writer: str) -> bool:
        """Whether ``before`` is bound to run before ``writer``, a pass that shares a resource with other writers."""
        if not self._known:
            self._explore()
        return bool(self._known[before] & self._bit[writer])

    def place(self, reader: str, chain: list[str]) -> int:
        """How many of some ordered writers a reader is not bound to run before: those whose content it may see."""
        return bisect_left(chain, True, key=lambda writer: self(reader, writer))

    def _decide(self, spots: dict[Spot, Users], contested: dict[Spot, list[str]]) -> None:
        """Order the writers wherever they have one. A contest that is decided binds others: those who read between
        two writers, and the writers themselves. That may decide more, but only contests of writers who learn of it.
        """
        undecided: dict[str, set[Spot]] = defaultdict(set)  # by user
        for spot in contested:
            for name in spots[spot]:
                undecided[name].add(spot)
        due = set(contested)
        while due:
            decided = {spot: chain for spot in due if (chain := self._chain(contested[spot]))}
            edges = [edge for spot, chain in decided.items() for edge in self._thread(chain, spots[spot])]
            for before, after in edges:
                self._next[before].add(after)
            self.chains |= decided
            if len(self.chains) == len(contested):
                break
            for spot in decided:
                for name in spots[spot]:
                    undecided[name].discard(spot)
            learnt = self._tell(edges, undecided)
            due = {spot for name in learnt for spot in undecided[name] if spots[spot][name].writes}
        self._known.clear()  # all is known anew when asked: those whom no contest needed any more were not told

    def _tell(self, edges: list[tuple[str, str]], undecided: dict[str, set[Spot]]) -> set[str]:
        """Tell everybody before an edge who comes after it; who has learnt something.

        Nobody is told who takes part in no undecided contest and comes after none who does: what he knew decides
        nothing more.
        """
        if not self._previous:
            for name, after in self._next.items():
                for later in after:
                    self._previous[later].append(name)
        else:
            for before, after_ in edges:
                self._previous[after_].append(before)
        learnt: set[str] = set()
        waiting = edges.copy()
        while waiting:
            name, later = waiting.pop()
            known = self._known[name] | self._known[later] | self._bit.get(later, 0)
            if known == self._known[name]:
                continue
            self._known[name] = known
            learnt.add(name)
            for earlier in self._previous[name]:
                if earlier not in self._idle:
                    if not undecided.get(earlier) and self._idle.issuperset(self._previous[earlier]):
                        self._idle.add(earlier)
                    else:
                        waiting.append((earlier, name))
        return learnt

    def _thread(self, chain: list[str], users: Users) -> Iterator[tuple[str, str]]:
        """What an ordered contest binds: writer to writer, and readers to those they stand between."""
        yield from pairwise(chain)
        for name in users:
            if not users[name].writes:
                place = self.place(name, chain)
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

    def _explore(self) -> None:
        """Depth first from everybody."""
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
