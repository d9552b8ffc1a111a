"""Document to graph: resources are resolved, connections checked, and nodes add their sub-passes. Runs without GL."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Mapping
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.document.models import MAX_FRAMES, MAX_SIZE
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.node.discovery import find_node
from rendergraph.plan.check_ports import Connections, check_ports
from rendergraph.plan.check_subpasses import NodeError, check_subpasses
from rendergraph.plan.check_whole import barrier_intents, check_files, check_outputs, check_use
from rendergraph.plan.findings import Findings, SourceDocument
from rendergraph.plan.graph import Decision, Frame, Graph, Kind, Pass, Resource
from rendergraph.plan.output_formats import undeclared_outputs
from rendergraph.plan.resolve_resources import ResourceResolver
from rendergraph.scene.features import SceneFeatures

#: What validation assumes of a scene it has not loaded: everything, so that no part of a node stays unchecked.
ANY_SCENE = SceneFeatures(
    point_lights=64, spot_lights=64, triangles=1 << 20, draws=1024, materials=64, texture_arrays=1
).full()


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
    passes in the file. Raises ``RenderGraphError`` with all errors at once (RG21x-RG22x, RG3xx).
    """
    findings = Findings(document)
    frame = _frame(findings, size, frames)
    if features is None:
        features = ANY_SCENE if document.model.scene is not None else SceneFeatures()
        has_scene = document.model.scene is not None
    else:
        has_scene = True
    nodes = {name: _node(name, findings) for name in sorted(document.model.passes)}
    expansion = _Expansion(findings, frame, features, full, has_scene, nodes)
    graph = expansion.run()
    if findings.errors:
        raise RenderGraphError(sorted(findings.errors, key=_place)) from expansion.cause
    return graph, tuple(sorted(findings.notes, key=_place))


def _place(found: Diagnostic) -> tuple[int, int, str]:
    return (found.position.line, found.position.column, found.code) if found.position else (0, 0, found.code)


def _frame(findings: Findings, size: tuple[int, int] | None, frames: int | None) -> Frame:
    model = findings.document.model.frame
    for what, value, limit in (
        ("width", size[0] if size else 1, MAX_SIZE),
        ("height", size[1] if size else 1, MAX_SIZE),
        ("number of frames", 1 if frames is None else frames, MAX_FRAMES),
    ):
        if not 1 <= value <= limit:
            findings.add("RG226", "frame", what=what, value=value, limit=limit)
    if findings.errors:  # nothing can be sized
        raise RenderGraphError(findings.errors, exit_code=2)
    width, height = size or model.size
    return Frame(width, height, model.count if frames is None else frames, model.seed, model.depth)


def _node(name: str, findings: Findings) -> Node[Any] | None:
    document = findings.document
    try:
        return find_node(document.model.passes[name].node)(document.params[name])
    except Exception as error:
        _internal_error(name, error, findings)
        return None


def _internal_error(name: str, error: Exception, findings: Findings) -> None:
    frames = traceback.extract_tb(error.__traceback__)
    where = (
        f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})"
        if frames and not isinstance(error, NodeError)
        else ""
    )
    reason = str(error) if isinstance(error, NodeError) else f"{type(error).__name__}: {error}{where}"
    node = findings.document.model.passes[name].node
    findings.add("RG229", "passes", name, "node", node=node, name=name, reason=reason)


