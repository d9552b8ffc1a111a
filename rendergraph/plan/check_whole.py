"""Checks over the whole graph: files that parameters name, unused resources, outputs, and the author's barriers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rendergraph.document.suggest import did_you_mean
from rendergraph.node.params import Params
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import BarrierIntent, BufferDesc, Kind, Pass, Resource, TextureDesc
from rendergraph.plan.graph_files import file_problem, named_files


def check_files(name: str, params: Params, known: dict[str, str | None], findings: Findings) -> None:
    """Report parameters of pass ``name`` that name a file outside the graph's folder, or none.

    ``known`` remembers what is wrong with each file (``None``: nothing), as passes share shaders.
    """
    for field, file in named_files(params):
        if file not in known:
            known[file] = file_problem(findings.folder, file)
        problem = known[file]
        if problem is None:
            continue
        values: dict[str, Any] = {
            "name": name,
            "field": field,
            "file": file,
            "problem": problem,
            "folder": findings.folder,
        }
        findings.add("RG222", "passes", name, "set", field, **values)


def check_use(findings: Findings, resources: Mapping[str, Resource | None]) -> set[str]:
    """Resources that a pass or output touches, directly or as another's history; warns of those nothing refers to."""
    model = findings.document.model
    written = {name for p in model.passes.values() for name in p.write.values()}
    used = {name for p in model.passes.values() for name in p.read.values()} | written | set(model.outputs)
    for name in sorted(used):
        found = resources.get(name)
        source = found.previous_of if found else None
        if source is not None:
            used.add(source)
            if source not in written:
                findings.add("RG223", "resources", name, "previous", resource=name, source=source)
    referred = {r.like for r in model.resources.values()}
    for name in model.resources:
        if name not in used and name not in referred:
            findings.add("RG214", "resources", name, key=True, resource=name)
    return used


def check_outputs(
    findings: Findings,
    resources: Mapping[str, Resource | None],
    internal: Mapping[str, Resource],
    passes: Mapping[str, Pass],
) -> None:
    """Report outputs that nobody writes, or that cannot become the file they name."""
    model = findings.document.model
    written = {name for p in model.passes.values() for name in p.write.values()}
    for name in sorted(model.outputs):
        owner = name.partition(".")[0]
        found = resources.get(name) or internal.get(name)
        if found is None:
            if owner in passes and name not in resources:
                hint = did_you_mean(name, [n for n in internal if n.startswith(f"{owner}.")])
                findings.add("RG220", "outputs", name, key=True, resource=name, owner=owner, hint=hint)
            elif name not in resources and owner not in model.passes:
                hint = did_you_mean(owner, model.passes)
                findings.add("RG213", "outputs", name, key=True, resource=name, hint=hint)
            continue  # otherwise it is wrong, and reported where it is wrong
        if found.declared and found.kind in (Kind.TRANSIENT, Kind.PERSISTENT) and name not in written:
            findings.add("RG213", "outputs", name, key=True, resource=name, hint=did_you_mean(name, written))
        _check_output_desc(findings, name, found)


def _check_output_desc(findings: Findings, name: str, found: Resource) -> None:
    model, desc = findings.document.model.outputs[name], found.desc
    problem, hint = "", ""
    if isinstance(desc, BufferDesc):
        if not model.file.lower().endswith(".npy"):
            problem, hint = "a buffer is no image", "write it as .npy"
    elif desc.samples > 1:
        problem, hint = "it is multisampled", "resolve it with a copy pass (blit: true) into another resource"
    if not problem and model.format is not None and isinstance(desc, TextureDesc) and model.format != desc.format:
        problem, hint = f"it is declared as {desc.format}", "give the format under resources: only"
    if problem:
        findings.add("RG330", "outputs", name, key=True, resource=name, problem=problem, hint=hint)


def barrier_intents(
    findings: Findings, resources: Mapping[str, Resource | None], passes: Mapping[str, Pass]
) -> tuple[BarrierIntent, ...] | None:
    """The author's barriers, names checked. ``None`` when the file has no ``barriers:``."""
    model = findings.document.model
    if model.barriers is None:
        return None
    steps = {s.name for p in passes.values() for s in p.subpasses} | set(model.passes)
    found: list[BarrierIntent] = []
    for index, barrier in enumerate(model.barriers):
        for key, what, name, known in (
            ("resource", "resource", barrier.resource, resources.keys()),
            ("after", "pass or sub-pass", barrier.after, steps),
            ("before", "pass or sub-pass", barrier.before, steps),
        ):
            owner = name.partition(".")[0]
            if name not in known and not (owner in model.passes and owner not in passes):
                findings.add("RG219", "barriers", index, key, what=what, name=name, hint=did_you_mean(name, known))
        at = findings.document.position("barriers", index)
        found.append(BarrierIntent(barrier.resource, barrier.after, barrier.before, barrier.kind, at))
    return tuple(found)
