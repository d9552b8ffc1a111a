"""The page's lifetime chart: resources against sub-passes, coloured by slot, under the curve of live bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

from rendergraph.plan.graph import BufferDesc, Kind, TextureDesc
from rendergraph.plan.lifetimes import live_bytes
from rendergraph.plan.plan import Plan
from rendergraph.report.tables import mebibytes

#: Colours to tell slots apart; a later slot takes a colour again, its number is written on it.
_HUES = 10
_CURVE_HEIGHT = 100


@dataclass(frozen=True, slots=True)
class LifeBar:
    """A resource's row. Positions count sub-passes from 0; ``hue`` is ``None`` for what is never pooled."""

    name: str
    shape: str
    bytes: int
    size: str
    first: int
    last: int
    span: str
    place: str
    shares: tuple[str, ...]
    hue: int | None
    slot: int  # to sort by: texture slots, then the buffer heap, then what is not pooled
    buffer: bool
    peak: bool


@dataclass(frozen=True, slots=True)
class Total:
    """A figure of :class:`rendergraph.plan.plan.MemoryTotals`, its share of the largest, and what it means."""

    name: str
    size: str
    share: float
    meaning: str
    used: bool


@dataclass(frozen=True, slots=True)
class LifetimeChart:
    """Columns (sub-pass, number of its pass's run, whether a barrier stands before it), rows, and the curve."""

    columns: tuple[tuple[str, int, bool], ...]
    rows: tuple[LifeBar, ...]
    curve: str  # an SVG path over ``len(columns)`` x 100
    load_at: float  # per cent from the top
    used_at: float
    live: tuple[str, ...]  # bytes at each column, for people
    load: str
    used: str
    ratio: str
    totals: tuple[Total, ...]
    outside: str  # bytes of what is never pooled


_MEANINGS: Mapping[str, str] = {
    "unshared": "every transient resource on its own",
    "exact_pool": "sharing between equal formats and sizes",
    "view_pool": "sharing within a view class",
    "placed": "best packing found; a heap API could do it",
    "load": "most bytes live at once: no sharing gets below",
}


def lifetime_chart(plan: Plan) -> LifetimeChart:
    """The chart of a plan."""
    barriers = {barrier.index for barrier in plan.barriers}
    columns: list[tuple[str, int, bool]] = []
    for number, (_, run) in enumerate(groupby(enumerate(plan.order), key=lambda pair: pair[1].parent)):
        columns += [(subpass.name, number, index in barriers) for index, subpass in run]
    rows = sorted((_row(plan, name) for name in plan.lifetimes), key=lambda row: (row.first, row.last, row.name))
    live = live_bytes(plan.graph, plan.lifetimes, len(plan.order))
    totals = plan.totals
    top = 1.08 * max(totals.load, totals.used, 1)
    figures = {name: int(getattr(totals, name)) for name in _MEANINGS}
    used = "view_pool" if plan.options.alias else "unshared"
    largest = max(*figures.values(), 1)
    return LifetimeChart(
        columns=tuple(columns),
        rows=tuple(rows),
        curve=_curve([_CURVE_HEIGHT * (1 - count / top) for count in live]),
        load_at=100 * (1 - totals.load / top),
        used_at=100 * (1 - totals.used / top),
        live=tuple(mebibytes(count) for count in live),
        load=mebibytes(totals.load),
        used=mebibytes(totals.used),
        ratio=f"{totals.used / totals.load:.2f} × LOAD" if totals.load else "nothing is transient",
        totals=tuple(
            Total(name.replace("_", " "), mebibytes(value), value / largest, _MEANINGS[name], name == used)
            for name, value in figures.items()
        ),
        outside=mebibytes(sum(row.bytes for row in rows if row.hue is None)),
    )


def _row(plan: Plan, name: str) -> LifeBar:
    resource, life = plan.graph.resources[name], plan.lifetimes[name]
    slot = plan.slot_of.get(name)
    pooled = resource.kind is Kind.TRANSIENT
    place, hue, rank = resource.kind.value, None, len(plan.slots) + 1
    if pooled and slot is not None:
        place, hue, rank = f"slot {slot}", slot % _HUES, slot
    elif pooled and name in plan.buffer_of:
        place, hue, rank = f"heap +{plan.buffer_of[name].offset}", len(plan.slots) % _HUES, len(plan.slots)
    tenants = plan.slots[slot].tenants if slot is not None else ()
    first, last = (plan.order[i].name for i in (life.first, life.last)) if plan.order else ("", "")
    return LifeBar(
        name=name,
        shape=_shape(resource.desc),
        bytes=resource.desc.bytes,
        size=mebibytes(resource.desc.bytes),
        first=life.first,
        last=life.last,
        span=f"{first} to {last}" if first != last else first,
        place=place,
        shares=tuple(tenant for tenant in tenants if tenant != name),
        hue=hue,
        slot=rank,
        buffer=isinstance(resource.desc, BufferDesc),
        peak=name in plan.totals.peak,
    )


def _shape(desc: TextureDesc | BufferDesc) -> str:
    if isinstance(desc, BufferDesc):
        return "buffer"
    size = f"{desc.width}×{desc.height}" + (f"×{desc.layers}" if desc.layers > 1 else "")
    extra = [f"{desc.mips} mips"] * (desc.mips > 1) + [f"{desc.samples} samples"] * (desc.samples > 1)
    return " ".join([desc.format, size, *extra])


def _curve(heights: list[float]) -> str:
    steps = "".join(f"V{y:.2f}H{x}" for x, y in enumerate(heights, 1))
    return f"M0 {_CURVE_HEIGHT}{steps}V{_CURVE_HEIGHT}Z"
