"""`rg bench --vs-full` as a user types it."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Rg


@pytest.mark.parametrize("more", [["fxaa"], ["--full"], ["--a", "frame.seed=1"], ["--b", "frame.seed=1"]])
def test_the_command_takes_one_graph_alone(rg: Rg, tmp_path: Path, more: list[str]) -> None:
    outcome = rg("bench", "tonemap", *more, "--vs-full", "-o", str(tmp_path / "b.json"))
    assert outcome.code == 2
    assert "RG581" in outcome.err


@pytest.mark.gpu
def test_the_command(rg: Rg, tmp_path: Path) -> None:
    arguments = ["--processes", "1", "--blocks", "1", "--frames", "1", "--size", "16x9", "--warm-up", "1"]
    out = tmp_path / "b.json"
    outcome = rg("bench", "tonemap", "--vs-full", "-o", str(out), *arguments, "--format", "json")
    assert outcome.code == 0, outcome.err
    assert json.loads(outcome.out)["schema"] == "rendergraph.vs_full/1"
    assert set(json.loads(out.read_text())["sides"]) == {"A", "B"}
    outcome = rg("bench", "tonemap", "--vs-full", "-o", str(out), *arguments)
    assert "Saved time" in outcome.out
    assert "Nothing could be left out" in outcome.out
