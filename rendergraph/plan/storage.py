"""Who touches the same memory, in the order of the frame: the view of a plan that barriers are derived from.

Tenants of a slot, buffers whose ranges overlap in the heap, and a resource with its history all meet in one *storage*,
split into cells as far as accesses tell mips, layers or byte ranges apart.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rendergraph.plan.graph import BufferDesc, CopyTexture, Graph, SubPass, Usage
from rendergraph.plan.index import Grid
from rendergraph.plan.plan import BufferRange

_KIND = {
    Usage.SAMPLED.value: "texture_fetch",
    Usage.IMAGE_READ.value: "shader_image",
    Usage.IMAGE_WRITE.value: "shader_image",
    Usage.IMAGE_UPDATE.value: "shader_image",
    Usage.STORAGE_READ.value: "shader_storage",
    Usage.STORAGE_WRITE.value: "shader_storage",
    Usage.STORAGE_UPDATE.value: "shader_storage",
    Usage.UNIFORM.value: "uniform",
    Usage.INDIRECT.value: "command",
    Usage.VERTEX.value: "vertex_attrib",
    Usage.INDEX.value: "element_array",
    Usage.COLOR.value: "framebuffer",
    Usage.DEPTH.value: "framebuffer",
    Usage.DEPTH_READ.value: "framebuffer",
}


@dataclass(frozen=True, slots=True)
class Touch:
    """One access of a cell: when (``position`` in the order), of which resource, and what ``glMemoryBarrier`` kind
    names it. ``feedback``: it samples what the same draw renders to."""

    position: int
    resource: str
    kind: str
    writes: bool
    loads: bool
    incoherent: bool
    attachment: bool
    feedback: bool


@dataclass(slots=True)
class CellHistory:
    """The touches of one cell over ``frames`` frames, after which they repeat: one list a frame, ascending. More than
    one frame when the storage is swapped with its history."""

    frames: int
    touches: list[list[Touch]]


Cell = tuple[object, int]  # storage, cell within it


def cell_histories(
    graph: Graph, order: Sequence[SubPass], slot_of: Mapping[str, int], buffer_of: Mapping[str, BufferRange]
) -> Iterator[CellHistory]:
    """Histories of the cells that could need a barrier: stored to by a shader, or sampled while rendered to."""
    hot, narrowed = _survey(order)
    if not hot:
        return
    roots = {name: _root(graph, name) for name in graph.resources}
    frames: dict[str, int] = {}
    for root, age in roots.values():
        frames[root] = max(frames.get(root, 1), age + 1)
    ranges = _Ranges(buffer_of)

    def storage(name: str) -> object:
        return slot_of.get(name, roots[name][0])

    grids: dict[object, Grid] = {}
    chosen: dict[object, set[tuple[int | None, int | None]]] = {}
    for name, choices in narrowed.items():
        chosen.setdefault(storage(name), set()).update(choices)
    hot_storage = {storage(name) for name in hot}
    hot_ranges = {cell for name in hot if name in buffer_of for cell in ranges.cells(name)}
    cells: dict[Cell, CellHistory] = {}
    for position, subpass in enumerate(order):
        loops = feedback(subpass)
        for access in subpass.accesses:
            name = access.resource
            found: Iterable[int]
            if name in buffer_of:
                home: object = "heap"  # no resource is an int or in the heap without being in buffer_of
                found = [cell for cell in ranges.cells(name) if cell in hot_ranges]
            else:
                home = storage(name)
                if home not in hot_storage:
                    continue
                grid = grids.get(home)
                if grid is None:
                    grid = grids[home] = Grid(graph.resources[name].desc, chosen.get(home, ()))
                found = grid.cells(access.mip, access.layer)
            if not found:
                continue
            usage = access.usage
            touch = Touch(
                position,
                name,
                _kind(graph, subpass, name, usage),
                usage.writes,
                access.load or not usage.writes,
                usage.incoherent,
                usage is Usage.COLOR or usage is Usage.DEPTH,
                usage is Usage.SAMPLED and name in loops,
            )
            root, age = roots[name]
            for cell in found:
                key = (home, cell) if name in buffer_of else ((home, root), cell)
                history = cells.get(key)
                if history is None:
                    period = frames[root] if home == root else 1
                    history = cells[key] = CellHistory(period, [[] for _ in range(period)])
                history.touches[age].append(touch)
    yield from cells.values()
