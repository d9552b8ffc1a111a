"""The JSON Schema of a graph file for editors: draft-07, what their YAML support reads, node parameters included.

It is a little laxer than ``load_document``: relations between keys and between passes cannot be said in a schema.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue, models_json_schema
from pydantic_core import core_schema

from rendergraph.document.models import DocumentModel
from rendergraph.node.contract import Node, Port
from rendergraph.node.discovery import find_node, node_folder, node_names, try_node

DIALECT: Final = "http://json-schema.org/draft-07/schema#"
IDENTITY: Final = "urn:rendergraph:graph:1"
_REFERENCE: Final = "#/definitions/{model}"


def shipped_nodes() -> tuple[str, ...]:
    """Names of the nodes that come with the package, sorted: the same on every machine."""
    folder = node_folder().resolve()
    return tuple(name for name in node_names() if (folder / name / "__init__.py").is_file())


def json_schema(nodes: Iterable[str] | None = None) -> dict[str, Any]:
    """The schema with the ports and parameters of ``nodes``; by default of all nodes found, shipped or installed.

    Installed nodes that cannot be imported are left out.
    """
    if nodes is None:
        found = [node for node in map(try_node, node_names()) if not isinstance(node, str)]
    else:
        found = [find_node(name) for name in sorted(nodes)]
    models: dict[type[BaseModel], None] = dict.fromkeys([DocumentModel, *(node.params_type for node in found)])
    references, combined = models_json_schema(
        [(model, "validation") for model in models], ref_template=_REFERENCE, schema_generator=_Generator
    )
    definitions: dict[str, Any] = combined["$defs"]
    _describe_passes(definitions["PassModel"], found, {model: ref for (model, _), ref in references.items()})
    document = definitions.pop("DocumentModel")
    schema = {
        "$schema": DIALECT,
        "$id": IDENTITY,
        "title": "Render graph",
        **_draft_07(document),
        "definitions": {name: _draft_07(definition) for name, definition in sorted(definitions.items())},
    }
    return json.loads(json.dumps(schema))  # type: ignore[no-any-return]  # tuples among the defaults become lists


def write_schema(path: str | Path) -> None:
    """Write the schema of the shipped nodes, as committed under ``docs/``."""
    text = json.dumps(json_schema(shipped_nodes()), indent=2, ensure_ascii=False)
    Path(path).write_text(text + "\n", encoding="utf-8")


class _Generator(GenerateJsonSchema):
    def tagged_union_schema(self, schema: core_schema.TaggedUnionSchema) -> JsonSchemaValue:
        """``anyOf``, not ``oneOf``: a point light is also a valid spot light without its optional keys."""
        tagged = super().tagged_union_schema(schema)
        return {"anyOf": tagged["oneOf"]}


def _describe_passes(
    schema: dict[str, Any], nodes: Iterable[type[Node[Any]]], references: Mapping[type[Any], dict[str, Any]]
) -> None:
    """Names the nodes, and says for each what its ``read``, ``write`` and ``set`` hold."""
    nodes = list(nodes)
    if not nodes:
        return
    schema["properties"]["node"] |= {
        "enum": [node.name for node in nodes],
        "enumDescriptions": [node.summary() for node in nodes],
    }
    schema["allOf"] = [
        {
            "if": {"properties": {"node": {"const": node.name}}, "required": ["node"]},
            "then": _pass_of(node, references[node.params_type]),
        }
        for node in nodes
    ]


def _pass_of(node: type[Node[Any]], parameters: dict[str, Any]) -> dict[str, Any]:
    required = []
    for key, ports in (("read", node.inputs), ("write", node.outputs)):
        if any(not port.optional for port in ports.values()):
            required.append(key)
    if any(field.is_required() for field in node.params_type.model_fields.values()):
        required.append("set")
    properties = {
        "read": _ports(node.inputs, node.open_ports),
        "write": _ports(node.outputs, node.open_ports),
        "set": parameters,
    }
    return {"properties": properties, "required": required} if required else {"properties": properties}


def _ports(ports: Mapping[str, Port], is_open: bool) -> dict[str, Any]:
    schema: dict[str, Any] = {"properties": {name: {"description": _port_help(port)} for name, port in ports.items()}}
    required = [name for name, port in ports.items() if not port.optional]
    if required:
        schema["required"] = required
    if not is_open:
        schema["additionalProperties"] = False
    return schema


def _port_help(port: Port) -> str:
    kinds = [*(["a buffer"] if port.buffer else []), *([", ".join(port.formats)] if port.formats else [])]
    return f"{port.help} Takes {' or '.join(kinds)}." if kinds else port.help


def _draft_07(schema: Any, *, named: bool = False) -> Any:
    """Pydantic's 2020-12 schema in draft-07's words. ``named``: the keys are names of properties, not keywords."""
    if isinstance(schema, list):
        return [_draft_07(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if named:
        return {name: _draft_07(value) for name, value in schema.items()}
    kept = {
        key: value
        if key in ("default", "enum", "const")
        else _draft_07(value, named=key in ("properties", "patternProperties"))
        for key, value in schema.items()
        if key != "title" and not (key == "default" and value is None)
    }
    if "prefixItems" in kept:
        kept["items"] = kept.pop("prefixItems")
        kept["additionalItems"] = False
    if "patternProperties" in kept:
        kept["additionalProperties"] = False
    if "$ref" in kept and len(kept) > 1:
        kept = {"allOf": [{"$ref": kept.pop("$ref")}], **kept}  # draft-07 ignores what stands beside a $ref
    return kept
