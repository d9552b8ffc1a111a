"""Passes of the document to passes of the graph: connect resources, let the node add its sub-passes, check them."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

from rendergraph.document.messages import RenderGraphError
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.node.discovery import find_node
from rendergraph.plan.check_ports import Connections, check_ports
from rendergraph.plan.check_subpasses import NodeError, check_subpasses
from rendergraph.plan.check_whole import check_files
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import Decision, Frame, Kind, Pass, Resource
from rendergraph.scene.features import SceneFeatures

#: What a node is told of the scene in a graph that has none.
NO_SCENE = SceneFeatures()


@dataclass
class PassBuilder:
    """Builds every pass of one document. ``features`` is ``None`` where the graph has no scene."""

    findings: Findings
    frame: Frame
    features: SceneFeatures | None
    full: bool
    decisions: list[Decision] = field(default_factory=list)
    resources: Mapping[str, Resource | None] = field(default_factory=dict)  # None: wrong, and reported
    nodes: Mapping[str, Node[Any]] = field(default_factory=dict)
    internal: dict[str, dict[str, Resource]] = field(default_factory=dict)  # nodes' own targets, by pass
    passes: dict[str, Pass] = field(default_factory=dict)
    files: dict[str, str | None] = field(default_factory=dict)  # what is wrong with each file named
    narrowed: dict[str, dict[str, str]] = field(default_factory=dict)  # by pass: its outputs that fit a narrower format
    said: Mapping[str, set[str]] = field(default_factory=dict)  # what each resource's writers say that it holds
    cause: Exception | None = None  # of the first internal error: its traceback is for the node's author

    def make_nodes(self) -> dict[str, Node[Any]]:
        """Each pass's node with its parameters."""
        document, nodes = self.findings.document, {}
        for name in sorted(document.model.passes):
            try:
                nodes[name] = find_node(document.model.passes[name].node)(document.params[name])
            except Exception as error:
                self._internal_error(name, error)
        return nodes

    def _held(self, resource: Resource) -> str:
        """What a resource is sure to hold: the one word that all of its writers' ports agree on."""
        if resource.kind not in (Kind.TRANSIENT, Kind.PERSISTENT):
            return ""
        said = self.said.get(resource.name, set())
        return next(iter(said)) if len(said) == 1 else ""

    def _all_said(self) -> dict[str, set[str]]:
        """What the port of each writer of each resource says that it holds."""
        said: dict[str, set[str]] = {}
        for name, node in self.nodes.items():
            for port, written in self.findings.document.model.passes[name].write.items():
                said.setdefault(written, set()).add(node.outputs[port].holds if port in node.outputs else "")
        return said

    def run(self, nodes: Mapping[str, Node[Any]], resources: Mapping[str, Resource | None]) -> None:
        """Fill ``passes`` and ``internal`` with all that can be built; mistakes go to the findings."""
        self.resources, self.nodes = resources, nodes
        self.said = self._all_said()
        for name in self._build_order():
            if name in nodes:
                self._expand_pass(name, nodes[name])

    def _build_order(self) -> Iterable[str]:
        """By name, but a pass that reads another's internal target comes after that one."""
        passes = self.findings.document.model.passes
        waits = {name: _owners(passes[name].read.values()) & passes.keys() for name in sorted(passes)}
        try:
            return tuple(TopologicalSorter(waits).static_order())
        except CycleError as error:
            circle = error.args[1][::-1]
            self.findings.add("RG221", "passes", circle[0], "read", cycle=" -> ".join(circle))
            return ()

    # ---- one pass

    def _expand_pass(self, name: str, node: Node[Any]) -> None:
        model, findings = self.findings.document.model.passes[name], self.findings
        before = len(findings.errors)
        check_files(name, node.params, self.files, findings)
        self._check_after(name)
        found = Connections(self._connect(name, "read", model.read), self._connect(name, "write", model.write))
        check_ports(name, node, found, findings)
        if node.needs_scene and self.features is None:
            findings.add("RG224", "passes", name, "node", name=name, node=node.name)
        complete = len(found.inputs) == len(model.read) and len(found.outputs) == len(model.write)
        if complete and len(findings.errors) == before:
            self._build(name, node, found)

    def _build(self, name: str, node: Node[Any], found: Connections) -> None:
        document = self.findings.document
        model, at, before = (
            document.model.passes[name],
            document.position("passes", name, key=True),
            len(self.findings.errors),
        )
        features, folder = self.features or NO_SCENE, self.findings.folder
        builder = Builder(
            name, node.folder, folder, self.frame, features, self.full, found.inputs, found.outputs, at,
            {port: self._held(resource) for port, resource in found.inputs.items()},
        )  # fmt: skip
        try:
            node.build(builder)
            check_subpasses(name, node, builder, self.features is not None, self.findings)
        except RenderGraphError as error:  # the node found a mistake of the user's
            self.findings.errors.extend(error.diagnostics)
        except Exception as error:
            self._internal_error(name, error)
        if len(self.findings.errors) == before:
            self.internal[name] = builder.resources
            self.passes[name] = Pass(name, node.name, tuple(builder.subpasses), model.after, model.keep, at)
            self.decisions += builder.decisions
            self.narrowed[name] = builder.narrowed
            if not builder.subpasses:
                because = sorted({f"{d.reason} {d.evidence.get('feature', '')}".strip() for d in builder.decisions})
                self.decisions.append(Decision("specialise", "pass_left_out", name, {"because": because}))
            evidence = {"node": node.name, "steps": tuple(s.name for s in builder.subpasses)}
            self.decisions.append(Decision("expand", "node_expanded", name, evidence))

    def _connect(self, name: str, section: str, ports: Mapping[str, str]) -> dict[str, Resource]:
        """Port to resource, of those that exist."""
        connected: dict[str, Resource] = {}
        for port, resource in ports.items():
            found = self._find(name, section, port, resource)
            if found is not None:
                connected[port] = found
        return connected

    def _find(self, name: str, section: str, port: str, resource: str) -> Resource | None:
        """The resource connected to a port, or ``None`` after reporting why there is none."""
        if resource in self.resources:
            return self.resources[resource]
        passes, loc = self.findings.document.model.passes, ("passes", name, section, port)
        owner, dot, _ = resource.partition(".")
        if not dot:
            self.findings.add("RG212", *loc, resource=resource, hint=self.findings.suggest(resource, self.resources))
        elif owner not in passes:
            self.findings.add("RG212", *loc, resource=resource, hint=self.findings.suggest(owner, passes))
        elif section == "write":
            hint = "declare a resource and write that one"
            self.findings.add("RG220", *loc, resource=resource, owner=owner, hint=hint)
        elif owner in self.internal:  # else it has mistakes of its own, reported already
            targets = self.internal[owner]
            if resource in targets:
                return targets[resource]
            self.findings.add(
                "RG220", *loc, resource=resource, owner=owner, hint=self.findings.suggest(resource, targets)
            )
        return None

    def _check_after(self, name: str) -> None:
        passes = self.findings.document.model.passes
        for index, other in enumerate(passes[name].after):
            if other == name:
                problem, hint = "which is itself", "remove it"
            elif other not in passes:
                problem, hint = "which does not exist", self.findings.suggest(other, passes)
            else:
                continue
            self.findings.add(
                "RG218", "passes", name, "after", index, name=name, other=other, problem=problem, hint=hint
            )

    def _internal_error(self, name: str, error: Exception) -> None:
        self.cause = self.cause or error
        reason = str(error)
        if not isinstance(error, NodeError):
            last = traceback.extract_tb(error.__traceback__)[-1]
            reason = f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"
        node = self.findings.document.model.passes[name].node
        self.findings.add("RG229", "passes", name, "node", node=node, name=name, reason=reason)


def _owners(resources: Iterable[str]) -> set[str]:
    """The passes whose internal targets are named."""
    return {name.partition(".")[0] for name in resources if "." in name}
