"""`rg render --html --trace`: what is written, and what is not disturbed."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Rg


@pytest.mark.gpu
def test_render_writes_page_and_trace(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", "tonemap", "--size", "64x36", "--samples", "2", "--html", "--trace", "-o", str(tmp_path))
    assert outcome.code == 0, outcome.err
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert all(f'id="{name}"' in page for name in ("target-chart", "target-aces", "target-reinhard", "pass-paint"))
    assert (tmp_path / "trace.json").stat().st_size > 1000
    assert not (tmp_path / "chart.png").exists(), "what the page shows is not a capture the user asked for"


@pytest.mark.gpu
def test_looking_at_targets_changes_no_count(rg: Rg, tmp_path: Path) -> None:
    counts = []
    for option in ([], ["--html"]):
        outcome = rg(
            "render", "compute", "--size", "64x36", "--samples", "1", "--format", "json", "-o", str(tmp_path), *option
        )
        assert outcome.code == 0, outcome.err
        counts.append(json.loads(outcome.out)["timing"]["steady_state"])
    assert counts[0] == counts[1] == dict.fromkeys(counts[0], 0)


def test_a_trace_without_samples_is_refused_before_rendering(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", "tonemap", "--trace", "--samples", "0", "-o", str(tmp_path))
    assert outcome.code == 2
    assert "RG575" in outcome.err
    assert not list(tmp_path.iterdir())


@pytest.mark.gpu
def test_bound_is_printed_recorded_and_shown(rg: Rg, tmp_path: Path) -> None:
    arguments = ("render", "case_draw_calls", "--size", "64x36", "--samples", "1", "-o", str(tmp_path))
    outcome = rg(*arguments, "--bound", "--html")
    assert outcome.code == 0, outcome.err
    bound = json.loads((tmp_path / "timing.json").read_text())["bound"]
    assert f"the frame is bound by {bound['class']}" in outcome.out
    assert "Bound by" in (tmp_path / "report.html").read_text(encoding="utf-8")
    outcome = rg(*arguments, "--html")
    assert outcome.code == 0, outcome.err
    assert json.loads((tmp_path / "timing.json").read_text())["bound"] is None
    assert "bound by" not in outcome.out
    assert "Bound by" not in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.gpu
def test_what_the_driver_warns_of_is_said_once(rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from rendergraph.device import enums
    from rendergraph.device.context import open_device
    from rendergraph.run.commands import Command

    run, debug = Command.run, open_device().debug

    def warned(command: Command) -> None:
        debug._callback(enums.DEBUG_SOURCE_API, enums.DEBUG_TYPE_UNDEFINED_BEHAVIOR, 7, 0x9147, 4, b"odd!", None)
        run(command)

    monkeypatch.setattr(Command, "run", warned)
    outcome = rg("render", "tonemap", "--size", "32x18", "--frames", "3", "-o", str(tmp_path))
    assert outcome.code == 0, outcome.err
    assert outcome.err.count("RG507") == 1
    warnings = json.loads((tmp_path / "timing.json").read_text())["driver_warnings"]
    assert [w["text"] for w in warnings] == ["odd!"]
