"""``resources.json``: where every resource lives, when, beside whom and why, and the barriers; exact, compared exactly.

``docs/resources.schema.json`` is its JSON Schema.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, Final

import rendergraph
from rendergraph.document.formats import FORMATS
from rendergraph.plan.explain import explain_decision
from rendergraph.plan.graph import BufferDesc, Decision, TextureDesc
from rendergraph.plan.lifetimes import live_bytes
from rendergraph.plan.peak import find_peak
from rendergraph.plan.plan import Barrier, Plan
from rendergraph.report.memory_advice import Advice

SCHEMA = "rendergraph.resources/1"

#: The bits of ``glMemoryBarrier`` by their names (OpenGL 4.5 core, table 7.5), lowest first.
BARRIER_BITS: Final[dict[int, str]] = {
    0x1: "GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT",
    0x2: "GL_ELEMENT_ARRAY_BARRIER_BIT",
    0x4: "GL_UNIFORM_BARRIER_BIT",
    0x8: "GL_TEXTURE_FETCH_BARRIER_BIT",
    0x20: "GL_SHADER_IMAGE_ACCESS_BARRIER_BIT",
    0x40: "GL_COMMAND_BARRIER_BIT",
    0x100: "GL_TEXTURE_UPDATE_BARRIER_BIT",
    0x200: "GL_BUFFER_UPDATE_BARRIER_BIT",
    0x400: "GL_FRAMEBUFFER_BARRIER_BIT",
    0x2000: "GL_SHADER_STORAGE_BARRIER_BIT",
}


def resources_record(
    plan: Plan, title: str = "", *, advice: Sequence[Advice] = (), created: tuple[int, int] | None = None
) -> dict[str, Any]:
    """The record as JSON-ready data. Bytes are those GL was asked for, without the driver's padding.

    ``advice`` is what would lower the peak; ``created`` the number of frames after the first that ran, and of GL
    objects created in them: ``None`` for a plan that was not run.
    """
    totals = plan.totals
    sharing = {d.subject: d for d in plan.decisions if d.kind == "alias"}
    reasons = {(d.subject, d.evidence["kind"]): d for d in plan.decisions if d.kind == "barrier"}
    neighbours = _heap_neighbours(plan)
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": title,
        "size": [plan.graph.frame.width, plan.graph.frame.height],
        "order": [subpass.name for subpass in plan.order],
        "culled": list(plan.culled),
        "totals": {
            "unshared": totals.unshared,
            "exact_pool": totals.exact_pool,
            "view_pool": totals.view_pool,
            "placed": totals.placed,
            "load": totals.load,
            "used": totals.used,
            "used_over_load": round(totals.used / totals.load, 4) if totals.load else None,
            "peak": list(totals.peak),
        },
        "live_bytes": list(live_bytes(plan.graph, plan.lifetimes, len(plan.order))),
        "peak": _peak(plan),
        "advice": [{**asdict(entry), "why": entry.sentence()} for entry in advice],
        "resources": [_resource(plan, name, sharing.get(name), neighbours) for name in sorted(plan.lifetimes)],
        "slots": [
            {"index": index, "desc": _desc(slot.desc), "bytes": slot.desc.bytes, "tenants": list(slot.tenants)}
            for index, slot in enumerate(plan.slots)
        ],
        "heap_bytes": plan.heap_bytes,
        "barriers": [_barrier(plan, barrier, reasons) for barrier in plan.barriers],
        "objects_created": _created(created),
        "decisions": [_decision(d) for d in plan.decisions],
    }


def _peak(plan: Plan) -> dict[str, Any] | None:
    peak = find_peak(plan)
    if peak is None:
        return None
    holders = [{"name": name, "bytes": size, "share": round(size / peak.bytes, 4)} for name, size in peak.holders]
    return {"bytes": peak.bytes, "index": peak.index, "subpass": plan.order[peak.index].name, "resources": holders}


def _created(created: tuple[int, int] | None) -> dict[str, Any]:
    frames, objects = created if created is not None else (0, 0)
    return {"frames": frames, "objects": objects, "per_frame": round(objects / frames, 4) if frames else None}


def _resource(
    plan: Plan, name: str, decision: Decision | None, neighbours: Mapping[str, Sequence[str]]
) -> dict[str, Any]:
    resource, life = plan.graph.resources[name], plan.lifetimes[name]
    entry: dict[str, Any] = {
        "name": name,
        "kind": resource.kind.value,
        "declared": resource.declared,
        "bytes": resource.desc.bytes,
        "desc": _desc(resource.desc),
        "first": plan.order[life.first].name,
        "last": plan.order[life.last].name,
        "first_index": life.first,
        "last_index": life.last,
        "shares_with": [],
        "sharing": {"reason": decision.reason, "why": explain_decision(decision)} if decision is not None else None,
    }
    if name in plan.slot_of:
        index = plan.slot_of[name]
        entry["slot"] = index
        entry["shares_with"] = [t for t in plan.slots[index].tenants if t != name]
    if name in plan.buffer_of:
        entry["offset"] = plan.buffer_of[name].offset
        entry["shares_with"] = sorted(neighbours[name])
    if isinstance(resource.desc, TextureDesc):
        entry["view_class"] = FORMATS[resource.desc.format].view_class
    return entry


def _heap_neighbours(plan: Plan) -> dict[str, list[str]]:
    """For each buffer of the heap, those that use some of the same bytes at other times."""
    found: dict[str, list[str]] = {name: [] for name in plan.buffer_of}
    open_: list[tuple[int, str]] = []  # end and name of those that reach beyond the current offset
    for name in sorted(plan.buffer_of, key=lambda n: (plan.buffer_of[n].offset, n)):
        place = plan.buffer_of[name]
        open_ = [(end, other) for end, other in open_ if end > place.offset]
        for _, other in open_:
            found[name].append(other)
            found[other].append(name)
        open_.append((place.offset + place.bytes, name))
    return found


def _barrier(plan: Plan, barrier: Barrier, reasons: Mapping[tuple[str, str], Decision]) -> dict[str, Any]:
    before = plan.order[barrier.index].name
    calls = [name for bit, name in BARRIER_BITS.items() if barrier.bits & bit]
    kinds = list(dict.fromkeys(hazard.kind for hazard in barrier.hazards))
    return {
        "before": before,
        "index": barrier.index,
        "bits": barrier.bits,
        "names": calls,
        "texture_barrier": barrier.texture_barrier,
        "reasons": [
            {"kind": kind, "reason": reasons[before, kind].reason, "why": explain_decision(reasons[before, kind])}
            for kind in kinds
        ],
        "hazards": [asdict(hazard) for hazard in barrier.hazards],
    }


def _desc(desc: TextureDesc | BufferDesc) -> dict[str, Any]:
    if isinstance(desc, BufferDesc):
        return {"buffer": desc.bytes}
    return {
        "format": desc.format,
        "size": [desc.width, desc.height],
        "layers": desc.layers,
        "mips": desc.mips,
        "samples": desc.samples,
        "target": desc.target.value,
    }


def _decision(decision: Decision) -> dict[str, Any]:
    evidence = {
        key: list(value) if isinstance(value, (tuple, set, frozenset)) else value
        for key, value in decision.evidence.items()
    }
    return {"kind": decision.kind, "reason": decision.reason, "subject": decision.subject, "evidence": evidence}
