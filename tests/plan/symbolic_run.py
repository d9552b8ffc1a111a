"""Runs a plan on symbols: what every access would see, through the storage the plan assigns, frame after frame.

Content is a hash of who wrote it from what. A stale slot, a wrong order or a culled producer changes the result, as a
wrong pixel would; so two plans of one graph agree exactly when they would draw the same image.
"""

from __future__ import annotations

from collections.abc import Sequence

from rendergraph.plan.graph import Access, BufferDesc, Graph, SubPass
from rendergraph.plan.plan import Plan

GRAIN = 64  # bytes of a buffer told apart

Cell = tuple[object, ...]


def run_plan(plan: Plan, frames: int = 3) -> dict[str, int]:
    """Content of the outputs after each frame, hashed together."""
    return _run(plan.graph, plan.order, plan, frames)


def run_in_file_order(graph: Graph, frames: int = 3) -> dict[str, int]:
    """The same with every sub-pass in the order of ``graph.passes`` and no sharing: needs no planner."""
    return _run(graph, [s for p in graph.passes.values() for s in p.subpasses], None, frames)


def _run(graph: Graph, order: Sequence[SubPass], plan: Plan | None, frames: int) -> dict[str, int]:
    memory: dict[Cell, int] = {}
    result = dict.fromkeys(graph.outputs, 0)
    for frame in range(frames):
        for step in order:
            loaded = [
                memory.get(cell, 0)
                for access in step.accesses
                if access.load or not access.usage.writes
                for cell in _cells(graph, plan, access, frame)
            ]
            seen = hash((step.name, tuple(loaded)))
            for access in step.accesses:
                if access.usage.writes:
                    for cell in _cells(graph, plan, access, frame):
                        kept = memory.get(cell, 0) if access.load else 0
                        memory[cell] = hash((seen, access.usage.value, cell[-1], kept))
        for name in graph.outputs:
            whole = Access(name, graph.passes[next(iter(graph.passes))].subpasses[0].accesses[0].usage)
            content = tuple(memory.get(cell, 0) for cell in _cells(graph, plan, whole, frame))
            result[name] = hash((result[name], content))
    return result


def _cells(graph: Graph, plan: Plan | None, access: Access, frame: int) -> list[Cell]:
    """The pieces of storage an access covers; the last item of each is its place within the resource."""
    name, desc = access.resource, graph.resources[access.resource].desc
    if isinstance(desc, BufferDesc):
        pieces: list[object] = list(range(desc.bytes // GRAIN))
    else:
        mips = range(desc.mips) if access.mip is None else (access.mip,)
        layers = range(desc.layers) if access.layer is None else (access.layer,)
        pieces = [(mip, layer) for mip in mips for layer in layers]
    if plan is not None and name in plan.slot_of:
        return [("slot", plan.slot_of[name], piece, piece) for piece in pieces]
    if plan is not None and name in plan.buffer_of:
        start = plan.buffer_of[name].offset // GRAIN
        return [("heap", start + int(str(piece)), piece) for piece in pieces]
    age, longest = 0, 1
    sources = {r.previous_of for r in graph.resources.values()}
    while (source := graph.resources[name].previous_of) is not None:
        name, age = source, age + 1
    if name in sources:
        longest = 2
    return [("own", name, (frame - age) % longest, piece) for piece in pieces]
