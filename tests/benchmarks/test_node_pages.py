"""Every node has its page, whose parts that are not measured are what its declarations and README say."""

from __future__ import annotations

import re

import pytest

from benchmarks.node_pages import PAGES, ROOT, index, measured_part, page, shipped
from rendergraph.conformance.quality_axes import knob_values
from rendergraph.node.discovery import find_node

NODES = shipped()


def text_of(name: str) -> str:
    return (PAGES / f"{name}.md").read_text(encoding="utf-8")


def test_every_node_has_a_page_and_no_page_is_left_over() -> None:
    assert {file.stem for file in PAGES.glob("*.md")} == {*NODES, "README"}


@pytest.mark.parametrize("name", NODES)
def test_what_is_not_measured_is_current(name: str) -> None:
    """`python -m benchmarks.node_pages --keep-measured` renews it."""
    text = text_of(name)
    assert page(name, measured_part(text)) == text


@pytest.mark.parametrize("name", NODES)
def test_the_measured_part_covers_what_the_node_declares(name: str) -> None:
    node, measured = find_node(name), measured_part(text_of(name))
    for key in node.reference.measures if node.reference else ():
        assert f"| `{key}` |" in measured
    for extreme in node.extremes:
        assert re.search(rf"^\| `({name}\.)?{extreme.name}` \|", measured, re.MULTILINE), extreme.name
    for knob, entry in node.params_type.model_json_schema().get("properties", {}).items():
        if knob_values(entry):
            assert f"| `{knob}` | `" in measured
    assert "**fails**" not in measured
    assert "Measured on llvmpipe (LLVM" in measured


@pytest.mark.parametrize("name", NODES)
def test_links_lead_somewhere(name: str) -> None:
    links = re.findall(r"\]\(([^)#]+)\)", text_of(name))
    assert links
    for link in links:
        assert link.startswith("http") or (PAGES / link).resolve().exists(), link


def test_a_changed_default_makes_a_page_stale(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks import node_pages

    usual = node_pages.describe_node

    def other(name: str) -> dict[str, object]:
        described = usual(name)
        described["parameters"]["search_steps"]["default"] = 11
        return described

    monkeypatch.setattr(node_pages, "describe_node", other)
    assert page("fxaa", measured_part(text_of("fxaa"))) != text_of("fxaa")


def test_pages_are_linked() -> None:
    for file in ("README.md", "docs/choosing_accuracy.md"):
        assert "nodes/" in (ROOT / file).read_text(encoding="utf-8")
    assert text_of("README") == index()
