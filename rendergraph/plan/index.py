"""The graph as integers, sorted by name: what the phases up to the order walk instead of names and enums.

Sub-passes are numbered by pass name, then program order; resources by name; so no later phase can depend on the order
of the file. A *cell* is the smallest part of a resource that some access tells apart: usually all of it, else a group
of mip levels and layers. Whoever touches disjoint cells is independent.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from rendergraph.plan.graph import BufferDesc, Graph, Kind, Pass, Resource, SubPass, TextureDesc

LOADS = 1  # content from before is needed
WRITES = 2  # content is changed

#: Kinds that hold content when the frame begins.
PRESET = frozenset({Kind.HISTORY, Kind.IMPORTED})


class Grid:
    """Splits a resource into the cells that a set of ``(mip, layer)`` choices tells apart; ``None`` is all.

    Levels and layers that nobody names on their own share one cell, so a chain of 12 mips touched whole is one cell.
    """

    def __init__(self, desc: TextureDesc | BufferDesc, chosen: Iterable[tuple[int | None, int | None]] = ()) -> None:
        mips = sorted({mip for mip, _ in chosen if mip is not None})
        layers = sorted({layer for _, layer in chosen if layer is not None})
        if isinstance(desc, BufferDesc):
            mips = layers = []
        else:
            mips = mips if desc.mips > 1 else []
            layers = layers if desc.layers > 1 else []
            self._rest_mip = len(mips) < desc.mips
            self._rest_layer = len(layers) < desc.layers
        self._mips = {mip: i for i, mip in enumerate(mips)}
        self._layers = {layer: i for i, layer in enumerate(layers)}
        self._columns = len(layers) + (not layers or self._rest_layer)
        self._rows = len(mips) + (not mips or self._rest_mip)
        self.count = self._rows * self._columns
        self._known: dict[tuple[int | None, int | None], tuple[int, ...]] = {}

    def cells(self, mip: int | None, layer: int | None) -> tuple[int, ...]:
        """The cells that an access to one or all mips and layers covers."""
        found = self._known.get((mip, layer))
        if found is None:
            row, column = self._mips.get(mip), self._layers.get(layer)  # type: ignore[arg-type]
            rows = range(self._rows) if row is None else (row,)
            columns = range(self._columns) if column is None else (column,)
            found = tuple(r * self._columns + c for r in rows for c in columns)
            self._known[mip, layer] = found
        return found


@dataclass(slots=True)
class Index:
    """Passes, sub-passes, resources and cells by number, and who touches which cell how."""

    graph: Graph
    passes: list[Pass] = field(default_factory=list)
    steps: list[range] = field(default_factory=list)  # pass -> its sub-passes
    subpasses: list[SubPass] = field(default_factory=list)
    pass_of: list[int] = field(default_factory=list)  # sub-pass -> pass
    resources: list[Resource] = field(default_factory=list)
    cells_of: dict[str, range] = field(default_factory=dict)  # resource name -> its cells
    resource_of: list[int] = field(default_factory=list)  # cell -> resource
    touches: list[list[tuple[int, int]]] = field(default_factory=list)  # cell -> (sub-pass, LOADS | WRITES), ascending


def index_graph(graph: Graph) -> Index:
    """Number a graph."""
    index = Index(graph)
    for number, name in enumerate(sorted(graph.passes)):
        found = graph.passes[name]
        start = len(index.subpasses)
        index.passes.append(found)
        index.subpasses.extend(found.subpasses)
        index.steps.append(range(start, len(index.subpasses)))
        index.pass_of.extend([number] * len(found.subpasses))
    grids = _number_cells(index)
    touches = index.touches
    for number, subpass in enumerate(index.subpasses):
        touched: dict[int, int] = {}
        for access in subpass.accesses:
            usage = access.usage
            flags = (WRITES | (access.load and LOADS)) if usage.writes else LOADS
            first = index.cells_of[access.resource].start
            grid = grids.get(access.resource)
            if grid is None:
                touched[first] = touched.get(first, 0) | flags
            else:
                for cell in grid.cells(access.mip, access.layer):
                    touched[first + cell] = touched.get(first + cell, 0) | flags
        for cell, flags in touched.items():
            touches[cell].append((number, flags))
    return index


def _number_cells(index: Index) -> dict[str, Grid]:
    """Give every resource its cells; the grids of those that have more than one."""
    chosen: dict[str, set[tuple[int | None, int | None]]] = {}
    for subpass in index.subpasses:
        for access in subpass.accesses:
            if access.mip is not None or access.layer is not None:
                chosen.setdefault(access.resource, set()).add((access.mip, access.layer))
    grids: dict[str, Grid] = {}
    start = 0
    for number, name in enumerate(sorted(index.graph.resources)):
        resource = index.graph.resources[name]
        index.resources.append(resource)
        count = 1
        if name in chosen:
            grid = Grid(resource.desc, chosen[name])
            count = grid.count
            if count > 1:
                grids[name] = grid
        index.cells_of[name] = range(start, start + count)
        index.resource_of.extend([number] * count)
        start += count
    index.touches = [[] for _ in range(start)]
    return grids
