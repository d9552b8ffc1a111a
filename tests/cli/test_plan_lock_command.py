"""`rg plan --lock` and `--check`, and budgets of `rg plan` and `rg render`."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import PAINT, assert_misused, assert_refused, write_graph

LOCK = "plan.lock.json"


@pytest.fixture
def graph(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A graph in the working directory, with its lock."""
    monkeypatch.chdir(tmp_path)
    return write_graph(tmp_path).name


def test_a_plan_as_locked_is_fine(rg: Rg, graph: str) -> None:
    assert rg("plan", graph, "--lock", LOCK).code == 0
    first = Path(LOCK).read_bytes()
    outcome = rg("plan", graph, "--check", LOCK)
    assert (outcome.code, outcome.err) == (0, "")
    assert rg("plan", graph, "--lock", LOCK).code == 0
    assert Path(LOCK).read_bytes() == first
    assert [path.name for path in Path().iterdir() if path.name.startswith(".")] == []


def test_a_change_fails_and_points_at_the_line(rg: Rg, graph: str, tmp_path: Path) -> None:
    rg("plan", graph, "--lock", LOCK)
    write_graph(tmp_path, resources="  a: {format: rgba32f}\n")
    outcome = rg("plan", graph, "--check", LOCK)
    assert_refused(outcome, 1, "RG721", "graph.yaml:4:3", LOCK)
    codes = re.findall(r"(RG\d{3})", outcome.err)
    assert codes[0] == "RG721"
    assert set(codes) == {"RG721", "RG725", "RG726"}
    data = json.loads(rg("plan", graph, "--check", LOCK, "--format", "json").out)
    assert [entry["code"] for entry in data] == codes
    rg("plan", graph, "--lock", LOCK)
    assert rg("plan", graph, "--check", LOCK).code == 0


def test_a_pass_added_and_one_culled_are_named(rg: Rg, graph: str, tmp_path: Path) -> None:
    rg("plan", graph, "--lock", LOCK)
    dead = "  dead: {node: fullscreen, write: {o_color: b}, set: {shader: paint.frag}}\n"
    show = "  show: {node: tonemap, read: {color: a}, write: {color: image}, set: {curve: linear}}\n"
    write_graph(tmp_path, resources="  a: {format: rgba16f}\n  b: {format: r8}\n", passes=PAINT + dead + show)
    outcome = rg("plan", graph, "--check", LOCK, "--format", "json")
    assert [(e["code"], e["subject"].split(".")[0]) for e in json.loads(outcome.out)] == [("RG724", "dead")]
    outcome = rg("plan", graph, "--check", LOCK, "--no-cull", "--format", "json")
    assert ("RG723", "dead") in [(e["code"], e["subject"].split(".")[0]) for e in json.loads(outcome.out)]


def test_the_record_itself_can_be_the_lock(rg: Rg, graph: str, tmp_path: Path) -> None:
    Path(LOCK).write_text(rg("plan", graph, "--format", "json").out)
    assert rg("plan", graph, "--check", LOCK).code == 0
    write_graph(tmp_path, resources="  a: {format: r11g11b10f}\n")
    assert rg("plan", graph, "--check", LOCK).code == 1


def test_locks_that_cannot_be_used(rg: Rg, graph: str) -> None:
    assert_refused(rg("plan", graph, "--check", "missing.json"), 2, "RG720", "missing.json")
    assert_refused(rg("plan", graph, "--check", "."), 2, "RG720")
    assert_refused(rg("plan", graph, "--check", graph), 2, "RG720", graph)
    assert_refused(rg("plan", graph, "--lock", "paint.frag/plan.json"), 2, "RG560")
    assert_misused(rg("plan", graph, "--lock", LOCK, "--check", LOCK), "--check")
    assert not Path(LOCK).exists()
    rg("plan", graph, "--lock", LOCK)
    assert_refused(rg("plan", graph, "--check", LOCK, "--size", "64x64"), 1, "RG727", "32x18")


def test_a_plan_above_its_memory_budget_fails(rg: Rg, graph: str, tmp_path: Path) -> None:
    mib = 32 * 18 * 8 / 2**20
    write_graph(tmp_path, extra=f"budget: {{transient_mib: {mib}}}\n")
    assert rg("plan", graph).code == 0
    outcome = rg("plan", graph, "--set", "resources.a.format=rgba32f")
    assert_refused(outcome, 1, "RG703", "graph.yaml:3:25", "'a'", "paint.draw", "--set resources.a.format=r11g11b10f")
    assert "Target lifetimes" in outcome.out


@pytest.mark.gpu
def test_a_run_above_its_budget_fails_after_writing_all_files(rg: Rg, graph: str, tmp_path: Path) -> None:
    budget = "{frame_ms: 0.000001, passes: {paint: 0.000001, show: 100000}, draws: 1, transient_mib: 0.001}"
    write_graph(tmp_path, extra=f"budget: {budget}\n")
    outcome = rg("render", graph, "-o", "out", "--samples", "3")
    assert outcome.code == 1
    assert re.findall(r"(RG\d{3})", outcome.err) == ["RG703", "RG701", "RG702", "RG704"]
    assert "graph.yaml:3:" in outcome.err
    assert {"image.png", "timing.json", "resources.json"} <= {path.name for path in Path("out").iterdir()}
    outcome = rg("render", graph, "-o", "out", "--samples", "0")
    assert re.findall(r"(RG\d{3})", outcome.err) == ["RG703", "RG704", "RG708", "RG708", "RG708"]


@pytest.mark.gpu
def test_a_run_within_its_budget_is_fine(rg: Rg, graph: str, tmp_path: Path) -> None:
    budget = "{frame_ms: 100000, passes: {paint: 100000}, draws: 2, transient_mib: 1}"
    write_graph(tmp_path, extra=f"budget: {budget}\n")
    outcome = rg("render", graph, "-o", "out", "--samples", "2", "--format", "json")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out)["resources"]["advice"]
