"""What flows from sub-pass to sub-pass, and which must run before which.

Each cell's touches are walked once, writer by writer, in linear time: first for the flow of content, from which
culling starts; then, for what is left, for read after write, write after read and write after write. Loads of content
that nobody made are errors here.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.plan.graph import Decision
from rendergraph.plan.index import LOADS, PRESET, WRITES, Index
from rendergraph.plan.precedence import Touch, find_precedence


@dataclass(slots=True)
class Flow:
    """Per sub-pass: ``sources`` made content it loads (one may be listed twice); ``replaced_by`` overwrote some of its
    content before anybody read it. ``final``: per cell, its last writer or -1. ``sequence``: per cell, its touches in
    order. ``order``: one legal order of all sub-passes, grouped by pass.
    """

    sources: list[list[int]]
    replaced_by: dict[int, list[int]]
    final: list[int]
    sequence: list[list[Touch]]
    order: list[int]
    decisions: list[Decision]


def find_flow(index: Index) -> Flow:
    """Follow content from writer to reader. Raises ``RenderGraphError`` with every mistake found."""
    precedence = find_precedence(index)
    sources: list[list[int]] = [[] for _ in index.subpasses]
    replaced_by: dict[int, list[int]] = {}
    final: list[int] = []
    blank: dict[tuple[int, int], int] = {}  # (sub-pass, resource) -> cells it loads that hold nothing yet
    for cell, touches in enumerate(precedence.sequence):
        writer = -1
        fresh = False  # whether nobody has read the writer's content yet
        for subpass, flags in touches:
            if flags & LOADS:
                fresh = False
                if writer >= 0:
                    sources[subpass].append(writer)
                else:
                    key = subpass, index.resource_of[cell]
                    blank[key] = blank.get(key, 0) + 1
            if flags & WRITES:
                if fresh:
                    replaced_by.setdefault(writer, []).append(subpass)
                writer, fresh = subpass, True
        final.append(writer)
    errors = [*precedence.errors, *_undefined_loads(index, blank), *_unwritten(index)]
    if errors:
        raise RenderGraphError(errors)
    order = [subpass for p in precedence.passes for subpass in index.steps[p]]
    return Flow(sources, replaced_by, final, precedence.sequence, order, precedence.decisions)


def find_needs(index: Index, flow: Flow, live: list[bool]) -> list[list[int]]:
    """Per live sub-pass, the live ones that must run before it, for whatever reason. One may be listed twice.

    Found after culling: two accesses that only a culled writer kept apart must be bound directly.
    """
    needs: list[list[int]] = [[] for _ in live]
    for touches in flow.sequence:
        writer = -1
        readers: list[int] = []
        for subpass, flags in touches:
            if not live[subpass]:
                continue
            if writer >= 0 and (flags & LOADS or not readers):
                needs[subpass].append(writer)
            if flags & WRITES:
                needs[subpass] += readers
                writer, readers = subpass, []
            else:
                readers.append(subpass)
    number = {found.name: i for i, found in enumerate(index.passes)}
    for p, found in enumerate(index.passes):
        for name in found.after:
            if name in number:  # every sub-pass of the one behind every sub-pass of the other
                earlier = [s for s in index.steps[number[name]] if live[s]]
                for subpass in index.steps[p]:
                    needs[subpass] += earlier
    return needs


def _undefined_loads(index: Index, blank: dict[tuple[int, int], int]) -> list[Diagnostic]:
    """An error for each load of which *no* cell was ever written. A load that is defined in part is let through: a
    mip chain is often filled level by level and bound whole.
    """
    errors: list[Diagnostic] = []
    told: set[tuple[int, int]] = set()
    loaded: dict[int, Counter[int]] = {}  # resource -> sub-pass -> cells that it loads
    writers: dict[int, set[int]] = {}
    for (subpass, number), cells in sorted(blank.items()):
        resource, owner = index.resources[number], index.pass_of[subpass]
        if resource.kind in PRESET or (owner, number) in told:
            continue
        if number not in loaded:
            touches = [touch for cell in index.cells_of[resource.name] for touch in index.touches[cell]]
            loaded[number] = Counter(s for s, flags in touches if flags & LOADS)
            writers[number] = {s for s, flags in touches if flags & WRITES}
        if cells < loaded[number][subpass]:
            continue
        told.add((owner, number))
        if not writers[number]:
            code = "RG231"
        else:
            code = "RG232" if subpass in writers[number] else "RG237"
        found = index.passes[owner]
        errors.append(diagnose(code, found.position, resource=resource.name, name=found.name))
    return errors


def _unwritten(index: Index) -> list[Diagnostic]:
    """Outputs and history sources that nothing writes, and writes to what is only to be read."""
    errors: list[Diagnostic] = []

    def writers(name: str) -> list[int]:
        return [s for cell in index.cells_of[name] for s, flags in index.touches[cell] if flags & WRITES]

    for name in sorted(index.graph.outputs):
        if index.graph.resources[name].kind not in PRESET and not writers(name):
            errors.append(diagnose("RG234", index.graph.resources[name].position, resource=name))
    for resource in index.resources:
        if resource.kind not in PRESET:
            continue
        source = resource.previous_of
        if source is not None and index.graph.resources[source].kind not in PRESET and not writers(source):
            errors.append(diagnose("RG235", resource.position, resource=resource.name, source=source))
        if found := writers(resource.name):
            writer = index.passes[index.pass_of[min(found)]]
            data = {"resource": resource.name, "name": writer.name, "kind": resource.kind.value}
            errors.append(diagnose("RG236", writer.position, **data))
    return errors
