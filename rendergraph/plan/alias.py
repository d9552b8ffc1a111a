"""Which resources share memory: textures take turns in slots, buffers are packed by offset in one heap.

A slot is immutable texture storage; a tenant of another format sees it through ``glTextureView``, which OpenGL allows
within a view class (4.5 core, table 8.22) and never for depth, stencil or (here) multisampled formats. Within a class,
left-edge colouring of the lifetimes uses as many slots as tenants are ever live at once: no fewer are possible.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rendergraph.document.formats import FORMATS
from rendergraph.plan.alias_reasons import explain_buffers, explain_never_pooled, explain_textures
from rendergraph.plan.graph import Decision, Graph, TextureDesc
from rendergraph.plan.lifetimes import find_load, storage_bytes, transients
from rendergraph.plan.packing import Block, pack
from rendergraph.plan.plan import BufferRange, Lifetime, MemoryTotals, TextureSlot


@dataclass(frozen=True, slots=True)
class Memory:
    """Where every transient resource lives, the sums, and why."""

    slots: tuple[TextureSlot, ...]
    slot_of: dict[str, int]
    buffer_of: dict[str, BufferRange]
    heap_bytes: int
    totals: MemoryTotals
    decisions: list[Decision]


def assign_memory(graph: Graph, lifetimes: Mapping[str, Lifetime], enabled: bool) -> Memory:
    """Place the transient resources. With ``enabled`` false each has memory of its own."""
    names = transients(graph, lifetimes)
    sizes = {name: storage_bytes(graph.resources[name]) for name in names}
    descs = {n: d for n in names if isinstance(d := graph.resources[n].desc, TextureDesc)}
    buffers = [n for n in names if n not in descs]
    decisions = explain_never_pooled(graph, lifetimes)

    classes = _group(descs, by_view_class=True)
    slots: list[TextureSlot] = []
    slot_of: dict[str, int] = {}
    view_bytes = 0  # of the slots, whether or not sharing is enabled
    for _, members in sorted(classes.items()):
        coloured = left_edge(members, lifetimes)
        view_bytes += descs[members[0]].bytes * len(coloured)
        groups = coloured if enabled else [[name] for name in members]
        for tenants in groups:
            slot_of |= dict.fromkeys(tenants, len(slots))
            slots.append(TextureSlot(_storage([descs[t] for t in tenants]), tuple(tenants)))
        if enabled:
            decisions += explain_textures(members, groups, len(slots) - len(groups), lifetimes)

    blocks = [Block(sizes[n], lifetimes[n].first, lifetimes[n].last) for n in buffers]
    packed, packed_bytes = pack(blocks, _load(blocks))
    offsets, heap = (packed, packed_bytes) if enabled else _one_after_another(blocks)
    buffer_of = {n: BufferRange(at, graph.resources[n].desc.bytes) for n, at in zip(buffers, offsets, strict=True)}
    if enabled:
        decisions += explain_buffers(buffers, blocks, offsets)
    else:
        decisions += [Decision("alias", "aliasing_off", name) for name in names]

    exact = packed_bytes + sum(
        descs[members[0]].bytes * len(left_edge(members, lifetimes))
        for members in _group(descs, by_view_class=False).values()
    )
    view = packed_bytes + view_bytes
    load, peak = find_load(lifetimes, sizes)
    placed = view  # the slots side by side are a placement too
    if view > load:
        every = [Block(sizes[n], lifetimes[n].first, lifetimes[n].last) for n in names]
        placed = min(pack(every, load)[1], view)
    used = sum(slot.desc.bytes for slot in slots) + heap
    return Memory(
        tuple(slots),
        slot_of,
        buffer_of,
        heap,
        MemoryTotals(sum(sizes.values()), exact, view, placed, load, used, peak),
        decisions,
    )


# ---------------------------------------------------------------- textures


def _group(descs: Mapping[str, TextureDesc], by_view_class: bool) -> dict[tuple[object, ...], list[str]]:
    """Textures that may share a slot, by what they must have in common."""
    classes: dict[tuple[object, ...], list[str]] = {}
    for name, desc in descs.items():
        exact = desc.samples > 1 or not by_view_class
        kind = f"={desc.format}" if exact else FORMATS[desc.format].view_class
        size = desc.width, desc.height, desc.layers, desc.mips, desc.samples
        classes.setdefault((desc.target.value, *size, kind), []).append(name)
    return classes


def left_edge(members: Sequence[str], lifetimes: Mapping[str, Lifetime]) -> list[list[str]]:
    """Intervals to tracks, by first use: the track free longest is taken first, a new one only when none is free."""
    tracks: list[list[str]] = []
    free: list[tuple[int, int]] = []  # (last use, track)
    for name in sorted(members, key=lambda n: (lifetimes[n].first, n)):
        if free and free[0][0] < lifetimes[name].first:
            track = heapq.heappop(free)[1]
            tracks[track].append(name)
        else:
            track = len(tracks)
            tracks.append([name])
        heapq.heappush(free, (lifetimes[name].last, track))
    return tracks


def _storage(tenants: Sequence[TextureDesc]) -> TextureDesc:
    """The slot's own description: the format most tenants have, so that few need a view."""
    count = Counter(desc.format for desc in tenants)
    return replace(tenants[0], format=min(count, key=lambda name: (-count[name], name)))


# ---------------------------------------------------------------- buffers


def _load(blocks: Sequence[Block]) -> int:
    change: Counter[int] = Counter()
    for block in blocks:
        change[block.first] += block.bytes
        change[block.last + 1] -= block.bytes
    now = load = 0
    for at in sorted(change):
        now += change[at]
        load = max(load, now)
    return load


def _one_after_another(blocks: Sequence[Block]) -> tuple[list[int], int]:
    offsets, end = [], 0
    for block in blocks:
        offsets.append(end)
        end += block.bytes
    return offsets, end
