"""``resources.json``: where every resource lives, when, beside whom, and the barriers; exact, so compared exactly."""

from __future__ import annotations

from typing import Any

import rendergraph
from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import BufferDesc, Decision, TextureDesc
from rendergraph.plan.plan import Plan

SCHEMA = "rendergraph.resources/1"


def resources_record(plan: Plan, title: str = "") -> dict[str, Any]:
    """The record as JSON-ready data. Bytes are those GL was asked for, without the driver's padding."""
    totals = plan.totals
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
        "resources": [_resource(plan, name) for name in sorted(plan.lifetimes)],
        "slots": [
            {"index": index, "desc": _desc(slot.desc), "bytes": slot.desc.bytes, "tenants": list(slot.tenants)}
            for index, slot in enumerate(plan.slots)
        ],
        "heap_bytes": plan.heap_bytes,
        "barriers": [
            {
                "before": plan.order[barrier.index].name,
                "bits": barrier.bits,
                "texture_barrier": barrier.texture_barrier,
                "hazards": [
                    {
                        "resource": h.resource,
                        "previous_resource": h.previous_resource,
                        "earlier": h.earlier,
                        "later": h.later,
                        "kind": h.kind,
                    }
                    for h in barrier.hazards
                ],
            }
            for barrier in plan.barriers
        ],
        "decisions": [_decision(d) for d in plan.decisions],
    }


def _resource(plan: Plan, name: str) -> dict[str, Any]:
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
    }
    if name in plan.slot_of:
        index = plan.slot_of[name]
        entry["slot"] = index
        entry["shares_with"] = [t for t in plan.slots[index].tenants if t != name]
    if name in plan.buffer_of:
        entry["offset"] = plan.buffer_of[name].offset
    if isinstance(resource.desc, TextureDesc):
        entry["view_class"] = FORMATS[resource.desc.format].view_class
    return entry


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
