"""Who uses what in a graph. Part of ``verify``; independent of the planner."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

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
