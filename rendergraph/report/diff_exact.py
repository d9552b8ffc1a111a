"""What needs no statistics: bytes, slots, order, barriers, culled sub-passes, draws. Equal or not, and which way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from enum import StrEnum
from typing import Any, Final

from rendergraph.report.diff_names import Matching
from rendergraph.report.record_models import TOTALS, BarrierModel, DescModel, ResourceModel, ResourcesRecord


class Direction(StrEnum):
    """Whether more is spent; ``changed`` where neither side is better."""

    WORSE = "worse"
    CHANGED = "changed"
    BETTER = "better"


@dataclass(frozen=True, slots=True)
class ExactChange:
    """One exact difference. ``before`` and ``after`` are JSON-ready; ``text`` says it in words.

    ``kind``: error, total, resource, sharing, lifetime, slots, barrier, order, subpass, pass, culled, counter,
    steady_state or bound (told from measurements, but one of four classes).
    """

    kind: str
    subject: str
    direction: Direction
    before: Any
    after: Any
    text: str

    @property
    def growth(self) -> float:
        """How many times as much it is now, for the worst first; 1 where that has no meaning."""
        if isinstance(self.before, int) and isinstance(self.after, int):
            return (self.after + 1) / (self.before + 1)
        return 1.0


#: Kinds from the most to the least telling.
KINDS: Final = (
    "error", "total", "resource", "barrier", "counter", "steady_state", "bound", "culled", "pass", "subpass", "order",
    "slots",
    "sharing", "lifetime",
)  # fmt: skip
_DIRECTIONS: Final = (Direction.WORSE, Direction.CHANGED, Direction.BETTER)


def worst_first(change: ExactChange) -> tuple[int, int, float, str]:
    """Sort key."""
    return _DIRECTIONS.index(change.direction), KINDS.index(change.kind), -change.growth, change.subject


def compare_resources(a: ResourcesRecord, b: ResourcesRecord, names: Matching) -> Iterator[ExactChange]:
    """Everything exact in two resources records; :mod:`rendergraph.report.diff_counts` for what timing records hold."""
    for total in TOTALS:
        before, after = a.totals[total], b.totals[total]
        if before != after:  # what is really allocated decides; the others are what might have been
            direction = _spent(before, after) if total == "used" else Direction.CHANGED
            yield amount("total", total, before, after, f"transient bytes, {total}", direction)
    old = {names.after_name(r.name): r for r in a.resources}
    new = {r.name: r for r in b.resources}
    for name in old.keys() - new.keys():
        yield ExactChange("resource", name, Direction.CHANGED, old[name].bytes, None, f"resource {name} is gone")
    for name in new.keys() - old.keys():
        text = f"resource {name} is new: {_shape(new[name].desc)}, {new[name].bytes} bytes"
        yield ExactChange("resource", name, Direction.CHANGED, None, new[name].bytes, text)
    for name in old.keys() & new.keys():
        yield from _compare_resource(name, old[name], new[name], names)
    if len(a.slots) != len(b.slots):
        yield amount("slots", "slots", len(a.slots), len(b.slots), "texture slots", Direction.CHANGED)
    yield from _compare_sharing(a, b, names)
    yield from _compare_barriers(a, b, names)
    yield from _compare_order([names.after_name(n) for n in a.order], b.order, names)
    yield from _compare_culled({names.after_name(n) for n in a.culled}, set(b.culled), b.order)


# ---- parts


def _spent(before: float, after: float) -> Direction:
    return Direction.WORSE if after > before else Direction.BETTER


def amount(
    kind: str, subject: str, before: int, after: int, what: str, direction: Direction | None = None
) -> ExactChange:
    """A change of a number; more of it is worse unless ``direction`` says otherwise."""
    share = f" ({100 * (after - before) / before:+.1f} %)" if before else ""
    text = f"{what}: {before} -> {after}{share}"
    return ExactChange(kind, subject, direction or _spent(before, after), before, after, text)


def _shape(desc: DescModel) -> str:
    if desc.buffer is not None:
        return f"buffer of {desc.buffer} bytes"
    counts = (("layers", desc.layers), ("mips", desc.mips), ("samples", desc.samples))
    size = "x".join(str(extent) for extent in desc.size)
    return " ".join([desc.format, size, *(f"{count} {name}" for name, count in counts if count != 1)])


def _compare_resource(name: str, a: ResourceModel, b: ResourceModel, names: Matching) -> Iterator[ExactChange]:
    if a.desc != b.desc or a.bytes != b.bytes or a.kind != b.kind:
        before, after = _shape(a.desc), _shape(b.desc)
        if before == after:
            before, after = f"{before} {a.kind}", f"{after} {b.kind}"
        text = f"resource {name}: {before} -> {after}"
        direction = Direction.CHANGED
        if a.bytes != b.bytes:
            direction = _spent(a.bytes, b.bytes)
            text += f", {a.bytes} -> {b.bytes} bytes ({100 * (b.bytes / a.bytes - 1):+.1f} %)" if a.bytes else ""
        yield ExactChange("resource", name, direction, a.bytes, b.bytes, text)
    before_life = [names.after_name(a.first), names.after_name(a.last)]
    if before_life != [b.first, b.last]:
        text = f"resource {name} lives from {b.first} to {b.last}, before from {before_life[0]} to {before_life[1]}"
        yield ExactChange("lifetime", name, Direction.CHANGED, before_life, [b.first, b.last], text)


def _compare_sharing(a: ResourcesRecord, b: ResourcesRecord, names: Matching) -> Iterator[ExactChange]:
    """Who shares memory with whom; slot numbers themselves mean nothing."""
    old, new = _mates(a, names), _mates(b, None)
    for name in sorted(old.keys() & new.keys()):
        if old[name] != new[name]:
            text = f"resource {name} shares with {_listed(new[name])}, before with {_listed(old[name])}"
            yield ExactChange("sharing", name, Direction.CHANGED, sorted(old[name]), sorted(new[name]), text)


def _mates(record: ResourcesRecord, names: Matching | None) -> dict[str, set[str]]:
    slots: dict[int, set[str]] = {}
    for entry in record.resources:
        if entry.slot is not None:
            slots.setdefault(entry.slot, set()).add(names.after_name(entry.name) if names else entry.name)
    return {name: tenants - {name} for tenants in slots.values() for name in tenants}


def _listed(names: set[str]) -> str:
    return ", ".join(sorted(names)) or "nobody"


def _compare_barriers(a: ResourcesRecord, b: ResourcesRecord, names: Matching) -> Iterator[ExactChange]:
    old = {names.after_name(barrier.before): barrier for barrier in a.barriers}
    new = {barrier.before: barrier for barrier in b.barriers}
    for name in [*new, *(n for n in old if n not in new)]:
        before, after = _bits(old.get(name)), _bits(new.get(name))
        if before == after:
            continue
        added, removed = sorted(after - before), sorted(before - after)
        hazards = sorted({h.resource for h in new[name].hazards}) if name in new else []
        text = f"barrier before {name}: " + ", ".join([f"+{bit}" for bit in added] + [f"-{bit}" for bit in removed])
        text += f" (for {', '.join(hazards)})" if hazards else ""
        direction = Direction.WORSE if added else Direction.BETTER
        yield ExactChange("barrier", name, direction, sorted(before), sorted(after), text)


def _bits(barrier: BarrierModel | None) -> set[str]:
    """The bits by name; by number where the record does not name every one."""
    if barrier is None:
        return set()
    named = set(barrier.names)
    if len(named) != barrier.bits.bit_count():
        named = {hex(1 << i) for i in range(barrier.bits.bit_length()) if barrier.bits >> i & 1}
    return named | ({"texture_barrier"} if barrier.texture_barrier else set())


def _compare_order(a: list[str], b: list[str], names: Matching) -> Iterator[ExactChange]:
    single = {*names.only_before, *names.only_after}
    for lost, after, word in ((set(a) - set(b), None, "is gone"), (set(b) - set(a), "", "is new")):
        for name in sorted(lost):
            if name.partition(".")[0] not in single:
                was, now = (name, None) if after is None else (None, name)
                yield ExactChange("subpass", name, Direction.CHANGED, was, now, f"sub-pass {name} {word}")
    before, now_order = [n for n in a if n in set(b)], [n for n in b if n in set(a)]
    if before != now_order:
        kept: set[str] = set()
        for match in SequenceMatcher(None, before, now_order, autojunk=False).get_matching_blocks():
            kept.update(before[match.a : match.a + match.size])
        moved = [n for n in now_order if n not in kept]
        text = f"order: {', '.join(moved)} moved"
        yield ExactChange("order", ", ".join(moved), Direction.CHANGED, before, now_order, text)


def _compare_culled(a: set[str], b: set[str], order: list[str]) -> Iterator[ExactChange]:
    for name in sorted(a - b):
        if name in order:
            yield ExactChange(
                "culled", name, Direction.WORSE, True, False, f"sub-pass {name} is no longer culled: it runs"
            )
    for name in sorted(b - a):
        yield ExactChange("culled", name, Direction.CHANGED, False, True, f"sub-pass {name} is culled now")
