"""A search for the order with the smallest peak of live bytes. Finding the best one is hard; the budget is stated."""

from __future__ import annotations

import random
from collections.abc import Callable

from rendergraph.plan.graph import Kind
from rendergraph.plan.index import Index
from rendergraph.plan.lifetimes import storage_bytes

_LOOK_AHEAD = 32  # ready sub-passes weighed against each other in one greedy step

Choose = Callable[[list[int]], int]
Cost = tuple[int, int]  # LOAD, and the sum of live bytes over time to tell equals apart


class MemorySearch:
    """The sub-passes to order, what each must wait for, and the transient bytes each touches."""

    def __init__(self, index: Index, needs: list[list[int]], members: list[int]) -> None:
        self._needs = needs
        self._members = members
        self._followers: list[list[int]] = [[] for _ in needs]
        for s in members:
            for n in needs[s]:
                self._followers[n].append(s)
        self._sizes: list[int] = []
        self._touched: list[list[int]] = [[] for _ in needs]
        self._to_end: set[int] = set()
        live = set(members)
        for resource in index.resources:
            if resource.kind is Kind.TRANSIENT:
                users = {s for cell in index.cells_of[resource.name] for s, _ in index.touches[cell]} & live
                for s in users:
                    self._touched[s].append(len(self._sizes))
                if resource.name in index.graph.outputs:
                    self._to_end.add(len(self._sizes))
                self._sizes.append(storage_bytes(resource))
        self._users = [0] * len(self._sizes)
        for s in members:
            for r in self._touched[s]:
                self._users[r] += 1

    def cost(self, order: list[int]) -> Cost:
        """LOAD and the sum of live bytes of an order."""
        left = self._users.copy()
        seen = bytearray(len(left))
        now = load = total = 0
        for s in order:
            for r in self._touched[s]:
                if not seen[r]:
                    seen[r] = 1
                    now += self._sizes[r]
            if now > load:
                load = now
            total += now
            for r in self._touched[s]:
                left[r] -= 1
                if not left[r] and r not in self._to_end:
                    now -= self._sizes[r]
        return load, total

    def run(self, start: list[int], budget: int, seed: int) -> tuple[list[int], int]:
        """The best order found in ``budget`` trials, never worse than ``start``; and the number of trials spent.

        A quarter of the trials are greedy schedules with a growing share of chance; the rest move single sub-passes
        within the limits of their dependencies and keep what is no worse.
        """
        chance = random.Random(seed)
        best, best_cost = start, self.cost(start)
        for trial in range(budget):
            if trial < max(1, budget // 4):
                candidate = self._greedy(chance, trial / budget)
            else:
                candidate = self._move(best, chance)
            cost = self.cost(candidate)
            if cost <= best_cost:
                best, best_cost = candidate, cost
        return best, budget

    def _greedy(self, chance: random.Random, noise: float) -> list[int]:
        """Always run what frees most and allocates least, or now and then anything that is ready."""
        left = self._users.copy()
        seen = bytearray(len(left))

        def growth(s: int) -> int:
            bytes_ = 0
            for r in self._touched[s]:
                if not seen[r]:
                    bytes_ += self._sizes[r]
                if left[r] == 1 and r not in self._to_end:
                    bytes_ -= self._sizes[r]
            return bytes_

        def choose(ready: list[int]) -> int:
            start = max(0, len(ready) - _LOOK_AHEAD)
            if chance.random() < noise:
                at = chance.randrange(start, len(ready))
            else:
                at = min(range(start, len(ready)), key=lambda i: (growth(ready[i]), -i))
            for r in self._touched[ready[at]]:
                seen[r] = 1
                left[r] -= 1
            return at

        return pick_ready(self._needs, self._members, choose)

    def _move(self, order: list[int], chance: random.Random) -> list[int]:
        """One sub-pass moved to another legal place."""
        if len(order) < 2:
            return order
        at = chance.randrange(len(order))
        s = order[at]
        low = high = at
        while low > 0 and order[low - 1] not in self._needs[s]:
            low -= 1
        while high < len(order) - 1 and order[high + 1] not in self._followers[s]:
            high += 1
        moved = order[:at] + order[at + 1 :]
        moved.insert(chance.randint(low, high), s)
        return moved


def pick_ready(needs: list[list[int]], members: list[int], choose: Choose) -> list[int]:
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
        s = ready[at]
        ready[at] = ready[-1]
        ready.pop()
        result.append(s)
        for later in followers[s]:
            waiting[later] -= 1
            if not waiting[later]:
                ready.append(later)
    return result
