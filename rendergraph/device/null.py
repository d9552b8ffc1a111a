"""A device without GL: says, call by call, what a plan would have a real one do. Used by tests alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    Kind,
    SubPass,
    TextureDesc,
    Usage,
)
from rendergraph.plan.plan import Barrier, Plan

_ATTACHED = {Usage.COLOR: "color", Usage.DEPTH: "depth", Usage.DEPTH_READ: "depth (read only)"}


class NullDevice:
    """Records instead of running; ``log`` keeps the lines of every ``execute``."""

    def __init__(self) -> None:
        self.log: list[str] = []

    def execute(self, plan: Plan) -> list[str]:
        """One frame of a plan, one line a command, in order: storage, then barriers, targets, bindings and work."""
        lines = list(_storage(plan))
        barriers = {barrier.index: barrier for barrier in plan.barriers}
        for index, subpass in enumerate(plan.order):
            if index in barriers:
                lines.append(_barrier(barriers[index]))
            lines += _subpass(plan, subpass)
        lines += [f"swap {r.previous_of} {r.name}" for r in plan.graph.resources.values() if r.kind is Kind.HISTORY]
        self.log += lines
        return lines


def _storage(plan: Plan) -> Iterator[str]:
    for index, slot in enumerate(plan.slots):
        yield f"allocate slot {index}: {_texture(slot.desc)}"
    if plan.heap_bytes:
        yield f"allocate heap: {plan.heap_bytes} bytes"
    for name in plan.lifetimes:
        desc = plan.graph.resources[name].desc
        if name in plan.slot_of:
            assert isinstance(desc, TextureDesc)
            yield f"view {name}: slot {plan.slot_of[name]} as {desc.format}"
        elif name in plan.buffer_of:
            place = plan.buffer_of[name]
            yield f"range {name}: heap {place.offset}+{place.bytes}"
        else:
            size = f"{desc.bytes} bytes" if isinstance(desc, BufferDesc) else _texture(desc)
            yield f"allocate {name}: {size}"


def _texture(desc: TextureDesc) -> str:
    samples = f" x{desc.samples}" if desc.samples > 1 else ""
    return f"{desc.format} {desc.target.value} {desc.width}x{desc.height}x{desc.layers} mips {desc.mips}{samples}"


def _barrier(barrier: Barrier) -> str:
    parts = [f"0x{barrier.bits:x}"] if barrier.bits else []
    if barrier.texture_barrier:
        parts.append("texture")
    return f"barrier {' + '.join(parts)}"


def _subpass(plan: Plan, subpass: SubPass) -> Iterator[str]:
    yield f"begin {subpass.name}"
    for access in subpass.accesses:
        if access.usage in _ATTACHED:
            start = f" clear {subpass.clears[access.resource]}" if access.resource in subpass.clears else ""
            yield f"attach {_ATTACHED[access.usage]} {_part(access)}{start}"
        elif access.name is not None:
            yield f"bind {access.name} = {access.usage.value} {_part(access)}"
    if subpass.program is not None:
        yield f"program {' '.join(path.name for _, path in subpass.program.stages)}"
    values = " ".join(str(getattr(subpass.work, field.name)) for field in fields(subpass.work))
    yield f"{type(subpass.work).__name__} {values}".rstrip()
    yield f"end {subpass.name}"


def _part(access: Access) -> str:
    mip = "" if access.mip is None else f" mip {access.mip}"
    layer = "" if access.layer is None else f" layer {access.layer}"
    return f"{access.resource}{mip}{layer}"
