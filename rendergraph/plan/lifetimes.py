"""When each resource is first and last used, and how many transient bytes are live at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate

from rendergraph.plan.graph import BufferDesc, Graph, Kind, Resource, SubPass
from rendergraph.plan.plan import Lifetime

#: Buffers live in one heap at multiples of this many bytes, the largest offset alignment OpenGL allows a driver to ask.
ALIGNMENT = 256


def storage_bytes(resource: Resource) -> int:
    """Bytes a resource takes: a texture's texels, a buffer's size rounded up to the heap's alignment."""
    desc = resource.desc
    return -(-desc.bytes // ALIGNMENT) * ALIGNMENT if isinstance(desc, BufferDesc) else desc.bytes


def find_lifetimes(graph: Graph, order: Sequence[SubPass]) -> dict[str, Lifetime]:
    """First and last use of every resource that the order touches, by name. Outputs are read after the frame, so
    they live to its end; one that no sub-pass touches (an image file, a history) lives all along.
    """
    first: dict[str, int] = {}
    last: dict[str, int] = {}
    for position, subpass in enumerate(order):
        for access in subpass.accesses:
            name = access.resource
            if name not in first:
                first[name] = position
            last[name] = position
    for name in graph.outputs:
        first.setdefault(name, 0)
        last[name] = max(0, len(order) - 1)
    return {name: Lifetime(first[name], last[name]) for name in sorted(first)}


def transients(graph: Graph, lifetimes: Mapping[str, Lifetime]) -> list[str]:
    """Names of the transient resources that are used, sorted."""
    return [name for name in lifetimes if graph.resources[name].kind is Kind.TRANSIENT]


def find_load(lifetimes: Mapping[str, Lifetime], sizes: Mapping[str, int]) -> tuple[int, tuple[str, ...]]:
    """LOAD: the most bytes of transient resources (``sizes``, by name) live at once, which no sharing can get below,
    and who they are.
    """
    change: dict[int, int] = {}
    for name, size in sizes.items():
        life = lifetimes[name]
        change[life.first] = change.get(life.first, 0) + size
        change[life.last + 1] = change.get(life.last + 1, 0) - size
    load = now = peak = 0
    for position in sorted(change):
        now += change[position]
        if now > load:
            load, peak = now, position
    return load, tuple(name for name in sizes if lifetimes[name].first <= peak <= lifetimes[name].last)


def live_bytes(graph: Graph, lifetimes: Mapping[str, Lifetime], length: int) -> tuple[int, ...]:
    """Bytes of transient resources live at each of ``length`` positions; the most of them is LOAD."""
    change = [0] * (length + 1)
    for name in transients(graph, lifetimes):
        size, life = storage_bytes(graph.resources[name]), lifetimes[name]
        change[life.first] += size
        change[life.last + 1] -= size
    return tuple(accumulate(change[:length]))
