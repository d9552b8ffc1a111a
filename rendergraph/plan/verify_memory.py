"""Is memory shared only by those who may? Part of ``verify``; independent of the planner."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from heapq import heappop, heappush

from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import BufferDesc, Kind, TextureDesc
from rendergraph.plan.plan import Plan

Span = tuple[int, int]


def check_memory(plan: Plan) -> list[str]:
    """Faults of lifetimes, slots, buffer ranges and totals."""
    spans: dict[str, Span] = {}
    for at, step in enumerate(plan.order):
        for access in step.accesses:
            spans[access.resource] = spans.get(access.resource, (at, at))[0], at
    for name in plan.graph.outputs:
        spans[name] = spans.get(name, (0, 0))[0], max(0, len(plan.order) - 1)
    faults = [
        f"memory: the lifetime of {name} is wrong"
        for name in {*spans, *plan.lifetimes}
        if name not in spans
        or name not in plan.lifetimes
        or spans[name] != (plan.lifetimes[name].first, plan.lifetimes[name].last)
    ]
    for check in (_check_homes, _check_slots, _check_heap, _check_sums):
        faults += check(plan, spans)
    return faults


def _check_homes(plan: Plan, spans: dict[str, Span]) -> Iterator[str]:
    """Each transient has one home, and nothing else has any."""
    for name in {*spans, *plan.slot_of, *plan.buffer_of}:
        resource = plan.graph.resources[name]
        pooled = resource.kind is Kind.TRANSIENT and name in spans
        texture = isinstance(resource.desc, TextureDesc)
        if (name in plan.slot_of) != (pooled and texture) or (name in plan.buffer_of) != (pooled and not texture):
            yield f"memory: {name} ({resource.kind.value}) has the wrong sort of home"
        if resource.previous_of in plan.slot_of or resource.previous_of in plan.buffer_of:
            yield f"memory: {resource.previous_of} is pooled, but {name} is its history"


def _check_slots(plan: Plan, spans: dict[str, Span]) -> Iterator[str]:
    housed = [name for slot in plan.slots for name in slot.tenants]
    if sorted(housed) != sorted(plan.slot_of):
        yield "memory: slots and slot_of disagree"
    for number, slot in enumerate(plan.slots):
        free_from = 0
        for name in slot.tenants:
            desc = plan.graph.resources[name].desc
            if plan.slot_of.get(name) != number or name not in spans or not isinstance(desc, TextureDesc):
                yield f"memory: {name} is no tenant of slot {number}"
                continue
            if not _viewable(slot.desc, desc):
                yield f"memory: {name} cannot be a view of slot {number}"
            if spans[name][0] < free_from:
                yield f"memory: {name} moves into slot {number} while another tenant is live"
            free_from = max(free_from, spans[name][1] + 1)


def _viewable(storage: TextureDesc, view: TextureDesc) -> bool:
    """Same shape, and the same format or colour texels of the same size in single-sample storage."""
    a, b = FORMATS[storage.format], FORMATS[view.format]
    shape = (storage.target, storage.width, storage.height, storage.layers, storage.mips, storage.samples)
    if shape != (view.target, view.width, view.height, view.layers, view.mips, view.samples):
        return False
    return a is b or (a.texel_bytes == b.texel_bytes and not a.depth and not b.depth and view.samples == 1)


def _check_heap(plan: Plan, spans: dict[str, Span]) -> Iterator[str]:
    live: list[tuple[int, int, str]] = []  # offset, end, name: by offset, and apart where no fault was found
    leaving: list[tuple[int, tuple[int, int, str]]] = []  # by last use
    for name in sorted(plan.buffer_of, key=lambda n: spans.get(n, (-1, -1))):
        place, desc = plan.buffer_of[name], plan.graph.resources[name].desc
        if name not in spans or not isinstance(desc, BufferDesc):
            yield f"memory: {name} is no buffer in use"
            continue
        start, end = place.offset, place.offset + place.bytes
        if start % 256 or start < 0 or end > plan.heap_bytes or place.bytes != desc.bytes:
            yield f"memory: {name} does not fit its place in the heap"
        while leaving and leaving[0][0] < spans[name][0]:
            del live[bisect_left(live, heappop(leaving)[1])]
        entry = start, end, name
        at = bisect_left(live, entry)
        for low, high, other in live[max(0, at - 1) : at + 1]:
            if low < end and start < high:
                yield f"memory: {name} and {other} overlap in the heap while both are live"
        live.insert(at, entry)
        heappush(leaving, (spans[name][1], entry))


def _check_sums(plan: Plan, spans: dict[str, Span]) -> Iterator[str]:
    events: list[tuple[int, int]] = []
    whole = 0
    for name, (first, last) in spans.items():
        resource = plan.graph.resources[name]
        if resource.kind is Kind.TRANSIENT:
            size = resource.desc.bytes
            if isinstance(resource.desc, BufferDesc):
                size += -size % 256
            whole += size
            events += [(first, size), (last + 1, -size)]
    live = peak = 0
    for _, change in sorted(events):  # at one position those who leave (negative) come first
        live += change
        peak = max(peak, live)
    totals = plan.totals
    real = sum(slot.desc.bytes for slot in plan.slots) + plan.heap_bytes
    if (totals.load, totals.unshared, totals.used) != (peak, whole, real):
        yield f"memory: sums are {totals.load}, {totals.unshared}, {totals.used}, not {peak}, {whole}, {real} (bytes)"
    if not totals.load <= totals.placed <= totals.view_pool <= totals.exact_pool <= totals.unshared:
        yield "memory: the five totals are not in order"
    if totals.used != (totals.view_pool if plan.options.alias else totals.unshared):
        yield "memory: the bytes used are those of another rule"
