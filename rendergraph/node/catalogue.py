"""Every node as data: ports, parameters with unit, range, default and help. What `rg nodes` and the docs print."""

from __future__ import annotations

import difflib
from typing import Any

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.node.contract import Node, Port
from rendergraph.node.discovery import node_names, try_node


def describe_nodes() -> tuple[list[dict[str, Any]], list[Diagnostic]]:
    """All nodes by name, and RG207 for each whose package cannot be imported."""
    described: list[dict[str, Any]] = []
    broken: list[Diagnostic] = []
    for name in node_names():
        node = try_node(name)
        if isinstance(node, str):
            broken.append(diagnose("RG207", node=name, reason=node))
        else:
            described.append(_describe(node))
    return described, broken


def describe_node(name: str) -> dict[str, Any]:
    """One node. Raises RenderGraphError RG570 for an unknown name, RG207 for one that cannot be imported."""
    if name not in node_names():
        near = difflib.get_close_matches(name, node_names(), 1)
        hint = f"did you mean '{near[0]}'?" if near else "`rg nodes` lists them"
        raise RenderGraphError([diagnose("RG570", name=name, hint=hint)], exit_code=2)
    node = try_node(name)
    if isinstance(node, str):
        raise RenderGraphError([diagnose("RG207", node=name, reason=node)])
    return _describe(node)


def _describe(node: type[Node[Any]]) -> dict[str, Any]:
    schema = node.params_type.model_json_schema()
    return {
        "name": node.name,
        "summary": node.summary(),
        "needs_scene": node.needs_scene,
        "open_ports": node.open_ports,
        "inputs": {name: _port(port) for name, port in node.inputs.items()},
        "outputs": {name: _port(port) for name, port in node.outputs.items()},
        "parameters": {
            name: _parameter(name, entry, name in schema.get("required", ()))
            for name, entry in schema.get("properties", {}).items()
        },
    }


def _port(port: Port) -> dict[str, Any]:
    return {
        "help": port.help,
        "kind": "buffer" if port.buffer else "texture",
        "formats": list(port.formats),
        "optional": port.optional,
        "modify": port.modify,
        "like": port.like,
    }


def _parameter(name: str, entry: dict[str, Any], required: bool) -> dict[str, Any]:
    limits = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
    bounds: dict[str, Any] = {key: entry[key] for key in limits if key in entry}
    return {
        "help": entry.get("description", ""),
        "type": entry.get("type", "any of several"),
        "default": None if required else entry.get("default"),
        "required": required,
        "unit": entry.get("unit", ""),
        "accurate": entry.get("accurate"),
        "choices": entry.get("enum"),
        **bounds,
    }
