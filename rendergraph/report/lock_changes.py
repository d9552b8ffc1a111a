"""What differs between a plan's lock and the plan of today, the worst first."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.plan.graph import Position
from rendergraph.report.plan_lock import LockedBarrier, LockedResource, LockedSlot, PlanLock


@dataclass(frozen=True, slots=True)
class Change:
    """One difference: its row of the message table and the values for it. ``subject`` is the sub-pass, resource or
    total concerned; ``rank`` is smaller for what is worse: more bytes, then barriers, order, what is culled, slots,
    resources, fewer bytes.
    """

    code: str
    subject: str
    rank: tuple[int, int]
    values: dict[str, Any]


def lock_changes(before: PlanLock, after: PlanLock) -> list[Change]:
    """Every difference, worst first. Empty when the plan is as locked."""
    changes: list[Change] = []
    if before.size != after.size:
        sizes = {"before": _size(before.size), "after": _size(after.size)}
        changes.append(Change("RG727", "frame", (0, 0), sizes))
    changes += _bytes(before, after)
    changes += _barriers(before.barriers, after.barriers)
    changes += _order(before.order, after.order, set(before.culled), set(after.culled))
    changes += _slots(before.slots, after.slots)
    changes += _resources(before.resources, after.resources)
    return sorted(changes, key=lambda change: (change.rank, change.subject))


def change_diagnostics(changes: Iterable[Change], document: Document, lock: str) -> list[Diagnostic]:
    """The changes as diagnostics at the passes and resources of the graph file; ``lock`` names the lock file."""
    return [diagnose(c.code, _place(document, c.subject), lock=lock, **c.values) for c in changes]


def _place(document: Document, subject: str) -> Position:
    """The declaration of a resource or of a sub-pass's pass; the list of passes for what is gone, or is a total."""
    owner = subject.partition(".")[0]
    for section, names in (("resources", document.model.resources), ("passes", document.model.passes)):
        if owner in names:
            return document.position(section, owner, key=True)
    return document.position("passes", key=True)


# ---------------------------------------------------------------- bytes


def _bytes(before: PlanLock, after: PlanLock) -> Iterator[Change]:
    """Each total, said of the resource whose size changed most in the same direction, if there is one."""
    sizes = {r.name: r.bytes for r in after.resources}
    for resource in before.resources:
        sizes[resource.name] = sizes.get(resource.name, 0) - resource.bytes
    buffers = {r.name for r in (*before.resources, *after.resources) if r.shape.startswith("buffer")}
    for place, what in enumerate(dict.fromkeys([*after.bytes, *before.bytes])):
        was, now = before.bytes.get(what, 0), after.bytes.get(what, 0)
        if was != now:
            sign = 1 if now > was else -1
            suspects = sorted(buffers if what == "heap" else sizes)
            guilty = max(suspects, key=lambda name: sign * sizes[name], default=what)
            by = f"{100 * abs(now - was) / was:.1f} %" if was else f"{abs(now - was)} bytes"
            change = "grew" if now > was else "shrank"
            values = {"what": what, "change": change, "by": by, "before": was, "after": now}
            subject = guilty if sign * sizes.get(guilty, 0) > 0 else what
            yield Change("RG721", subject, (1 if now > was else 7, place), values)


# ---------------------------------------------------------------- barriers


def _barriers(before: Sequence[LockedBarrier], after: Sequence[LockedBarrier]) -> Iterator[Change]:
    was, now = ({b.before: b for b in barriers} for barriers in (before, after))
    for name in sorted(was.keys() | now.keys()):
        old, new = was.get(name), now.get(name)
        if old == new:
            continue
        if old is None and new is not None:
            change = f"is new: {', '.join(new.bits)} for {', '.join(new.resources)}"
        elif new is None and old is not None:
            change = f"is gone: {', '.join(old.bits)} for {', '.join(old.resources)}"
        else:
            assert old is not None
            assert new is not None
            parts = [_sets("bits", old.bits, new.bits), _sets("resources", old.resources, new.resources)]
            change = "changed: " + "; ".join(part for part in parts if part)
        more = len(new.bits if new else ()) - len(old.bits if old else ())
        yield Change("RG722", name, (2, -more), {"name": name, "change": change})


