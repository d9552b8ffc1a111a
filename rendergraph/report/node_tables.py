"""Terminal tables of the node catalogue."""

from __future__ import annotations

from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text


def node_table(nodes: list[dict[str, Any]]) -> RenderableType:
    """One row a node."""
    table = Table(box=None, pad_edge=False)
    for heading in ("node", "inputs", "outputs", "what it does"):
        table.add_column(heading, overflow="fold")
    for node in nodes:
        ports = ("any", "any") if node["open_ports"] else (", ".join(node["inputs"]), ", ".join(node["outputs"]))
        table.add_row(node["name"], *ports, node["summary"])
    return table


def node_page(node: dict[str, Any]) -> RenderableType:
    """One node: summary, ports, parameters."""
    ports = Table(title="Ports", title_justify="left", box=None, pad_edge=False)
    for heading in ("port", "direction", "takes", "help"):
        ports.add_column(heading, overflow="fold")
    for direction in ("inputs", "outputs"):
        for name, port in node[direction].items():
            takes = port["kind"] if not port["formats"] else ", ".join(port["formats"])
            marks = " (optional)" if port["optional"] else ""
            way = "modifies" if port["modify"] else ("reads" if direction == "inputs" else "writes")
            ports.add_row(name, way + marks, takes, port["help"])
    parameters = Table(title="Parameters", title_justify="left", box=None, pad_edge=False)
    for heading in ("parameter", "default", "range", "unit", "help"):
        parameters.add_column(heading, overflow="fold")
    for name, entry in node["parameters"].items():
        default = "required" if entry["required"] else str(entry["default"])
        parameters.add_row(name, default, _range(entry), entry["unit"], entry["help"])
    return Group(Text(node["name"], style="bold"), Text(node["summary"]), Text(), ports, Text(), parameters)


def _range(entry: dict[str, Any]) -> str:
    if entry["choices"]:
        return " | ".join(map(str, entry["choices"]))
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    return ", ".join(f"{sign} {entry[key]:g}" for key, sign in signs.items() if key in entry)
