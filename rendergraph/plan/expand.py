"""Document to graph: resources are resolved, connections checked, and nodes add their sub-passes. Runs without GL."""

from __future__ import annotations

from dataclasses import replace

from rendergraph.document.collector import collector_paused
from rendergraph.document.field_types import MAX_SIZE
from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.document.models import MAX_FRAMES
from rendergraph.plan.build_passes import PassBuilder
from rendergraph.plan.check_whole import barrier_intents, check_outputs, check_use
from rendergraph.plan.findings import Findings, SourceDocument
from rendergraph.plan.graph import Decision, Frame, Graph, Kind, Resource
from rendergraph.plan.narrow_formats import narrow_formats
from rendergraph.plan.output_formats import undeclared_outputs
from rendergraph.plan.resolve_resources import ResourceResolver
from rendergraph.scene.features import SceneFeatures

#: What validation assumes of a scene it has not loaded: everything, so that no part of a node stays unchecked.
ANY_SCENE = SceneFeatures(
    point_lights=64, spot_lights=64, triangles=1 << 20, draws=1024, materials=64, texture_arrays=1
).full()


@collector_paused()
def expand(
    document: SourceDocument,
    *,
    features: SceneFeatures | None = None,
    full: bool = False,
    size: tuple[int, int] | None = None,
    frames: int | None = None,
) -> tuple[Graph, tuple[Diagnostic, ...]]:
    """The graph of a document, and warnings.

    ``features`` is what the loaded scene holds; without it everything is assumed. ``full`` switches specialisation off.
    ``size`` (width and height in pixels) and ``frames`` replace the file's. Content does not depend on the order of the
    passes in the file. Raises ``RenderGraphError`` with all errors at once (RG212 to RG229, RG3xx).
    """
    findings = Findings(document)
    frame = _frame(findings, size, frames)
    if features is None and document.model.scene is not None:
        features = ANY_SCENE
    builder = PassBuilder(findings, frame, features, full)
    nodes = builder.make_nodes()
    undeclared = undeclared_outputs(findings, frame, nodes, builder.decisions)
    resources = ResourceResolver(findings, frame, undeclared).run()
    _settle_kinds(findings, resources, builder.decisions)
    builder.run(nodes, resources)
    graph = _graph(findings, frame, builder)
    if findings.errors:
        raise RenderGraphError(sorted(findings.errors, key=_place)) from builder.cause
    return graph, tuple(sorted(findings.notes, key=_place))


def _place(found: Diagnostic) -> tuple[str, int, int, str]:
    at = found.position
    return (at.file, at.line, at.column, found.code) if at else ("", 0, 0, found.code)


def _frame(findings: Findings, size: tuple[int, int] | None, frames: int | None) -> Frame:
    model = findings.document.model.frame
    width, height = size or model.size
    count = model.count if frames is None else frames
    for what, value, limit in (("width", width, MAX_SIZE), ("height", height, MAX_SIZE), ("count", count, MAX_FRAMES)):
        if not 1 <= value <= limit:
            findings.add("RG226", "frame", what=what, value=value, limit=limit)
    if findings.errors:  # nothing can be sized
        raise RenderGraphError(findings.errors, exit_code=2)
    return Frame(width, height, count, model.seed, model.depth)


def _settle_kinds(findings: Findings, resources: dict[str, Resource | None], decisions: list[Decision]) -> None:
    """What a connected history reads, or an output shows, is kept to the end of the frame and beyond."""
    model = findings.document.model
    connected = {name for entry in model.passes.values() for name in entry.read.values()} | set(model.outputs)
    for name in sorted(connected):
        found = resources.get(name)
        source = resources.get(found.previous_of) if found and found.previous_of else None
        if source is not None:
            resources[source.name] = replace(source, kind=Kind.PERSISTENT)
            decisions.append(Decision("expand", "kept_for_history", source.name, {"history": name}))
    for name in sorted(model.outputs):
        found = resources.get(name)
        if found is not None and found.kind in (Kind.TRANSIENT, Kind.PERSISTENT):
            resources[name] = replace(found, kind=Kind.PERSISTENT)
            decisions.append(Decision("expand", "kept_for_output", name, {"file": model.outputs[name].file}))


def _graph(findings: Findings, frame: Frame, builder: PassBuilder) -> Graph:
    """Everything put together, by name: nothing depends on the order of the file."""
    model = findings.document.model
    internal = {name: found for targets in builder.internal.values() for name, found in targets.items()}
    for name in sorted(internal.keys() & model.outputs.keys()):
        internal[name] = replace(internal[name], kind=Kind.PERSISTENT)
        builder.decisions.append(Decision("expand", "kept_for_output", name, {"file": model.outputs[name].file}))
    used = check_use(findings, builder.resources)
    resources = internal | {name: r for name, r in builder.resources.items() if r is not None and name in used}
    check_outputs(findings, builder.resources, internal, builder.passes)
    resources |= narrow_formats(resources, builder.passes, builder.narrowed, builder.decisions)
    return Graph(
        frame,
        dict(sorted(resources.items())),
        dict(sorted(builder.passes.items())),
        tuple(sorted(model.outputs)),
        barrier_intents(findings, {**builder.resources, **internal}, builder.passes),
        builder.features,
        tuple(sorted(builder.decisions, key=lambda d: (d.kind, d.subject, d.reason))),
    )
