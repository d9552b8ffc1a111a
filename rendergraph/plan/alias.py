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
from rendergraph.plan.graph import BufferDesc, Decision, Graph, Kind, Resource, TextureDesc
from rendergraph.plan.lifetimes import find_load, storage_bytes, transients
from rendergraph.plan.packing import Block, pack
from rendergraph.plan.plan import BufferRange, Lifetime, MemoryTotals, TextureSlot

_SHOWN = 8  # names listed as evidence


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
    textures = [n for n in names if isinstance(graph.resources[n].desc, TextureDesc)]
    buffers = [n for n in names if isinstance(graph.resources[n].desc, BufferDesc)]
    decisions = _never_pooled(graph, lifetimes)

    classes = _group(graph, textures, by_view_class=True)
    slots: list[TextureSlot] = []
    slot_of: dict[str, int] = {}
    for _, members in sorted(classes.items()):
        groups = left_edge(members, lifetimes) if enabled else [[name] for name in members]
        for tenants in groups:
            slot_of |= dict.fromkeys(tenants, len(slots))
            slots.append(TextureSlot(_storage([_texture(graph, t) for t in tenants]), tuple(tenants)))
        if enabled:
            decisions += _explain_textures(members, groups, len(slots) - len(groups), lifetimes)

    blocks = [Block(storage_bytes(graph.resources[n]), lifetimes[n].first, lifetimes[n].last) for n in buffers]
    if enabled:
        offsets, heap = pack(blocks, _load(blocks))
    else:
        offsets, heap = _one_after_another(blocks)
    buffer_of = {n: BufferRange(at, graph.resources[n].desc.bytes) for n, at in zip(buffers, offsets, strict=True)}
    if enabled:
        decisions += _explain_buffers(buffers, blocks, offsets)
    else:
        decisions += [Decision("alias", "aliasing_off", name) for name in names]

    unshared = sum(storage_bytes(graph.resources[n]) for n in names)
    pooled = heap if enabled else pack(blocks, _load(blocks))[1]
    exact = pooled + _colour_bytes(graph, _group(graph, textures, by_view_class=False), lifetimes)
    view = pooled + _colour_bytes(graph, classes, lifetimes)
    load, peak = find_load(graph, lifetimes)
    every = [Block(storage_bytes(graph.resources[n]), lifetimes[n].first, lifetimes[n].last) for n in names]
    placed = min(pack(every, load)[1], view)  # the slots side by side are a placement too
    used = sum(slot.desc.bytes for slot in slots) + heap
    return Memory(
        tuple(slots),
        slot_of,
        buffer_of,
        heap,
        MemoryTotals(unshared, exact, view, placed, load, used, peak),
        decisions,
    )


# ---------------------------------------------------------------- textures


def _texture(graph: Graph, name: str) -> TextureDesc:
    desc = graph.resources[name].desc
    assert isinstance(desc, TextureDesc)
    return desc


def _group(graph: Graph, textures: Sequence[str], by_view_class: bool) -> dict[tuple[object, ...], list[str]]:
    """Textures that may share a slot, by what they must have in common."""
    classes: dict[tuple[object, ...], list[str]] = {}
    for name in textures:
        desc = _texture(graph, name)
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


def _colour_bytes(
    graph: Graph, classes: Mapping[tuple[object, ...], list[str]], lifetimes: Mapping[str, Lifetime]
) -> int:
    return sum(_texture(graph, m[0]).bytes * len(left_edge(m, lifetimes)) for m in classes.values())


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


# ---------------------------------------------------------------- reasons


def _never_pooled(graph: Graph, lifetimes: Mapping[str, Lifetime]) -> list[Decision]:
    found = [graph.resources[name] for name in lifetimes if graph.resources[name].kind is not Kind.TRANSIENT]
    return [Decision("alias", f"never_pooled_{r.kind.value}", r.name, _history_evidence(r)) for r in found]


def _history_evidence(resource: Resource) -> dict[str, str]:
    return {"previous_of": resource.previous_of} if resource.previous_of else {}


def _explain_textures(
    members: Sequence[str], groups: Sequence[Sequence[str]], base: int, lifetimes: Mapping[str, Lifetime]
) -> list[Decision]:
    decisions: list[Decision] = []
    for number, tenants in enumerate(groups):
        for name in tenants:
            if len(tenants) > 1:
                others = [t for t in tenants[: _SHOWN + 1] if t != name]
                evidence = {"slot": base + number, "with": others[:_SHOWN]}
                decisions.append(Decision("alias", "shares_slot", name, evidence))
            elif len(members) == 1:
                decisions.append(Decision("alias", "only_one_in_class", name))
            else:
                with_ = _overlapping(name, members, lifetimes)
                decisions.append(Decision("alias", "overlaps_in_time", name, {"with": with_}))
    return decisions


def _overlapping(name: str, members: Sequence[str], lifetimes: Mapping[str, Lifetime]) -> list[str]:
    life = lifetimes[name]
    found: list[str] = []
    for other in members:
        if other != name and lifetimes[other].first <= life.last and life.first <= lifetimes[other].last:
            found.append(other)
            if len(found) == _SHOWN:
                break
    return found


def _explain_buffers(names: Sequence[str], blocks: Sequence[Block], offsets: Sequence[int]) -> list[Decision]:
    """Buffers whose bytes are used again by another share the heap; the rest are alone, and why."""
    decisions: list[Decision] = []
    by_offset = sorted(range(len(names)), key=offsets.__getitem__)
    sharing: dict[int, list[str]] = {i: [] for i in by_offset}
    active: list[tuple[int, int]] = []  # (end, buffer)
    for i in by_offset:
        while active and active[0][0] <= offsets[i]:
            heapq.heappop(active)
        for _, a in active[:_SHOWN]:  # some of those below whose bytes reach up here
            sharing[a].append(names[i])
            sharing[i].append(names[a])
        heapq.heappush(active, (offsets[i] + blocks[i].bytes, i))
    for i, name in enumerate(names):
        if sharing[i]:
            decisions.append(Decision("alias", "shares_heap_range", name, {"with": sorted(sharing[i])[:_SHOWN]}))
        elif len(names) == 1:
            decisions.append(Decision("alias", "only_one_in_class", name))
        else:
            apart = any(b.first > blocks[i].last or b.last < blocks[i].first for b in blocks)
            decisions.append(Decision("alias", "sharing_saves_nothing" if apart else "overlaps_in_time", name))
    return decisions
