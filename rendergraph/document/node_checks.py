"""Checks every pass against its node: the node exists, its ports are connected, its parameters are valid.

Works on the plain data of the file, so that these mistakes are reported together with all others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.document.model_errors import MAX_MISTAKES, Mistake, validate_strictly
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.contract import Node, Port
from rendergraph.node.discovery import node_names, try_node
from rendergraph.node.params import Params
from rendergraph.plan.graph import Position

Locate = Callable[..., Position]


def check_nodes(data: Mapping[str, Any], locate: Locate) -> tuple[dict[str, Params], list[Diagnostic]]:
    """Validated parameters of every pass without mistakes, and the mistakes (RG200 to RG207).

    ``locate(*loc, key=False)`` gives positions. Parts of ``data`` of the wrong type are passed over: the document's own
    models report them.
    """
    params: dict[str, Params] = {}
    problems: list[Diagnostic] = []
    passes = data.get("passes")
    for name, entry in (passes if isinstance(passes, dict) else {}).items():
        if len(problems) > MAX_MISTAKES:
            break
        if not isinstance(entry, dict) or not isinstance(entry.get("node"), str):
            continue
        found = _node(name, entry["node"], locate)
        if isinstance(found, Diagnostic):
            problems.append(found)
            continue
        for direction, ports in (("read", found.inputs), ("write", found.outputs)):
            connected = entry.get(direction, {})
            if isinstance(connected, dict):
                _check_ports(name, found, direction, ports, connected, locate, problems)
        values = entry.get("set", {})
        if isinstance(values, dict):
            try:
                checked, mistakes = validate_strictly(found.params_type, values)
            except Exception as error:  # a node's own validator may fail in any way
                reason = f"its check of the parameters failed with {type(error).__name__}: {error}"
                problems.append(
                    diagnose("RG207", locate("passes", name, "set", key=True), node=found.name, reason=reason)
                )
                continue
            problems += (_parameter_problem(name, found, mistake, locate) for mistake in mistakes)
            if checked is not None:
                params[name] = checked
    return params, problems


def misplaced(entry: Any, key: str) -> str | None:
    """A help line for a key that stands in a pass but is a parameter or port of its node."""
    node = entry.get("node") if isinstance(entry, dict) else None
    if not isinstance(node, str) or node not in node_names():
        return None
    found = try_node(node)
    if not isinstance(found, type):
        return None
    sections = {"set": found.params_type.model_fields, "read": found.inputs, "write": found.outputs}
    section = next((section for section, names in sections.items() if key in names), None)
    return f"write it under `{section}:`" if section else None


def _node(name: str, node: str, locate: Locate) -> type[Node[Any]] | Diagnostic:
    if node not in node_names():
        hint = did_you_mean(node, node_names(), "nodes: {choices}")
        return diagnose("RG200", locate("passes", name, "node"), name=name, node=node, hint=hint)
    found = try_node(node)
    if isinstance(found, str):
        return diagnose("RG207", locate("passes", name, "node"), node=node, reason=found)
    return found


def _check_ports(
    name: str,
    node: type[Node[Any]],
    direction: str,
    ports: Mapping[str, Port],
    connected: Mapping[str, Any],
    locate: Locate,
    problems: list[Diagnostic],
) -> None:
    if not node.open_ports and not connected.keys() <= ports.keys():
        kind, other, others = (
            ("input", "write", node.outputs) if direction == "read" else ("output", "read", node.inputs)
        )
        for port in connected.keys() - ports.keys():
            hint = did_you_mean(port, ports, f"its {kind} ports: {{choices}}")
            if port in others:
                hint = f"'{port}' belongs under `{other}:`"
            elif not ports:
                hint = f"it has no {kind} ports; remove `{direction}:`"
            place = locate("passes", name, direction, port, key=True)
            problems.append(diagnose("RG201", place, node=node.name, direction=kind, port=port, hint=hint))
    for port, declared in ports.items():
        if port not in connected and not declared.optional:
            code = "RG202" if direction == "read" else "RG203"
            meaning = declared.help.rstrip(".")
            place = locate("passes", name, direction, key=True)
            problems.append(diagnose(code, place, name=name, port=port, node=node.name, meaning=meaning))


def _parameter_problem(name: str, node: type[Node[Any]], mistake: Mistake, locate: Locate) -> Diagnostic:
    loc = ("passes", name, "set", *mistake.loc)
    place = locate(*loc, key=mistake.at_key)
    where = ".".join(map(str, loc))
    if mistake.kind == "missing" and not mistake.loc:
        meaning = f" ({mistake.hint})" if mistake.hint else ""
        return diagnose("RG206", place, name=name, key=mistake.expected, node=node.name, meaning=meaning)
    if mistake.kind == "unknown" and len(mistake.loc) == 1:
        return diagnose("RG204", place, node=node.name, key=mistake.expected, hint=mistake.hint)
    problem = {
        "missing": f"lacks the key '{mistake.expected}'",
        "unknown": "is not a known key",
        "consistency": f"is not possible: {mistake.expected}",
    }.get(mistake.kind, f"must be {mistake.expected}, found {mistake.found}")
    if mistake.kind not in ("missing", "unknown", "consistency", "type", "range", "choice", "length", "name"):
        return diagnose(mistake.kind, place, **mistake.data)
    return diagnose(
        "RG205", place, where=where, problem=problem, hint=mistake.hint or "see `rg nodes` for its parameters"
    )
