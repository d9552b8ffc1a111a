"""What planning yields: the order, where every resource lives, the barriers, and every decision with its reason."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rendergraph.plan.graph import Decision, Graph, SubPass, TextureDesc


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """How to plan. ``order``: ``default`` (deterministic), ``memory`` (a search of ``order_budget`` trials for the
    smallest peak), ``random`` (a legal random order from ``seed``, for testing) or ``listed`` (``sequence``, the names
    of all sub-passes that run).
    """

    alias: bool = True
    cull: bool = True
    order: str = "default"
    order_budget: int = 200
    seed: int = 0
    sequence: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Lifetime:
    """First and last index in ``Plan.order`` that touches a resource, both inclusive."""

    first: int
    last: int


@dataclass(frozen=True, slots=True)
class TextureSlot:
    """Storage that tenants use one after another. ``desc`` is its own; a tenant of another format is a view of it."""

    desc: TextureDesc
    tenants: tuple[str, ...]  # in order of use


@dataclass(frozen=True, slots=True)
class BufferRange:
    """A buffer's place in the one shared transient heap: offset (a multiple of 256) and size in bytes."""

    offset: int
    bytes: int


@dataclass(frozen=True, slots=True)
class Hazard:
    """Why a barrier is there: ``earlier`` and ``later`` are sub-pass names, ``kind`` a name of
    ``rendergraph.document.models.BarrierKind``. ``resource`` is what the later sub-pass uses, ``previous_resource``
    what the earlier one used: they differ when two resources share storage.
    """

    resource: str
    previous_resource: str
    earlier: str
    later: str
    kind: str


@dataclass(frozen=True, slots=True)
class Barrier:
    """Issued before ``order[index]``: ``bits`` of ``glMemoryBarrier`` (0 for none) and/or ``glTextureBarrier``."""

    index: int
    bits: int
    texture_barrier: bool
    hazards: tuple[Hazard, ...]


@dataclass(frozen=True, slots=True)
class MemoryTotals:
    """Bytes of transient resources under five rules, and the memory the plan really uses.

    ``unshared``: each has its own; ``exact_pool``: shared between equal descriptions; ``view_pool``: shared within view
    classes; ``placed``: best packing a heap API would reach; ``load``: the lower bound, most bytes live at once.
    Buffers count rounded up to 256 bytes, and are packed by offset in both pools.
    ``used`` is ``view_pool``, or ``unshared`` when aliasing is off.
    """

    unshared: int
    exact_pool: int
    view_pool: int
    placed: int
    load: int
    used: int
    peak: tuple[str, ...] = ()  # the resources live where `load` is reached


@dataclass(frozen=True, slots=True)
class Plan:
    """A graph ready to run. Culled sub-passes are absent from ``order`` and explained in ``decisions``."""

    graph: Graph
    options: PlanOptions
    order: tuple[SubPass, ...]
    culled: tuple[str, ...]
    lifetimes: Mapping[str, Lifetime]
    slots: tuple[TextureSlot, ...]
    slot_of: Mapping[str, int]  # texture resource -> index into slots (transients only)
    buffer_of: Mapping[str, BufferRange]  # transient buffers
    heap_bytes: int
    barriers: tuple[Barrier, ...]  # by index, at most one an index
    totals: MemoryTotals
    decisions: tuple[Decision, ...] = field(default_factory=tuple)

    def _repr_html_(self) -> str:
        from rendergraph.report.notebook import plan_html

        return plan_html(self)

    def _repr_png_(self) -> bytes:
        from rendergraph.report.graph_png import graph_png

        return graph_png(self)
