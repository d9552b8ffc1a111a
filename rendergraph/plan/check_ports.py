"""What a pass connects against the ports its node declares."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rendergraph.node.contract import Node, Port
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import BufferDesc, Kind, Resource, TextureDesc

_SECTION = {"input": "read", "output": "write"}


@dataclass(frozen=True, slots=True)
class Connections:
    """Port to resource of one pass, in the order of the file."""

    inputs: Mapping[str, Resource]
    outputs: Mapping[str, Resource]


def check_ports(name: str, node: Node[Any], found: Connections, findings: Findings) -> None:
    """Report every port of pass ``name`` that does not fit."""
    for direction, ports, connected in (("input", node.inputs, found.inputs), ("output", node.outputs, found.outputs)):
        for port, resource in connected.items():
            if port in ports:
                _check_port(name, node, direction, port, ports[port], resource, findings)
            if port in ports and (like := ports[port].like) is not None:
                _check_like(name, direction, port, like, found, findings)
    _check_written(name, node, found, findings)


def _check_port(
    name: str, node: Node[Any], direction: str, port: str, declared: Port, resource: Resource, findings: Findings
) -> None:
    loc = ("passes", name, _SECTION[direction], port)
    values: dict[str, Any] = {"port": port, "node": node.name, "resource": resource.name}
    desc = resource.desc
    if isinstance(desc, BufferDesc):
        if not declared.buffer:
            findings.add("RG321", *loc, wanted="texture", found="buffer", **values)
        return
    if not declared.formats:
        if declared.buffer:
            findings.add("RG321", *loc, wanted="buffer", found="texture", **values)
    elif desc.format not in declared.formats:
        findings.add("RG320", *loc, format=desc.format, formats=", ".join(declared.formats), **values)
    if desc.samples not in declared.samples:
        wanted = " or ".join(map(str, declared.samples))
        findings.add("RG322", *loc, wanted=wanted, found=desc.samples, **values)
    if declared.layers is not None and desc.layers != declared.layers:
        findings.add("RG323", *loc, wanted=declared.layers, found=desc.layers, **values)


def _check_like(name: str, direction: str, port: str, like: str, found: Connections, findings: Findings) -> None:
    """Compare sizes with the port ``like``: the input of that name if there is one, else the output."""
    resource = found.inputs[port] if direction == "input" else found.outputs[port]
    other = found.inputs.get(like) or found.outputs.get(like)
    if other is None or not isinstance(resource.desc, TextureDesc) or not isinstance(other.desc, TextureDesc):
        return
    one, two = resource.desc, other.desc
    if (one.width, one.height) != (two.width, two.height):
        findings.add(
            "RG324", "passes", name, _SECTION[direction], port,
            resource=resource.name, port=port, width=one.width, height=one.height,
            other=other.name, like=like, other_width=two.width, other_height=two.height,
        )  # fmt: skip


def _check_written(name: str, node: Node[Any], found: Connections, findings: Findings) -> None:
    readers = {resource.name: port for port, resource in found.inputs.items()}
    writers: dict[str, str] = {}
    for port, resource in found.outputs.items():
        loc = ("passes", name, "write", port)
        if resource.kind is Kind.IMPORTED:
            instead = "copy the image into it first if you want to change it"
            findings.add("RG215", *loc, name=name, resource=resource.name, kind="an image file", instead=instead)
        elif resource.kind is Kind.HISTORY:
            instead = f"'{resource.previous_of}' is what the next frame will find there"
            findings.add("RG215", *loc, name=name, resource=resource.name, kind="last frame's content", instead=instead)
        if resource.name in writers:
            findings.add("RG217", *loc, name=name, resource=resource.name, first=writers[resource.name], second=port)
        writers[resource.name] = port
        if resource.name in readers and not node.modifies(port):
            findings.add("RG216", *loc, name=name, resource=resource.name, read=readers[resource.name], write=port)
