"""Formats that nodes declared wide enough: what a scene leaves empty need not be stored at full width."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rendergraph.plan.graph import Decision, Kind, Pass, Resource, TextureDesc, Usage

#: Uses that do not hang on the exact format: attachments and clears convert, samplers give floats.
_FREE = frozenset({Usage.SAMPLED, Usage.COLOR, Usage.DEPTH, Usage.CLEAR})


def narrow_formats(
    resources: Mapping[str, Resource],
    passes: Mapping[str, Pass],
    narrowed: Mapping[str, Mapping[str, str]],
    decisions: list[Decision],
) -> dict[str, Resource]:
    """The resources that get a narrower format, each with its decision.

    Only transient ones: outputs are files of a format the author chose, and histories may outlive the scene they were
    narrowed for.
    """
    found: dict[str, Resource] = {}
    if not narrowed:
        return found
    histories = {resource.previous_of for resource in resources.values()}
    uses: dict[str, set[tuple[str, bool, Usage]]] = {}
    for entry in passes.values():
        for step in entry.subpasses:
            for access in step.accesses:
                uses.setdefault(access.resource, set()).add((entry.name, access.usage.writes, access.usage))
    for owner, formats in narrowed.items():
        for name, format in formats.items():
            resource = resources.get(name)
            if resource is None or resource.kind is not Kind.TRANSIENT or name in histories:
                continue
            desc = resource.desc
            used = uses.get(name, set())
            alone = all(by == owner for by, writes, _ in used if writes)
            read = any(not writes for _, writes, _ in used)  # else it will be culled
            if not (isinstance(desc, TextureDesc) and alone and read and _FREE.issuperset(u for _, _, u in used)):
                continue
            narrow = replace(desc, format=format)
            if narrow.bytes < desc.bytes:
                found[name] = replace(resource, desc=narrow)
                evidence = {"from": desc.format, "to": format, "by": owner, "saved": desc.bytes - narrow.bytes}
                decisions.append(Decision("specialise", "format_narrowed", name, evidence))
    return found
