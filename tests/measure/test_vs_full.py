"""`rg bench --vs-full`: what specialisation saves, with its verdict and its reasons."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from rendergraph.measure.bench import Bench
from rendergraph.measure.bench_job import BenchJob
from rendergraph.measure.vs_full import VsFull, vs_full, vs_full_record, vs_full_sides
from rendergraph.report.vs_full_table import vs_full_tables

#: No sun, no transparency: shadows and glass are for nothing.
DARK = (
    "scene.source=cornell",
    "scene.lights={from_scene: false, ambient: {}}",
    "resources.shadow.fixed=[256, 256]",
    "frame.size=[64, 36]",
)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory, session_device: Any) -> Path:
    """A short bench of the demo graph in a scene that needs little of it."""
    run = Bench(BenchJob(vs_full_sides("deferred_shading", DARK), processes=2, blocks=5, frames=2, most_warm_up=9))
    run.run()
    path = tmp_path_factory.mktemp("bench") / "b.json"
    path.write_text(json.dumps(run.record()))
    return path


@pytest.fixture(scope="module")
def found(record: Path) -> VsFull:
    return vs_full(record)


@pytest.mark.gpu
def test_passes_that_only_the_full_graph_runs_are_left_out(found: VsFull) -> None:
    saved = {entry.name: entry for entry in found.passes}
    assert saved["shadows"].verdict == "left_out"
    assert saved["glass"].verdict == "left_out"
    assert saved["shadows"].saved == 1.0
    assert (saved["shadows"].full_ms or 0.0) > 0.0
    assert saved["light"].verdict in ("faster", "slower", "unchanged", "inconclusive")


@pytest.mark.gpu
def test_the_whole_frame_has_a_verdict_and_an_interval(found: VsFull) -> None:
    frame = found.frame
    assert frame.verdict in ("faster", "inconclusive"), "two passes less are no slower"
    assert frame.full_ms is not None
    assert frame.specialised_ms is not None
    assert frame.saved is not None
    assert frame.saved == pytest.approx(1.0 - frame.specialised_ms / frame.full_ms, abs=0.3)
    if frame.low is not None and frame.high is not None:  # none where samples are too much alike
        assert frame.low <= frame.saved <= frame.high


@pytest.mark.gpu
def test_bytes_are_exact(found: VsFull) -> None:
    amounts = {entry.name: entry for entry in found.amounts}
    shadow = 256 * 256 * 4 * 3
    assert amounts["transient_bytes"].full - amounts["transient_bytes"].specialised >= shadow
    assert amounts["passes"].full - amounts["passes"].specialised == 2
    assert 0.0 < (amounts["bytes_written"].saved or 0.0) < 1.0
    assert amounts["draws"].specialised < amounts["draws"].full


@pytest.mark.gpu
def test_the_reasons_come_along(found: VsFull) -> None:
    reasons = {(d["subject"], d["evidence"].get("feature")) for d in found.decisions}
    assert ("shadows.draw", "sun") in reasons
    assert ("glass.blended", "blended") in reasons
    assert all(d["why"] for d in found.decisions)
    record = vs_full_record(found)
    assert json.loads(json.dumps(record))["frame"] == asdict(found.frame)
    assert len(list(vs_full_tables(found))) == 3


def test_the_sides_differ_in_full_alone() -> None:
    sides = vs_full_sides("g", ("x=1",))
    assert [(s.graph, s.overrides, s.full) for s in sides.values()] == [("g", ("x=1",), True), ("g", ("x=1",), False)]
    job = BenchJob(sides)
    assert BenchJob.from_json(json.loads(json.dumps(job.to_json()))) == job
