"""Which memory barriers a plan needs: no more, and none by guess.

OpenGL orders its commands by itself, except for shader stores and atomics on images and storage buffers ("incoherent"
accesses; 4.5 core, section 7.13.2). A ``glMemoryBarrier`` bit names how memory is used *after* it. It is needed

- between an incoherent write and any later access (the later one would not see, or would race with, the write);
- between any access and a later incoherent write (stores wait for earlier accesses only across a barrier).

``glTextureBarrier`` is needed before a draw that samples what it renders to, after earlier rendering to it (9.3.1).
Everything is derived on storage, so tenants of one slot guard each other; and around the frame boundary, since frame
N's tail runs into frame N+1's head, with history swapped in between.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from rendergraph.plan.graph import Decision, Graph, SubPass
from rendergraph.plan.place_barriers import place
from rendergraph.plan.plan import Barrier, BufferRange, Hazard
from rendergraph.plan.storage import CellHistory, Touch, cell_histories

#: Bits of ``glMemoryBarrier`` by kind. The texture barrier is a call of its own and has no bit.
BITS = {
    "vertex_attrib": 0x1,
    "element_array": 0x2,
    "uniform": 0x4,
    "texture_fetch": 0x8,
    "shader_image": 0x20,
    "command": 0x40,
    "texture_update": 0x100,
    "buffer_update": 0x200,
    "framebuffer": 0x400,
    "shader_storage": 0x2000,
    "texture_barrier": 0,
}


@dataclass(frozen=True, slots=True)
class Barriers:
    """The barriers of a frame; every hazard with whether both its ends lie in one frame; and why, as decisions."""

    barriers: tuple[Barrier, ...]
    hazards: tuple[tuple[Hazard, bool], ...]
    decisions: list[Decision]


#: What makes two hazards one: resource, previous resource, position of the earlier and of the later access, kind.
_Key = tuple[str, str, int, int, str]


def derive_barriers(
    graph: Graph, order: Sequence[SubPass], slot_of: Mapping[str, int], buffer_of: Mapping[str, BufferRange]
) -> Barriers:
    """The fewest bits that cover every hazard of the steady state, each issued as late as it can be."""
    length = len(order)
    found: dict[_Key, int] = {}  # -> the latest earlier access, counted from the later one's frame
    for history in cell_histories(graph, order, slot_of, buffer_of):
        _walk(history, length, found)
    latest: dict[str, dict[int, int]] = {}
    for (_, _, _, later, kind), earlier in found.items():
        by_position = latest.setdefault(kind, {})
        by_position[later] = max(by_position.get(later, earlier), earlier)
    points = {kind: place(by_position, length) for kind, by_position in latest.items()}
    served: dict[tuple[int, str], list[Hazard]] = {}
    hazards: list[tuple[Hazard, bool]] = []
    for key in sorted(found, key=lambda k: (k[3], k[4], k[0], k[2], k[1])):
        resource, previous, earlier, later, kind = key
        hazard = Hazard(resource, previous, order[earlier].name, order[later].name, kind)
        hazards.append((hazard, found[key] >= 0))
        at = bisect_right(points[kind], later) - 1  # -1: the last barrier, of the frame before
        served.setdefault((points[kind][at], kind), []).append(hazard)
    barriers: list[Barrier] = []
    decisions: list[Decision] = []
    for index, group in groupby(sorted(served), key=lambda pair: pair[0]):
        kinds = [kind for _, kind in group]
        bits = sum(BITS[kind] for kind in kinds)
        caused = tuple(hazard for kind in kinds for hazard in served[index, kind])
        barriers.append(Barrier(index, bits, "texture_barrier" in kinds, caused))
        decisions += [_explain(order[index].name, kind, served[index, kind]) for kind in kinds]
    return Barriers(tuple(barriers), tuple(hazards), decisions)


def _explain(before: str, kind: str, hazards: Sequence[Hazard]) -> Decision:
    """The first hazard stands for all; reasons: ``feedback_loop``, ``shared_storage``, ``incoherent_access``."""
    first = next((h for h in hazards if h.resource == h.previous_resource), hazards[0])
    if kind == "texture_barrier":
        reason = "feedback_loop"
    else:
        reason = "incoherent_access" if first.resource == first.previous_resource else "shared_storage"
    evidence = {
        "kind": kind,
        "resource": first.resource,
        "previous_resource": first.previous_resource,
        "earlier": first.earlier,
        "later": first.later,
        "hazards": len(hazards),
    }
    return Decision("barrier", reason, before, evidence)


def _walk(history: CellHistory, length: int, found: dict[_Key, int]) -> None:
    """Two rounds over the period: the first to know what the frame before left behind, the second to record."""
    stored: list[tuple[int, Touch]] = []  # the last incoherent write, unless replaced whole since
    rendered: list[tuple[int, Touch]] = []  # the last write as an attachment
    written: list[tuple[int, Touch]] = []  # the last write of any sort
    read: list[tuple[int, Touch]] = []  # reads since then
    for lap in (0, 1):
        for frame, touches in enumerate(history.frames):
            base = (lap * len(history.frames) + frame) * length
            for position, group_ in groupby(touches, key=lambda touch: touch.position):
                group = list(group_)
                if lap:
                    for touch in group:
                        causes = [(touch.kind, stored)]
                        if touch.incoherent:
                            causes.append((touch.kind, read or written))
                        if touch.feedback:
                            causes.append(("texture_barrier", rendered))
                        for kind, earlier in causes:
                            for time, previous in earlier:
                                key = touch.resource, previous.resource, previous.position, position, kind
                                found[key] = max(found.get(key, time - base), time - base)
                now = base + position
                writes = [(now, touch) for touch in group if touch.writes]
                if not writes:
                    read += [(now, touch) for touch in group]
                    continue
                incoherent = [(now, touch) for touch in group if touch.incoherent]
                if incoherent or not any(touch.loads for touch in group):
                    stored = incoherent
                rendered = [(now, touch) for touch in group if touch.attachment] or rendered
                written, read = writes, []
