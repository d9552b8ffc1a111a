"""Commands that need no GPU."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.cli.conftest import Rg

GRAPH = """
rendergraph: 1
frame: {size: [64, 36]}
resources:
  a: {format: rgba16f}
passes:
  paint: {node: fullscreen, write: {o_color: a}, set: {shader: paint.frag}}
  show:  {node: tonemap, read: {color: a}, write: {color: image}, set: {curve: linear}}
outputs: {image: {file: image.png}}
"""
SHADER = "#version 450\nout vec4 o_color;\nvoid main() { o_color = vec4(0.5, 0.25, 0.125, 1.0); }\n"


@pytest.fixture
def graph(tmp_path: Path) -> Path:
    """A two-pass graph in a folder of its own."""
    (tmp_path / "paint.frag").write_text(SHADER)
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    return path


def test_validate_says_valid_and_exits_0(rg: Rg, graph: Path) -> None:
    outcome = rg("validate", str(graph))
    assert outcome.code == 0
    assert "valid" in outcome.out


def test_validate_reports_every_error_with_its_place_and_exits_1(rg: Rg, graph: Path) -> None:
    graph.write_text(GRAPH.replace("node: tonemap", "node: tonemapp").replace("rgba16f", "rgba17f"))
    outcome = rg("validate", str(graph))
    assert outcome.code == 1
    assert "Traceback" not in outcome.err
    assert "graph.yaml:5:" in outcome.err
    assert "graph.yaml:8:" in outcome.err
    assert "tonemap" in outcome.err.replace("tonemapp", "")  # did you mean


def test_validate_json_lists_findings(rg: Rg, graph: Path) -> None:
    graph.write_text(GRAPH.replace("node: tonemap", "node: tonemapp"))
    outcome = rg("validate", str(graph), "--format", "json")
    findings = json.loads(outcome.out)
    assert outcome.code == 1
    assert findings[0]["code"].startswith("RG")
    assert findings[0]["severity"] == "error"


@pytest.mark.parametrize("name", ["missing.yaml", ".", "garbage.yaml"])
def test_unreadable_input_exits_2(rg: Rg, tmp_path: Path, name: str) -> None:
    (tmp_path / "garbage.yaml").write_bytes(bytes(range(256)))
    outcome = rg("validate", str(tmp_path / name))
    assert outcome.code == 2
    assert "RG1" in outcome.err
    assert "help:" in outcome.err


def test_an_empty_file_is_no_graph(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "empty.yaml").write_text("")
    outcome = rg("validate", str(tmp_path / "empty.yaml"))
    assert outcome.code == 1
    assert "RG110" in outcome.err


def test_usage_error_exits_2(rg: Rg) -> None:
    assert rg("rendr").code == 2
    assert rg("render", "deferred_shading", "--size", "10").code == 2
    assert rg("plan", "deferred_shading", "--order", "best").code == 2


def test_plan_json_is_the_resources_record(rg: Rg, graph: Path) -> None:
    outcome = rg("plan", str(graph), "--format", "json")
    record = json.loads(outcome.out)
    assert outcome.code == 0
    assert record["schema"] == "rendergraph.resources/1"
    assert [step.split(".")[0] for step in record["order"]] == ["paint", "show"]
    assert record["totals"]["load"] == 64 * 36 * 8  # `a`; the output image is not transient


def test_plan_text_is_a_table(rg: Rg, graph: Path) -> None:
    outcome = rg("plan", str(graph))
    assert outcome.code == 0
    assert "Target lifetimes" in outcome.out


def test_graph_draws_three_ways(rg: Rg, graph: Path) -> None:
    mermaid, dot, svg = (rg("graph", str(graph), "--format", form).out for form in ("mermaid", "dot", "svg"))
    assert mermaid.startswith("flowchart LR")
    assert dot.startswith("digraph")
    root = ElementTree.fromstring(svg)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    for text in (mermaid, dot, svg):
        assert "paint" in text
        assert "show" in text


def test_explain_code_and_subject(rg: Rg, graph: Path) -> None:
    assert rg("explain", "rg560").code == 0
    assert rg("explain", "RG999").code == 2
    outcome = rg("explain", str(graph), "a")
    assert outcome.code == 0
    assert outcome.out.strip()


def test_nodes_json_has_names_ports_and_parameters(rg: Rg) -> None:
    nodes = {node["name"]: node for node in json.loads(rg("nodes", "--format", "json").out)}
    assert {"gbuffer", "shadow_map", "deferred_lighting", "forward_shading", "tonemap"} <= set(nodes)
    assert "color" in nodes["tonemap"]["outputs"]
    for node in nodes.values():
        assert node["summary"]
        for parameter in node["parameters"].values():
            assert parameter["help"]


def test_nodes_page_and_unknown_node(rg: Rg) -> None:
    assert "Parameters" in rg("nodes", "tonemap").out
    outcome = rg("nodes", "tonemp")
    assert outcome.code == 2
    assert "tonemap" in outcome.err.replace("tonemp", "")


def test_schema_is_json(rg: Rg) -> None:
    assert "passes" in json.loads(rg("schema").out)["properties"]


def test_new_graph_and_node_are_valid_and_never_overwrite(rg: Rg, tmp_path: Path) -> None:
    assert rg("new", "graph", str(tmp_path / "mine.yaml")).code == 0
    assert rg("validate", str(tmp_path / "mine.yaml")).code == 0
    assert rg("new", "graph", str(tmp_path / "mine.yaml")).code == 2
    assert rg("new", "node", "my_blur", "--folder", str(tmp_path)).code == 0
    assert rg("new", "node", "my_blur", "--folder", str(tmp_path)).code == 2
    assert rg("new", "node", "My-Blur", "--folder", str(tmp_path)).code == 2


def test_light_commands_import_neither_numpy_nor_moderngl(graph: Path) -> None:
    for arguments in (["--help"], ["validate", str(graph)], ["validate", "deferred_shading"]):
        code = (
            "import sys\nfrom rendergraph.cli import main\n"
            f"try:\n    main({arguments!r})\nexcept SystemExit as e:\n    assert e.code == 0, e.code\n"
            "assert not {'numpy', 'moderngl'} & set(sys.modules), sorted(sys.modules)"
        )
        finished = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        assert finished.returncode == 0, finished.stderr[-2000:]
