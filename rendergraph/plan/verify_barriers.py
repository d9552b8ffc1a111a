"""Plays frames through with a plan's barriers and looks for hazards left open. Part of ``verify``; independent of the
planner: it simulates storage frame by frame, with real copies for history and real bytes for buffers.

The bits are those of ``glMemoryBarrier``, written from the table of OpenGL 4.5 core, section 7.13.2.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from rendergraph.plan.graph import Access, BufferDesc, CopyTexture, SubPass, TextureDesc, Usage
from rendergraph.plan.plan import Plan

FEEDBACK = -1  # stands for glTextureBarrier among the bits

_BIT_BY_WORD = {
    "vertex": 1 << 0, "index": 1 << 1, "uniform": 1 << 2, "sampled": 1 << 3,
    "image_read": 1 << 5, "image_write": 1 << 5, "image_update": 1 << 5, "indirect": 1 << 6,
    "color": 1 << 10, "depth": 1 << 10, "depth_read": 1 << 10,
    "storage_read": 1 << 13, "storage_write": 1 << 13, "storage_update": 1 << 13,
}  # fmt: skip
_TEXTURE_UPDATE, _BUFFER_UPDATE, _FRAMEBUFFER = 1 << 8, 1 << 9, 1 << 10

Area = tuple[int, int]  # first byte and end in a buffer; first spot and end in a texture, a spot being a mip and layer


class _Times:
    """A line of bytes or spots, each with the time of an event, -1 for never."""

    def __init__(self) -> None:
        self._starts = [0]
        self._times = [-1]

    def latest(self, area: Area) -> int:
        """The last time in an area."""
        low, high = bisect_right(self._starts, area[0]) - 1, bisect_left(self._starts, area[1])
        return max(self._times[low:high])

    def paint(self, area: Area, time: int) -> None:
        """Overwrite the time in an area."""
        low, high = self._cut(area[0]), self._cut(area[1])
        self._starts[low:high] = [area[0]]
        self._times[low:high] = [time]

    def _cut(self, at: int) -> int:
        found = bisect_right(self._starts, at) - 1
        if self._starts[found] != at:
            found += 1
            self._starts.insert(found, at)
            self._times.insert(found, self._times[found - 1])
        return found


@dataclass(slots=True)
class _Memory:
    """What one physical storage has seen: any access, incoherent writes not replaced since, and rendering."""

    touched: _Times = field(default_factory=_Times)
    stored: _Times = field(default_factory=_Times)
    rendered: _Times = field(default_factory=_Times)


@dataclass(frozen=True, slots=True)
class _Use:
    """One access of storage that some shader stores to (or some draw feeds back on)."""

    home: str
    age: int  # frames since its content was this frame's
    areas: tuple[Area, ...]
    bit: int
    access: Access
    loops: bool


def check_barriers(plan: Plan) -> list[str]:
    """Faults of ``plan.barriers``."""
    faults = list(_check_form(plan))
    uses, copies = _uses(plan)
    calls = {barrier.index: barrier for barrier in plan.barriers}
    issued: dict[int, int] = {}  # bit -> time of the last barrier
    memory: dict[tuple[str, int], _Memory] = defaultdict(_Memory)
    told: set[str] = set()
    for frame in range(max(copies.values(), default=0) + 1):
        for at in sorted({*uses, *calls}):
            now = frame * len(plan.order) + at
            if at in calls:
                issued |= {1 << k: now for k in range(16) if calls[at].bits >> k & 1}
                if calls[at].texture_barrier:
                    issued[FEEDBACK] = now
            here = [(use, memory[use.home, (frame - use.age) % copies[use.home]]) for use in uses.get(at, ())]
            for use, seen in here:
                name = plan.order[at].name
                if name not in told and _exposed(use, seen, issued):
                    told.add(name)
                    faults.append(f"barrier: {name} uses {use.access.resource} with none of its kind since")
            # Replacing comes first: what the same sub-pass stores beside it stays on record.
            for use, seen in sorted(here, key=lambda pair: pair[0].access.usage.incoherent or pair[0].access.load):
                _record(use, seen, now)
    return faults


def _exposed(use: _Use, seen: _Memory, issued: dict[int, int]) -> bool:
    """Whether the access may meet an earlier one that no barrier keeps it from."""
    since = issued.get(use.bit, -1)
    before = seen.touched if use.access.usage.incoherent else seen.stored
    if any(before.latest(area) >= max(since, 0) for area in use.areas):
        return True
    return use.loops and any(seen.rendered.latest(area) >= max(issued.get(FEEDBACK, -1), 0) for area in use.areas)


def _record(use: _Use, seen: _Memory, now: int) -> None:
    usage = use.access.usage
    for area in use.areas:
        seen.touched.paint(area, now)
        if usage.incoherent:
            seen.stored.paint(area, now)
        elif usage.writes and not use.access.load:
            seen.stored.paint(area, -1)  # none of the earlier stores is left to be seen
        if usage is Usage.COLOR or usage is Usage.DEPTH:
            seen.rendered.paint(area, now)


def _check_form(plan: Plan) -> Iterator[str]:
    indices = [barrier.index for barrier in plan.barriers]
    if indices != sorted(set(indices)) or any(not 0 <= index < len(plan.order) for index in indices):
        yield "barrier: not one an index, in order"
    names = {step.name for step in plan.order}
    for barrier in plan.barriers:
        if not barrier.hazards or not (barrier.bits or barrier.texture_barrier):
            yield f"barrier: the one before {barrier.index} has no cause or no effect"
        if any(hazard.earlier not in names or hazard.later not in names for hazard in barrier.hazards):
            yield f"barrier: the one before {barrier.index} names what does not run"


def _uses(plan: Plan) -> tuple[dict[int, list[_Use]], dict[str, int]]:
    """By position, the uses of storage that could need a barrier; and how many copies of each storage exist."""
    homes: dict[str, tuple[str, int]] = {}
    copies: dict[str, int] = {}
    hot: set[str] = set()
    mips: dict[str, set[int | None]] = defaultdict(set)
    layers: dict[str, set[int | None]] = defaultdict(set)
    for step in plan.order:
        rendered = _rendered(step)
        for access in step.accesses:
            name = access.resource
            if name not in homes:
                homes[name] = _home(plan, name)
            home, age = homes[name]
            copies[home] = max(copies.get(home, 1), age + 1)
            if access.usage.incoherent or _loops(rendered, access):
                hot.add(home)
            mips[home].add(access.mip)
            layers[home].add(access.layer)
    uses: dict[int, list[_Use]] = {}
    if not hot:
        return uses, {}
    for name in plan.graph.outputs:
        home, age = _home(plan, name)
        copies[home] = max(copies.get(home, 1), age + 1)
    areas: dict[tuple[str, int | None, int | None], tuple[Area, ...]] = {}  # by resource, mip and layer
    for at, step in enumerate(plan.order):
        rendered = _rendered(step)
        for access in step.accesses:
            home, age = homes[access.resource]
            if home in hot:
                spot = access.resource, access.mip, access.layer
                if spot not in areas:
                    areas[spot] = _areas(plan, access, mips[home], layers[home])
                use = _Use(home, age, areas[spot], _bit(plan, step, access), access, _loops(rendered, access))
                uses.setdefault(at, []).append(use)
    return uses, {home: copies[home] for home in hot}


def _home(plan: Plan, name: str) -> tuple[str, int]:
    if name in plan.slot_of:
        return f"slot {plan.slot_of[name]}", 0
    if name in plan.buffer_of:
        return "the heap", 0
    age = 0
    while plan.graph.resources[name].previous_of is not None:
        name, age = str(plan.graph.resources[name].previous_of), age + 1
    return f"own {name}", age


def _rendered(step: SubPass) -> list[Access]:
    """What a draw renders to."""
    return [a for a in step.accesses if a.usage is Usage.COLOR or a.usage is Usage.DEPTH]


def _loops(rendered: list[Access], access: Access) -> bool:
    """Whether this samples texels that the same draw renders to."""
    if access.usage is not Usage.SAMPLED:
        return False
    for other in rendered:
        if other.resource == access.resource:
            pairs = (other.mip, access.mip), (other.layer, access.layer)
            if all(None in pair or pair[0] == pair[1] for pair in pairs):
                return True
    return False


def _areas(plan: Plan, access: Access, mips: set[int | None], layers: set[int | None]) -> tuple[Area, ...]:
    desc = plan.graph.resources[access.resource].desc
    if isinstance(desc, BufferDesc):
        place = plan.buffer_of.get(access.resource)
        start = place.offset if place else 0
        return ((start, start + desc.bytes),)
    rows, columns = _split(mips, desc.mips), _split(layers, desc.layers)
    spots = [
        y * len(columns) + x
        for y, row in enumerate(rows)
        for x, column in enumerate(columns)
        if (len(rows) == 1 or access.mip in (None, row)) and (len(columns) == 1 or access.layer in (None, column))
    ]
    if len(spots) == len(rows) * len(columns):
        return ((0, len(spots)),)
    return tuple((spot, spot + 1) for spot in spots)


def _split(chosen: set[int | None], count: int) -> list[int | None]:
    """The levels (or layers) that are named on their own, and ``None`` for the rest where there is one."""
    numbers = sorted(number for number in chosen if number is not None)
    named: list[int | None] = [*numbers] if count > 1 else []
    return named if len(named) == count else [*named, None]


def _bit(plan: Plan, step: SubPass, access: Access) -> int:
    word = access.usage.value
    if word in _BIT_BY_WORD:
        return _BIT_BY_WORD[word]
    if not isinstance(plan.graph.resources[access.resource].desc, TextureDesc):
        return _BUFFER_UPDATE
    return _FRAMEBUFFER if isinstance(step.work, CopyTexture) and step.work.blit else _TEXTURE_UPDATE
