"""Sweeps that run: errors against closed forms, going on after an interruption, processes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.errors import PointError, as_error, image_error, over_frames
from rendergraph.measure.sweep.outcome import Limits, SweepOutcome, sweep_outcome
from rendergraph.measure.sweep.run import Sweep, new_job
from rendergraph.measure.sweep.store import CONTROL, FILE
from rendergraph.node.reference import Quantity
from rendergraph.report.sweep import sweep_record
from rendergraph.report.sweep_shape import SweepRecord
from tests.measure.sweep.conftest import ramp_error
from tests.measure.truth.slope_node import DAPPLE, DAPPLE_REFERENCE, DAPPLE_SHADER

pytestmark = pytest.mark.gpu

QUICK: dict[str, Any] = {"rounds": 6, "frames": 1, "most_warm_up": 9}
#: A shipped graph: worker processes know no node of a test.
FXAA = {"overrides": ("frame.size=[32, 18]",), **QUICK}


def swept(graph: Path | str, folder: Path, over: str, error: str = "", **options: Any) -> tuple[Sweep, SweepOutcome]:
    sweep = Sweep(new_job(str(graph), **{**QUICK, **options}), over=[over], error=error)
    sweep.run(folder)
    return sweep, sweep_outcome(sweep)


def errors(outcome: SweepOutcome) -> list[float | None]:
    return [row.error for row in outcome.rows]


def codes(outcome: SweepOutcome) -> list[str]:
    return [finding.code for finding in outcome.findings]


def test_the_error_is_the_nodes_own_and_falls(ramp_graph: Path, tmp_path: Path) -> None:
    sweep, outcome = swept(ramp_graph, tmp_path / "s", "ramp.steps=1|2|4|8")
    assert (sweep.job.error.name, sweep.job.error.why) == ("ramp.ramp", "one_pass")
    assert errors(outcome) == pytest.approx([ramp_error(k) for k in (1, 2, 4, 8)], rel=1e-5)
    assert [row.own for row in outcome.rows] == [False, False, True, False]
    assert outcome.trends[0].shape == "falls"
    assert codes(outcome) == []
    assert sweep.complete
    for row in outcome.rows:
        assert row.ms is not None
        assert row.ms.low <= row.ms.estimate <= row.ms.high
        assert row.result.bytes == sweep.plan.totals.used == 16 * 16 * 4
    record = SweepRecord.model_validate(json.loads(json.dumps(sweep_record(sweep, outcome))))
    assert record.recommended is not None
    assert record.recommended.set.startswith("--set passes.ramp.set.steps=")


@pytest.mark.parametrize(("knob", "shape"), [("planted", "rises"), ("idle", "flat")])
def test_a_knob_whose_error_does_not_fall_is_reported(ramp_graph: Path, tmp_path: Path, knob: str, shape: str) -> None:
    _, outcome = swept(ramp_graph, tmp_path / "s", f"ramp.{knob}=0|4|9")
    assert outcome.trends[0].shape == shape
    assert codes(outcome) == ["RG757"]
    assert outcome.findings[0].data["axis"] == f"ramp.{knob}"


def test_the_image_is_judged_by_its_twin_with_the_pass_replaced(ramp_graph: Path, tmp_path: Path) -> None:
    """Twice the ramp is off by twice as much, in three of four channels."""
    _, outcome = swept(ramp_graph, tmp_path / "s", "ramp.steps=1|4", "image:rmse")
    share = (3 / 4) ** 0.5
    assert errors(outcome) == pytest.approx([2 * share * ramp_error(k) for k in (1, 4)], rel=1e-5)
    assert [row.result.error.verdict for row in outcome.rows if row.result.error] == ["measured", "measured"]


def test_a_truth_that_is_not_sure_cannot_judge(ramp_graph: Path, tmp_path: Path) -> None:
    sweep, outcome = swept(ramp_graph, tmp_path / "s", "ramp.steps=1|8", "ramp.vague")
    assert errors(outcome) == [None, None]
    assert {row.result.error.verdict for row in outcome.rows if row.result.error} == {"cannot_judge"}
    assert codes(outcome) == ["RG756"]
    assert outcome.findings[0].severity == "error"
    assert outcome.recommended is None
    SweepRecord.model_validate(json.loads(json.dumps(sweep_record(sweep, outcome))))


def test_limits(ramp_graph: Path, tmp_path: Path) -> None:
    sweep, _ = swept(ramp_graph, tmp_path / "s", "ramp.steps=1|4|8")
    assert sweep_outcome(sweep, Limits(budget_ms=1e6)).recommended == 2
    within = sweep_outcome(sweep, Limits(max_error=ramp_error(4) * 1.01)).recommended
    assert within in (1, 2)
    for limits in (Limits(budget_ms=1e-9), Limits(max_error=1e-9)):
        outcome = sweep_outcome(sweep, limits)
        assert outcome.recommended is None
        assert codes(outcome) == ["RG760"]


def test_a_setting_that_is_refused_with_others_is_a_result(ramp_graph: Path, tmp_path: Path) -> None:
    _, outcome = swept(
        ramp_graph, tmp_path / "s", "resources.half.format=r32f|r16f,ramp.steps=4|8", "ramp.ramp"
    )  # fmt: skip
    refused = [row for row in outcome.rows if row.result.refused]
    assert len(refused) == 2, "the node takes no r16f"
    assert all(row.error is None and row.ms is None for row in refused)
    assert codes(outcome) == ["RG762"]


@pytest.mark.parametrize(
    ("error", "code"),
    [("rampe", "RG758"), ("ramp.rampe", "RG758"), ("image:flop", "RG758"), ("image:psnr", "RG758"), ("twice", "RG758")],
)
def test_errors_that_are_none(ramp_graph: Path, error: str, code: str) -> None:
    with pytest.raises(RenderGraphError) as refused:
        Sweep(new_job(str(ramp_graph)), over=["ramp.steps"], error=error)
    assert refused.value.diagnostics[0].code == code
    assert refused.value.exit_code == 2


def test_a_value_out_of_range_is_refused_before_anything_runs(ramp_graph: Path) -> None:
    with pytest.raises(RenderGraphError) as refused:
        Sweep(new_job(str(ramp_graph)), over=["ramp.steps=0|4|65"])
    assert [d.code for d in refused.value.diagnostics] == ["RG205", "RG205"]


def test_an_output_that_nothing_swept_reaches(ramp_graph: Path) -> None:
    text = ramp_graph.read_text().replace("read: {u_half: half}, ", "").replace("twice.frag", "flat.frag")
    ramp_graph.write_text(text.replace("write: {value: half}}", "write: {value: half}, keep: true}"))
    (ramp_graph.parent / "flat.frag").write_text("#version 450\nout vec4 color;\nvoid main() { color = vec4(1); }\n")
    with pytest.raises(RenderGraphError) as refused:
        Sweep(new_job(str(ramp_graph)), over=["ramp.steps=1|2"], error="image")
    assert refused.value.diagnostics[0].code == "RG759"


# ---- interruption


def exact(sweep: Sweep) -> list[tuple[Any, ...]]:
    """All of a finished sweep but its times."""
    outcome = sweep_outcome(sweep)
    return [(row.point, row.own, row.result.bytes, row.result.error, row.result.refused) for row in outcome.rows]


class Interrupter:
    """A progress callback that raises like Ctrl-C after so many calls."""

    def __init__(self, after: int) -> None:
        self.left = after

    def __call__(self, stage: str, done: int, total: int) -> None:
        self.left -= 1
        if self.left < 0:
            raise KeyboardInterrupt


def test_an_interrupted_sweep_goes_on_and_ends_the_same(
    ramp_graph: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rendergraph.measure.sweep.run.HELD", 2)

    def new() -> Sweep:
        return Sweep(new_job(str(ramp_graph), **QUICK), over=["ramp.steps=1|2|3|5|8"])

    whole = new()
    whole.run(tmp_path / "whole")
    cut = new()
    with pytest.raises(KeyboardInterrupt):
        cut.run(tmp_path / "cut", progress=Interrupter(12))
    measured = {point.index for chunk in cut.stored.chunks.values() for point in chunk.points}
    assert 0 < len(measured) < 5, "some chunks are there, some not"
    assert not cut.complete
    kept = (tmp_path / "cut" / FILE).read_text()

    resumed = new()
    resumed.run(tmp_path / "cut")
    assert resumed.complete
    assert (tmp_path / "cut" / FILE).read_text().startswith(kept), "nothing was measured twice"
    assert exact(resumed) == exact(whole)

    calls: list[int] = []
    new().run(tmp_path / "cut", progress=lambda stage, done, total: calls.append(done))
    assert calls == [500], "nothing is left to do"


def test_another_graph_in_the_same_folder_is_refused(ramp_graph: Path, tmp_path: Path) -> None:
    swept(ramp_graph, tmp_path / "s", "ramp.steps=1|2")
    shader = ramp_graph.parent / "twice.frag"
    shader.write_text(shader.read_text().replace("2.0", "3.0"))
    sweep = Sweep(new_job(str(ramp_graph), **QUICK), over=["ramp.steps=1|2"])
    with pytest.raises(RenderGraphError) as refused:
        sweep.run(tmp_path / "s")
    assert refused.value.diagnostics[0].code == "RG754"
    assert "shaders" in refused.value.diagnostics[0].data["what"]
    sweep.run(tmp_path / "s", fresh=True)
    assert sweep.complete


# ---- processes


@pytest.fixture
def fxaa(tmp_path: Path) -> Callable[[int, str], Sweep]:
    def run(jobs: int, name: str) -> Sweep:
        sweep = Sweep(new_job("fxaa", **FXAA), over=["antialias.search_steps=1|4|12"])
        sweep.run(tmp_path / name, jobs=jobs)
        return sweep

    return run


def test_two_processes_find_the_same_and_say_that_they_shared_a_device(fxaa: Callable[[int, str], Sweep]) -> None:
    alone, together = fxaa(1, "one"), fxaa(2, "two")
    assert exact(together) == exact(alone)
    assert together.complete
    assert len(together.stored.chunks) == 2
    assert all(chunk.contended for chunk in together.stored.chunks.values())
    assert not any(chunk.contended for chunk in alone.stored.chunks.values())
    assert sweep_outcome(together).rows[0].contended


def test_a_workers_mistake_is_told_as_ones_own(tmp_path: Path) -> None:
    sweep = Sweep(new_job("fxaa", **FXAA), over=["antialias.search_steps=1|4"])
    with pytest.raises(RenderGraphError) as refused:
        sweep.run(tmp_path, jobs=2, devices=[63])
    assert refused.value.diagnostics[0].code == "RG503"
    assert refused.value.exit_code == 3


def test_the_document_alone_is_a_sweep_too(ramp_graph: Path, tmp_path: Path) -> None:
    sweep, outcome = swept(ramp_graph, tmp_path / "s", "ramp.steps=4")
    assert [sweep.result_of(point) for point in sweep.points] == [CONTROL]
    assert sweep.complete
    assert errors(outcome) == pytest.approx([ramp_error(4)], rel=1e-5)


# ---- randomness


def test_a_random_nodes_error_comes_with_its_own_standard_error(install: Any, tmp_path: Path) -> None:
    install("dapple", {"__init__.py": DAPPLE, "reference.py": DAPPLE_REFERENCE, "dapple.frag": DAPPLE_SHADER})
    path = tmp_path / "graph.yaml"
    path.write_text(
        "rendergraph: 1\nframe: {size: [16, 16]}\npasses:\n  specks: {node: dapple, write: {light: image}}\n"
        "outputs: {image: {file: image.npy, format: r32f}}\n"
    )
    _, outcome = swept(path, tmp_path / "s", "specks.bias=0|0.5")
    for row, bias in zip(outcome.rows, (0.0, 0.5), strict=True):
        assert row.result.error is not None
        assert row.error is not None
        # White noise of width 0.5: a frame is off by 0.5 / sqrt(12) beside its bias, in the mean of squares.
        assert row.error == pytest.approx((0.5**2 / 12 + bias**2) ** 0.5, rel=0.03)
        assert 0.0 < row.result.error.standard_error < 0.01


def test_images_are_compared_by_the_metric_asked_for() -> None:
    found = image_error(Quantity.SHARE, "rmse", np.zeros((2, 2, 1)), np.full((2, 2, 1), 0.5))
    assert (found.value, found.verdict) == (0.5, "measured")


@pytest.mark.parametrize(
    ("metric", "value", "error"),
    [
        ("rmse", 0.25, 0.25),
        ("ssim", 0.75, 0.25),
        ("psnr", 20.0, 0.1),
        ("psnr", None, 0.0),
        ("rmse", float("nan"), float("inf")),
        ("flip", None, float("inf")),
    ],
)
def test_more_is_always_worse(metric: str, value: float | None, error: float) -> None:
    assert as_error(metric, value) == pytest.approx(error)


def test_over_frames_the_worst_verdict_and_the_mean() -> None:
    within, above = PointError(1.0, "within"), PointError(3.0, "above")
    found = over_frames([within, above, within, above])
    assert (found.value, found.verdict) == (2.0, "above")
    assert found.standard_error == pytest.approx((4 / 3) ** 0.5 / 2)  # deviations of 1: sample deviation sqrt(4/3)
    assert over_frames([within, PointError(None, "cannot_judge", "all_masked")]).value is None
    assert over_frames([within]) is within
