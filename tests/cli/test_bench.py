"""`rg bench` as a user types it."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.test_inspect import GRAPH, SHADER

pytestmark = pytest.mark.gpu

QUICK = ("--processes", "1", "--blocks", "1", "--frames", "2")


@pytest.fixture
def graph(tmp_path: Path) -> Path:
    """A two-pass graph in a folder of its own."""
    (tmp_path / "paint.frag").write_text(SHADER)
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    return path


def test_a_graph_beside_itself(rg: Rg, graph: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "b.json"
    outcome = rg("bench", str(graph), str(graph), "-o", str(out), *QUICK, "--size", "32x18")
    assert outcome.code == 0, outcome.err
    record = json.loads(out.read_text())
    assert record["schema"] == "rendergraph.bench/1"
    assert set(record["sides"]) == {"A", "B"}
    assert "whole frame" in outcome.out
    assert "B / A" in outcome.out


def test_json_and_bound(rg: Rg, graph: Path, tmp_path: Path) -> None:
    out = tmp_path / "b.json"
    outcome = rg("bench", str(graph), "-o", str(out), *QUICK, "--bound", "--format", "json")
    assert outcome.code == 0, outcome.err
    record = json.loads(outcome.out)
    assert record == json.loads(out.read_text())
    assert record["bound"]["A"]["class"] in ("sync", "draw_calls", "gpu", "cpu")


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (("no_such_graph",), 2, "RG100"),
        (("G", "G", "G"), 2, "RG581"),
        (("G", "--b", "passes.nothing.set.x=1"), 2, "RG131"),
        (("G", "--a", "nonsense"), 2, "RG130"),
        (("G", "--size", "0x5"), 2, "--size"),
        (("G", "--processes", "0"), 2, "--processes"),
        (("G", "--frames", "x"), 2, "--frames"),
        (("G", "--device", "63"), 3, "RG503"),
    ],
)
def test_bad_input(rg: Rg, graph: Path, tmp_path: Path, arguments: tuple[str, ...], code: int, text: str) -> None:
    out = tmp_path / "b.json"
    named = [str(graph) if word == "G" else word for word in arguments]
    outcome = rg("bench", *named, "-o", str(out))
    assert outcome.code == code
    assert text in outcome.err
    assert "Traceback" not in outcome.err
    assert not out.exists()


def test_an_output_that_cannot_be_written_is_told_before_measuring(rg: Rg, graph: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    outcome = rg("bench", str(graph), "-o", str(tmp_path / "file" / "b.json"))
    assert outcome.code == 2
    assert "RG560" in outcome.err
    outcome = rg("bench", str(graph), "-o", str(tmp_path))
    assert outcome.code == 2
    assert "RG560" in outcome.err
