"""Writes ``docs/yaml.md``, the reference of the YAML language, from the models."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from rendergraph.document.formats import FORMATS
from rendergraph.document.models import DocumentModel
from rendergraph.document.schema import json_schema
from rendergraph.document.source_file import MAX_BYTES
from rendergraph.document.yaml_reader import MAX_DEPTH, MAX_VALUES

_INTRODUCTION: Final = f"""\
# The YAML of a graph file

Generated from `rendergraph/document/models.py`; write it anew with
`python -c "from rendergraph.document.reference_page import write_reference; write_reference('docs/yaml.md')"`.

A graph file is one YAML 1.2 document in UTF-8, of at most {MAX_BYTES >> 20} MiB, {MAX_VALUES:,} values and
{MAX_DEPTH} levels.

- Unquoted `true` and `false` are booleans; `yes`, `no`, `on` and `off` are text, and warned about.
- `1e-3` is a number; `12:30`, `1_000` and `2024-01-01` are text; `010` is an error, since YAML versions differ on it.
- Types are strict: a quoted number is text, and a number is no boolean.
- Keys are text and occur once. Anchors, aliases and merge keys (`<<`) work; tags (`!name`) do not.
- For editors with YAML support, the first line may name the schema:
  `# yaml-language-server: $schema=docs/rendergraph.schema.json`. `rg schema` prints it.
- `--set passes.blur.set.radius=2` lays a value over the file's: a dotted path, and YAML after the first `=`.

`rg nodes` lists the nodes with their ports and parameters (`read`, `write` and `set` of a pass). Angles are degrees,
lengths metres, colours linear Rec. 709; see [conventions](conventions.md).
"""
_SIGNS: Final = {
    "minimum": "≥",
    "exclusiveMinimum": ">",
    "maximum": "≤",
    "exclusiveMaximum": "<",
    "multipleOf": "multiple of",
}
_NAME = re.compile(r"\^\[A-Za-z_\]")


def reference_page() -> str:
    """The page as Markdown: one section a model, one row a key."""
    schema = json_schema(nodes=())
    definitions: dict[str, Any] = schema["definitions"]
    sections = [_section("The document", DocumentModel.__doc__ or "", schema)]
    sections += [_section(_title(name), definitions[name]["description"], definitions[name]) for name in _order(schema)]
    return "\n".join([_INTRODUCTION, *sections, _formats()])


def write_reference(path: str | Path) -> None:
    """Write the page."""
    Path(path).write_text(reference_page(), encoding="utf-8")


def _order(schema: dict[str, Any]) -> list[str]:
    """The models in the order in which the document names them."""
    found: list[str] = []

    def visit(node: Any) -> None:
        for name in _references(node):
            if name not in found:
                found.append(name)
                visit(schema["definitions"][name]["properties"])

    visit(schema["properties"])
    return found


def _references(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        if "$ref" in node:
            yield _referred(node["$ref"])
        for value in node.values():
            yield from _references(value)
    elif isinstance(node, list):
        for value in node:
            yield from _references(value)


def _section(title: str, text: str, schema: dict[str, Any]) -> str:
    required = schema.get("required", [])
    lines = [
        f"## {title}",
        "",
        text,
        "",
        "| Key | Type | Range | Unit | Default | Meaning |",
        "|---|---|---|---|---|---|",
    ]
    for key, entry in schema["properties"].items():
        default = "required" if key in required else _default(entry)
        cells = [f"`{key}`", _type(entry), _range(entry), entry.get("unit", ""), default, entry.get("description", "")]
        lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return "\n".join([*lines, ""])


def _formats() -> str:
    lines = [
        "## Formats",
        "",
        "Formats of one view class can share memory; images are what `imageLoad` and `imageStore` take.",
        "",
    ]
    lines += ["| Format | Bytes a texel | Channels | Kind | View class | Image |", "|---|---|---|---|---|---|"]
    for row in FORMATS.values():
        cells = [
            f"`{row.name}`",
            str(row.texel_bytes),
            str(row.channels),
            row.channel.value,
            row.view_class,
            row.image or "",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _title(name: str) -> str:
    return name.removesuffix("Model")


def _referred(reference: str) -> str:
    return reference.rpartition("/")[2]


def _default(entry: dict[str, Any]) -> str:
    if "default" in entry:
        return f"`{json.dumps(entry['default'], ensure_ascii=False)}`"
    if entry.get("type") == "object":
        return "`{}`"
    return "its own" if "allOf" in entry else "none"


def _branches(entry: dict[str, Any]) -> list[dict[str, Any]]:
    """What the value may be, less the null of an optional key."""
    return [b for b in entry.get("anyOf", entry.get("allOf", [entry])) if b.get("type") != "null"]


def _type(entry: dict[str, Any]) -> str:
    return " or ".join(dict.fromkeys(_one_type(branch) for branch in _branches(entry)))


def _one_type(entry: dict[str, Any]) -> str:
    if "$ref" in entry:
        name = _title(_referred(entry["$ref"]))
        return f"[{name}](#{name.lower()})"
    if "anyOf" in entry or "allOf" in entry:
        return _type(entry)
    if "const" in entry:
        return f"`{json.dumps(entry['const'])}`"
    if "enum" in entry:
        if {*entry["enum"]} == {*FORMATS}:
            return "[format](#formats)"
        return ", ".join(f"`{choice}`" for choice in entry["enum"])
    if entry.get("type") == "array":
        items = entry["items"]
        return f"list of {_type(items)}" if isinstance(items, dict) else f"list of {len(items)}: {_type(items[0])}"
    if entry.get("type") == "object":
        values = next(iter(entry.get("patternProperties", {}).values()), entry.get("additionalProperties"))
        return f"mapping of names to {_type(values)}" if isinstance(values, dict) else "mapping"
    if _NAME.match(entry.get("pattern", "")):
        return "name"
    return {"string": "text", "integer": "whole number", "number": "number", "boolean": "boolean"}[entry["type"]]


def _range(entry: dict[str, Any]) -> str:
    bounds = []
    for branch in _branches(entry):
        items = branch.get("items")
        inner = items[0] if isinstance(items, list) else items or branch
        bounds += [f"{sign} {inner[key]}" for key, sign in _SIGNS.items() if key in inner]
        if "maxLength" in branch and "pattern" not in branch:
            bounds.append(f"at most {branch['maxLength']} characters")
    return ", ".join(bounds)
