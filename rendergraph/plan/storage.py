"""Who touches the same memory, in the order of the frame: the view of a plan that barriers are derived from.

Tenants of a slot, buffers whose ranges overlap in the heap, and a resource with its history all meet in one *storage*,
split into cells as far as accesses tell mips, layers or byte ranges apart.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rendergraph.plan.graph import Access, BufferDesc, CopyTexture, Graph, SubPass, Usage
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
    names it. ``feedback``: it samples what the same draw renders to.
    """

    position: int
    resource: str
    kind: str
    writes: bool
    loads: bool
    incoherent: bool
    attachment: bool
    feedback: bool


Home = tuple[str, str | int]  # ("slot", number), ("heap", 0) or ("own", resource)


@dataclass(slots=True)
class CellHistory:
    """The touches of one cell, ascending, one list a frame; after the last frame they begin again. More frames than
    one when the storage is swapped with its history: it is this frame's, then last frame's.
    """

    frames: list[list[Touch]]


def cell_histories(
    graph: Graph, order: Sequence[SubPass], slot_of: Mapping[str, int], buffer_of: Mapping[str, BufferRange]
) -> list[CellHistory]:
    """Histories of the cells that could need a barrier: a shader stores to them, or a draw samples what it renders."""
    hot, chosen_by_resource = _survey(order)
    if not hot:
        return []
    homes: dict[str, tuple[Home, int]] = {}
    frames: dict[Home, int] = {}
    for name in {*graph.outputs, *(access.resource for subpass in order for access in subpass.accesses)}:
        home, age = homes[name] = _home(graph, name, slot_of, buffer_of)
        frames[home] = max(frames.get(home, 1), age + 1)
    chosen: dict[Home, set[tuple[int | None, int | None]]] = {}
    for name, choices in chosen_by_resource.items():
        chosen.setdefault(homes[name][0], set()).update(choices)
    hot_homes = {homes[name][0] for name in hot}
    ranges = _split_heap(buffer_of)
    hot_ranges = {cell for name in hot if name in ranges for cell in ranges[name]}

    grids: dict[Home, Grid] = {}
    cells: dict[tuple[Home, int], CellHistory] = {}
    for position, subpass in enumerate(order):
        loops = feedback(subpass)
        for access in subpass.accesses:
            name = access.resource
            home, age = homes[name]
            if home not in hot_homes:
                continue
            touched: Iterable[int]
            if name in ranges:
                touched = [cell for cell in ranges[name] if cell in hot_ranges]
            else:
                grid = grids.get(home)
                if grid is None:
                    grid = grids[home] = Grid(graph.resources[name].desc, chosen.get(home, ()))
                touched = grid.cells(access.mip, access.layer)
            touch = _touch(graph, position, subpass, access, access in loops)
            for cell in touched:
                history = cells.get((home, cell))
                if history is None:
                    history = cells[home, cell] = CellHistory([[] for _ in range(frames[home])])
                history.frames[age].append(touch)
    return list(cells.values())


def feedback(subpass: SubPass) -> list[Access]:
    """The accesses by which a draw samples texels that it also renders to."""
    names = {a.resource for a in subpass.accesses}
    if len(names) == len(subpass.accesses):  # nothing is touched twice: the usual case
        return []
    targets = [a for a in subpass.accesses if a.usage is Usage.COLOR or a.usage is Usage.DEPTH]
    return [
        a
        for a in subpass.accesses
        if a.usage is Usage.SAMPLED
        and any(t.resource == a.resource and _meet(t.mip, a.mip) and _meet(t.layer, a.layer) for t in targets)
    ]


def _meet(a: int | None, b: int | None) -> bool:
    return a is None or b is None or a == b


def _survey(order: Sequence[SubPass]) -> tuple[set[str], dict[str, set[tuple[int | None, int | None]]]]:
    """Resources that shaders store to or draws feed back on, and the mips and layers named anywhere."""
    hot: set[str] = set()
    chosen: dict[str, set[tuple[int | None, int | None]]] = {}
    for subpass in order:
        for access in subpass.accesses:
            if access.usage.incoherent:
                hot.add(access.resource)
            if access.mip is not None or access.layer is not None:
                chosen.setdefault(access.resource, set()).add((access.mip, access.layer))
        hot.update(access.resource for access in feedback(subpass))
    return hot, chosen


def _home(
    graph: Graph, name: str, slot_of: Mapping[str, int], buffer_of: Mapping[str, BufferRange]
) -> tuple[Home, int]:
    """Where a resource lives, and how many frames ago its content was made."""
    if name in slot_of:
        return ("slot", slot_of[name]), 0
    if name in buffer_of:
        return ("heap", 0), 0
    age = 0
    while (source := graph.resources[name].previous_of) is not None:
        name, age = source, age + 1
    return ("own", name), age


def _split_heap(buffer_of: Mapping[str, BufferRange]) -> dict[str, range]:
    """Cut the heap at every start and end of a buffer: each buffer is then a run of whole pieces."""
    cuts = sorted({edge for b in buffer_of.values() for edge in (b.offset, b.offset + b.bytes)})
    return {
        name: range(bisect_left(cuts, b.offset), bisect_left(cuts, b.offset + b.bytes)) for name, b in buffer_of.items()
    }


def _touch(graph: Graph, position: int, subpass: SubPass, access: Access, loops: bool) -> Touch:
    usage = access.usage
    kind = _KIND.get(usage.value)
    if kind is None:  # copies, clears and reads by the host
        if isinstance(graph.resources[access.resource].desc, BufferDesc):
            kind = "buffer_update"
        else:  # a blit goes through framebuffers, a plain copy does not
            kind = "framebuffer" if isinstance(subpass.work, CopyTexture) and subpass.work.blit else "texture_update"
    attachment = usage is Usage.COLOR or usage is Usage.DEPTH
    loads = access.load or not usage.writes
    return Touch(position, access.resource, kind, usage.writes, loads, usage.incoherent, attachment, loops)
