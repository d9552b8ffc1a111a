"""The JSON Schema is current, holds no trace of a machine, takes every shipped graph and refuses broken ones."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from rendergraph.document.reference_page import reference_page
from rendergraph.document.schema import json_schema, shipped_nodes
from rendergraph.document.source_file import graph_folder, shipped_graphs
from rendergraph.document.yaml_reader import read_yaml
from rendergraph.node.discovery import find_node

DOCS = Path(__file__).resolve().parents[2] / "docs"
SCHEMA = json_schema(shipped_nodes())
WRITE_SCHEMA = (
    "python -c \"from rendergraph.document.schema import write_schema; write_schema('docs/rendergraph.schema.json')\""
)
WRITE_PAGE = (
    "python -c \"from rendergraph.document.reference_page import write_reference; write_reference('docs/yaml.md')\""
)


def graph(name: str) -> Any:
    path = graph_folder() / f"{name}.yaml"
    return read_yaml(path.read_bytes(), path.name).value


def refused(data: Any) -> bool:
    return not Draft7Validator(SCHEMA).is_valid(data)


def test_committed_schema_is_current() -> None:
    committed = json.loads((DOCS / "rendergraph.schema.json").read_text(encoding="utf-8"))
    assert committed == SCHEMA, f"write it anew: {WRITE_SCHEMA}"


def test_committed_reference_is_current() -> None:
    assert (DOCS / "yaml.md").read_text(encoding="utf-8") == reference_page(), f"write it anew: {WRITE_PAGE}"


def test_is_draft_07() -> None:
    Draft7Validator.check_schema(SCHEMA)
    text = json.dumps(SCHEMA)
    for keyword in ("prefixItems", "$defs", "unevaluatedProperties", "/home", "/work", "file:/"):
        assert keyword not in text


def test_every_shipped_node_is_described() -> None:
    branches = {b["if"]["properties"]["node"]["const"]: b["then"] for b in SCHEMA["definitions"]["PassModel"]["allOf"]}
    assert tuple(branches) == shipped_nodes()
    for name, branch in branches.items():
        reference = branch["properties"]["set"]["$ref"].rpartition("/")[2]
        assert set(SCHEMA["definitions"][reference].get("properties", {})) == set(
            find_node(name).params_type.model_fields
        )
        assert set(branch["properties"]["read"]["properties"]) == set(find_node(name).inputs)


@pytest.mark.parametrize("name", shipped_graphs())
def test_shipped_graphs_validate(name: str) -> None:
    errors = [f"{list(e.absolute_path)}: {e.message}" for e in Draft7Validator(SCHEMA).iter_errors(graph(name))]
    assert errors == []


@pytest.mark.parametrize("name", shipped_graphs())
def test_broken_graphs_do_not(name: str) -> None:
    whole = graph(name)
    broken = 0
    for section in ("rendergraph", "passes", "outputs"):
        data = copy.deepcopy(whole)
        del data[section]
        assert refused(data), section
    for name, entry in whole["passes"].items():
        for path, value in (
            (("node",), "no such node"),
            (("nod",), 1),
            (("keep",), "yes"),
            (("set", "no such parameter"), 1),
            (("write",), []),
            (("after",), [1]),
        ):
            data = copy.deepcopy(whole)
            target = data["passes"][name]
            for key in path[:-1]:
                target = target.setdefault(key, {})
            target[path[-1]] = value
            broken += 1
            assert refused(data), (name, path)
        node = find_node(entry["node"])
        if not node.open_ports:
            data = copy.deepcopy(whole)
            data["passes"][name].setdefault("read", {})["no_such_port"] = "x"
            assert refused(data), name
    assert broken


MINIMAL: dict[str, Any] = {
    "rendergraph": 1,
    "resources": {"a": {"format": "rgba8"}},
    "passes": {"p": {"node": "tonemap", "read": {"color": "a"}, "write": {"color": "image"}}},
    "outputs": {"image": {"file": "a.png"}},
}


@pytest.mark.parametrize(
    ("section", "value", "good"),
    [
        ("resources", {"a": {"format": "rgba8"}, "b": {"like": "a", "format": "r8"}, "c": {"bytes": 8}}, True),
        ("resources", {"a": {"previous": "b"}, "b": {"file": "x.png", "format": "rgba8"}}, True),
        ("resources", {"a": {"format": "rgba9"}}, False),
        ("resources", {"a": {"format": "rgba8", "bytes": 8}}, False),
        ("resources", {"a": {"scale": 2}}, False),
        ("resources", {"1a": {"format": "rgba8"}}, False),
        ("frame", {"size": [1, 1]}, True),
        ("frame", {"size": [1]}, False),
        ("frame", {"size": [1, 1, 1]}, False),
        ("frame", {"size": [1, 0]}, False),
        (
            "scene",
            {"source": "x", "lights": {"list": [{"position": [0, 0, 0]}, {"position": [0, 0, 0], "inner": 3}]}},
            True,
        ),
        ("scene", {"source": "x", "lights": {"list": [{"position": [0, 0, 0], "iner": 3}]}}, False),
        ("outputs", {"p.inner": {"file": "a.png"}}, True),
        ("outputs", {}, False),
    ],
)
def test_sections(section: str, value: Any, good: bool) -> None:
    assert not refused(MINIMAL)
    assert refused(MINIMAL | {section: value}) is not good


def test_required_ports() -> None:
    for section in ("read", "write"):
        data = copy.deepcopy(MINIMAL)
        del data["passes"]["p"][section]
        assert refused(data)
        data["passes"]["p"][section] = {}
        assert refused(data)
