"""Outputs that `resources:` does not declare: frame-sized textures whose format follows from who writes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rendergraph.node.contract import Node
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import BufferDesc, Decision, Frame, TextureDesc


def undeclared_outputs(
    findings: Findings, frame: Frame, nodes: Mapping[str, Node[Any]], decisions: list[Decision]
) -> dict[str, TextureDesc | BufferDesc]:
    """Descriptions by name.

    The format is the output entry's, else the first of the writing port, else (open ports) one that fits the file:
    rgba8 for .png, rgba16f for the others.
    """
    model = findings.document.model
    writers = _writers(findings, nodes)
    found: dict[str, TextureDesc | BufferDesc] = {}
    for name in sorted(model.outputs):
        if name in model.resources or "." in name:
            continue
        format, origin = model.outputs[name].format, "its output entry"
        if format is None and name in writers:
            format, origin = writers[name]
        if format is None:
            format, origin = (
                "rgba8" if model.outputs[name].file.lower().endswith(".png") else "rgba16f",
                "its file's suffix",
            )
        found[name] = TextureDesc(format, frame.width, frame.height)
        decisions.append(Decision("expand", "output_undeclared", name, {"format": format, "from": origin}))
    return found


def _writers(findings: Findings, nodes: Mapping[str, Node[Any]]) -> dict[str, tuple[str, str]]:
    """(first format, pass.port) of the port that makes each resource: one that replaces, before ones that modify."""
    best: dict[str, tuple[bool, str, str]] = {}
    for name, node in nodes.items():
        for port, resource in findings.document.model.passes[name].write.items():
            declared = node.outputs.get(port)
            if declared is not None and declared.formats:
                candidate = (declared.modify, f"port {name}.{port}", declared.formats[0])
                best[resource] = min(best.get(resource, candidate), candidate)
    return {resource: (format, port) for resource, (_, port, format) in best.items()}
