"""Every node as data: ports, parameters with unit, range, default and help. What `rg nodes` and the docs print."""

from __future__ import annotations

import difflib
from typing import Any

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.contract import Node, Port
from rendergraph.node.discovery import find_node, node_names


def describe_nodes() -> list[dict[str, Any]]:
    """All nodes, by name."""
    return [_describe(find_node(name)) for name in node_names()]


def describe_node(name: str) -> dict[str, Any]:
    """One node. Raises RenderGraphError RG570 for an unknown name."""
    try:
        return _describe(find_node(name))
    except KeyError:
        near = difflib.get_close_matches(name, node_names(), 1)
        hint = f"did you mean '{near[0]}'?" if near else "`rg nodes` lists them"
        raise RenderGraphError([diagnose("RG570", name=name, hint=hint)], exit_code=2) from None


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