class _Expansion:
    """One call of :func:`expand`."""

    def __init__(
        self,
        findings: Findings,
        frame: Frame,
        features: SceneFeatures,
        full: bool,
        has_scene: bool,
        nodes: Mapping[str, Node[Any] | None],
    ) -> None:
        self.findings, self.frame, self.features, self.full, self.has_scene = findings, frame, features, full, has_scene
        self.nodes = nodes
        self.document = findings.document
        self.folder = self.document.path.resolve().parent
        self.resources: dict[str, Resource | None] = {}  # declared ones, and outputs; None: wrong and reported
        self.internal: dict[str, dict[str, Resource]] = {}  # by pass, once built
        self.passes: dict[str, Pass] = {}
        self.decisions: list[Decision] = []
        self.cause: Exception | None = None  # of the first internal error, for its traceback

    def run(self) -> Graph:
        model = self.document.model
        undeclared = undeclared_outputs(self.findings, self.frame, self.nodes, self.decisions)
        self.resources = ResourceResolver(self.findings, self.frame, undeclared).run()
        self._settle_kinds()
        for name in self._build_order():
            self._expand_pass(name)
        used = check_use(self.findings, self.resources)
        resources = {name: found for name, found in self.resources.items() if found is not None and name in used}
        for internal in self.internal.values():
            resources.update(internal)
        for name in check_outputs(self.findings, self.resources, self.internal, self.passes):
            if resources[name].kind is Kind.TRANSIENT:
                resources[name] = replace(resources[name], kind=Kind.PERSISTENT)
                self.decisions.append(Decision("expand", "kept_for_output", name))
        barriers = barrier_intents(self.findings, {**self.resources, **resources}, self.passes)
        return Graph(
            self.frame,
            dict(sorted(resources.items())),
            dict(sorted(self.passes.items())),
            tuple(sorted(model.outputs)),
            barriers,
            self.features,
            tuple(sorted(self.decisions, key=lambda d: (d.kind, d.subject, d.reason, str(d.evidence)))),
        )

    def _settle_kinds(self) -> None:
        """What a connected history reads is kept across frames."""
        model = self.document.model
        connected = {name for p in model.passes.values() for name in p.read.values()} | set(model.outputs)
        for name in sorted(connected):
            history = self.resources.get(name)
            source = self.resources.get(history.previous_of) if history and history.previous_of else None
            if source is not None and source.kind is Kind.TRANSIENT:
                self.resources[source.name] = replace(source, kind=Kind.PERSISTENT)
                self.decisions.append(Decision("expand", "kept_for_history", source.name, {"history": name}))

    def _build_order(self) -> Iterable[str]:
        """By name, but a pass that reads another's internal target comes after that one."""
        passes = self.document.model.passes
        waits = {
            name: {owner for owner in map(_owner, passes[name].read.values()) if owner in passes}
            for name in sorted(passes)
        }
        try:
            return tuple(TopologicalSorter(waits).static_order())
        except CycleError as error:
            circle = error.args[1][::-1]
            self.findings.add("RG221", "passes", circle[0], "read", cycle=" -> ".join(circle))
            return ()

    # ---- one pass

    def _expand_pass(self, name: str) -> None:
        node, model = self.nodes[name], self.document.model.passes[name]
        if node is None:
            return
        fine = check_files(name, node.params, self.folder, self.findings)
        fine &= self._check_after(name)
        inputs = {port: self._find(name, "read", port, r) for port, r in model.read.items()}
        outputs = {port: self._find(name, "write", port, r) for port, r in model.write.items()}
        found = Connections(
            {port: r for port, r in inputs.items() if r is not None},
            {port: r for port, r in outputs.items() if r is not None},
        )
        fine &= len(found.inputs) + len(found.outputs) == len(inputs) + len(outputs)
        fine &= check_ports(name, node, found, self.findings)
        if node.needs_scene and not self.has_scene:
            self.findings.add("RG224", "passes", name, "node", name=name, node=node.name)
            fine = False
        if fine:
            self._build(name, node, found)

    def _build(self, name: str, node: Node[Any], found: Connections) -> None:
        model, at = self.document.model.passes[name], self.document.position("passes", name, key=True)
        builder = Builder(
            name, node.folder, self.folder, self.frame, self.features, self.full, found.inputs, found.outputs, at
        )  # fmt: skip
        try:
            node.build(builder)
            fine = check_subpasses(name, node, builder, self.has_scene, self.findings)
        except RenderGraphError as error:  # the node found a mistake of the user's
            self.findings.errors.extend(error.diagnostics)
            return
        except Exception as error:
            self.cause = self.cause or error
            _internal_error(name, error, self.findings)
            return
        if fine:
            self.internal[name] = builder.resources
            self.passes[name] = Pass(name, node.name, tuple(builder.subpasses), model.after, model.keep, at)
            self.decisions += builder.decisions
            evidence = {"node": node.name, "steps": tuple(s.name for s in builder.subpasses)}
            self.decisions.append(Decision("expand", "node_expanded", name, evidence))

    def _find(self, name: str, section: str, port: str, resource: str) -> Resource | None:
        """The resource connected to a port, or ``None`` after reporting why there is none."""
        if resource in self.resources:
            return self.resources[resource]
        owner, loc = _owner(resource), ("passes", name, section, port)
        if owner is None:
            known = set(self.resources)
            self.findings.add("RG212", *loc, resource=resource, hint=did_you_mean(resource, known))
        elif owner not in self.document.model.passes:
            self.findings.add("RG212", *loc, resource=resource, hint=did_you_mean(owner, self.document.model.passes))
        elif section == "write":
            hint = "declare a resource and write that one"
            self.findings.add("RG220", *loc, resource=resource, owner=owner, hint=hint)
        elif owner in self.internal:  # else it has mistakes of its own, reported already
            targets = self.internal[owner]
            if resource in targets:
                return targets[resource]
            self.findings.add("RG220", *loc, resource=resource, owner=owner, hint=did_you_mean(resource, targets))
        return None

    def _check_after(self, name: str) -> bool:
        passes, before = self.document.model.passes, len(self.findings.errors)
        for index, other in enumerate(passes[name].after):
            if other == name:
                problem, hint = "which is itself", "remove it"
            elif other not in passes:
                problem, hint = "which does not exist", did_you_mean(other, passes)
            else:
                continue
            self.findings.add(
                "RG218", "passes", name, "after", index, name=name, other=other, problem=problem, hint=hint
            )
        return len(self.findings.errors) == before


def _owner(resource: str) -> str | None:
    """The pass whose internal target this names, ``None`` for a plain name."""
    owner, dot, _ = resource.partition(".")
    return owner if dot else None