def _sets(what: str, before: Sequence[str], after: Sequence[str]) -> str:
    added, gone = [n for n in after if n not in before], [n for n in before if n not in after]
    return ", ".join(
        f"{what} {word} {', '.join(names)}" for word, names in (("added:", added), ("removed:", gone)) if names
    )


# ---------------------------------------------------------------- order


def _order(before: Sequence[str], after: Sequence[str], was_culled: set[str], is_culled: set[str]) -> Iterator[Change]:
    was, now = set(before), set(after)
    for name in sorted(was - now):
        if name not in is_culled:
            yield Change("RG723", name, (3, 0), {"name": name, "change": "is gone"})
    for name in after:
        if name not in was and name not in was_culled:
            yield Change("RG723", name, (3, 1), {"name": name, "change": f"is new, {_beside(name, after)}"})
    places = {name: index for index, name in enumerate(before)}
    kept = [name for name in after if name in was]
    for name in _moved(kept, [places[name] for name in kept]):
        change = f"moved from place {places[name] + 1} to {after.index(name) + 1} ({_beside(name, after)})"
        yield Change("RG723", name, (3, 2), {"name": name, "change": change})
    for name in sorted(is_culled - was_culled):
        change = "is culled now" if name in was else "is new, and culled"
        yield Change("RG724", name, (4, 0), {"name": name, "change": change})
    for name in sorted(was_culled - is_culled):
        change = "runs now: it was culled" if name in now else "is gone: it was culled"
        yield Change("RG724", name, (4, 1), {"name": name, "change": change})


def _beside(name: str, order: Sequence[str]) -> str:
    index = order.index(name)
    return f"after '{order[index - 1]}'" if index else "first"


def _moved(names: Sequence[str], places: Sequence[int]) -> list[str]:
    """The fewest names that must move: all but a longest run whose old places still ascend."""
    ends: list[int] = []  # the smallest last place of an ascending run of each length
    runs: list[int] = []  # of each name, the length of the longest run that ends with it
    for place in places:
        at = bisect_left(ends, place)
        ends[at : at + 1] = [place]
        runs.append(at + 1)
    want, limit, kept = len(ends), float("inf"), set()
    for index in range(len(names) - 1, -1, -1):
        if runs[index] == want and places[index] < limit:
            kept.add(names[index])
            want, limit = want - 1, places[index]
    return [name for name in names if name not in kept]


# ---------------------------------------------------------------- slots and resources


def _slots(before: Sequence[LockedSlot], after: Sequence[LockedSlot]) -> Iterator[Change]:
    was, now = ({tuple(slot.tenants): slot for slot in slots} for slots in (before, after))
    for tenants in sorted(was.keys() | now.keys()):
        old, new = was.get(tenants), now.get(tenants)
        if old == new:
            continue
        if old is None and new is not None:
            change, size = f"is new: {new.bytes} bytes", new.bytes
        elif new is None and old is not None:
            change, size = f"is gone: {old.bytes} bytes", 0
        else:
            assert old is not None
            assert new is not None
            change, size = f"changed: {old.shape} -> {new.shape}", new.bytes
        listed = ", ".join(f"'{name}'" for name in tenants)
        yield Change("RG725", tenants[0], (5, -size), {"tenants": listed, "change": change})


def _resources(before: Sequence[LockedResource], after: Sequence[LockedResource]) -> Iterator[Change]:
    was, now = ({r.name: r for r in resources} for resources in (before, after))
    for name in sorted(was.keys() | now.keys()):
        old, new = was.get(name), now.get(name)
        if old == new:
            continue
        if old is None and new is not None:
            change = f"is new: {new.kind}, {new.shape}, {new.bytes} bytes"
        elif new is None:
            change = "is gone"
        else:
            assert old is not None
            pairs = [
                ("kind", old.kind, new.kind),
                ("shape", old.shape, new.shape),
                ("bytes", old.bytes, new.bytes),
                ("first use", old.first, new.first),
                ("last use", old.last, new.last),
            ]
            change = "changed: " + ", ".join(f"{what} {a} -> {b}" for what, a, b in pairs if a != b)
        more = (new.bytes if new else 0) - (old.bytes if old else 0)
        yield Change("RG726", name, (6, -more), {"name": name, "change": change})


def _size(size: Sequence[int]) -> str:
    return "x".join(map(str, size))
