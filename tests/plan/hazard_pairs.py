"""All pairs of accesses that a barrier must stand between, by looking at every pair: slow, and hard to get wrong."""

from __future__ import annotations

from dataclasses import dataclass

from rendergraph.plan.graph import Access, BufferDesc, SubPass, Usage
from rendergraph.plan.plan import Plan

TEXTURE_BARRIER = "texture_barrier"

#: GL 4.5 core, 7.13.2: the bit that names each usage of a texture or buffer *after* the barrier.
BITS = {
    Usage.VERTEX: 0x1, Usage.INDEX: 0x2, Usage.UNIFORM: 0x4, Usage.SAMPLED: 0x8, Usage.IMAGE_READ: 0x20,
    Usage.IMAGE_WRITE: 0x20, Usage.IMAGE_UPDATE: 0x20, Usage.INDIRECT: 0x40, Usage.COLOR: 0x400, Usage.DEPTH: 0x400,
    Usage.DEPTH_READ: 0x400, Usage.STORAGE_READ: 0x2000, Usage.STORAGE_WRITE: 0x2000, Usage.STORAGE_UPDATE: 0x2000,
}  # fmt: skip


@dataclass(frozen=True)
class Event:
    """One access in an unrolled run: its sub-pass's number in time, the atoms of storage it covers, and itself."""

    time: int
    atoms: frozenset[tuple[object, ...]]
    step: SubPass
    access: Access


def unroll(plan: Plan, frames: int) -> list[Event]:
    """The accesses of several frames, history swapped between them."""
    live = {a.resource for s in plan.order for a in s.accesses}
    swapped = {r.previous_of for r in plan.graph.resources.values() if r.previous_of and r.name in live}
    events: list[Event] = []
    for frame in range(frames):
        for at, step in enumerate(plan.order):
            for access in step.accesses:
                atoms = frozenset(_atoms(plan, access, frame, swapped))
                events.append(Event(frame * len(plan.order) + at, atoms, step, access))
    return events


def _atoms(plan: Plan, access: Access, frame: int, swapped: set[str | None]) -> list[tuple[object, ...]]:
    resource = plan.graph.resources[access.resource]
    name, copy = access.resource, 0
    if resource.previous_of is not None:
        name, copy = resource.previous_of, (frame + 1) % 2
    elif name in swapped:
        copy = frame % 2
    if isinstance(resource.desc, BufferDesc):
        place = plan.buffer_of.get(access.resource)
        home: tuple[object, ...] = ("heap",) if place else (name, copy)
        start = place.offset if place else 0
        return [(*home, start + i) for i in range(0, resource.desc.bytes, 64)]
    home = ("slot", plan.slot_of[name]) if name in plan.slot_of else (name, copy)
    mips = range(resource.desc.mips) if access.mip is None else (access.mip,)
    layers = range(resource.desc.layers) if access.layer is None else (access.layer,)
    return [(*home, mip, layer) for mip in mips for layer in layers]


def bit_of(plan: Plan, access: Access) -> int:
    """The barrier bit of an access."""
    buffer = isinstance(plan.graph.resources[access.resource].desc, BufferDesc)
    return BITS.get(access.usage, 0x200 if buffer else 0x100)


def hazards(plan: Plan, frames: int = 3) -> set[tuple[int, int, int | str]]:
    """``(earlier, later, bit)`` in unrolled time: a barrier of that bit must be issued after the one, before the other.

    Content that a coherent access replaced whole in between no longer counts as stored.
    """
    events = unroll(plan, frames)
    found: set[tuple[int, int, int | str]] = set()
    for i, later in enumerate(events):
        for earlier in events[:i]:
            shared = earlier.atoms & later.atoms
            if earlier.time == later.time or not shared:
                continue
            if earlier.access.usage.incoherent:
                left = shared - _replaced(events, earlier.time, later.time)
                if left:
                    found.add((earlier.time, later.time, bit_of(plan, later.access)))
            if later.access.usage.incoherent:
                found.add((earlier.time, later.time, bit_of(plan, later.access)))
            if earlier.access.usage in (Usage.COLOR, Usage.DEPTH) and _feeds_back(events, later, shared):
                found.add((earlier.time, later.time, TEXTURE_BARRIER))
    return found


def _replaced(events: list[Event], after: int, before: int) -> set[tuple[object, ...]]:
    gone: set[tuple[object, ...]] = set()
    for event in events:
        access = event.access
        if after < event.time < before and access.usage.writes and not access.usage.incoherent and not access.load:
            beside = [other for other in events if other.time == event.time and other is not event]
            loaded = {
                atom for other in beside if other.access.load or other.access.usage.incoherent for atom in other.atoms
            }
            gone |= event.atoms - loaded
    return gone


def _feeds_back(events: list[Event], later: Event, shared: frozenset[tuple[object, ...]]) -> bool:
    if later.access.usage is not Usage.SAMPLED:
        return False
    beside = [e for e in events if e.time == later.time and e.access.usage in (Usage.COLOR, Usage.DEPTH)]
    return any(e.access.resource == later.access.resource and e.atoms & later.atoms for e in beside)


def uncovered(plan: Plan, found: set[tuple[int, int, int | str]]) -> list[tuple[int, int, int | str]]:
    """The hazards with no barrier of their bit in between."""
    length = len(plan.order)
    calls: dict[int, set[int | str]] = {}
    for barrier in plan.barriers:
        bits: set[int | str] = {1 << k for k in range(16) if barrier.bits >> k & 1}
        calls[barrier.index] = bits | ({TEXTURE_BARRIER} if barrier.texture_barrier else set())
    return [
        (earlier, later, bit)
        for earlier, later, bit in found
        if not any(bit in calls.get(time % length, ()) for time in range(earlier + 1, later + 1))
    ]
