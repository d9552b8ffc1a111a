"""`rg stress` finds what was made to fail, at the texel where it does, and lets healthy twins pass."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.stress.outcome import CaseOutcome, PassOutcome
from rendergraph.measure.stress.stress import StressOptions, StressReport, stress
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Extreme
from rendergraph.report.stress import stress_findings, stress_record
from rendergraph.report.stress_shape import StressRecord
from tests.measure.stress.bad_graphs import READS, write_one, write_pair, write_reader

pytestmark = pytest.mark.gpu


def run(target: Path | str, *only: str, size: tuple[int, int] | None = (16, 8), isolate: bool = False) -> StressReport:
    """In this process, unless told."""
    return stress(str(target), StressOptions(only=only, size=size, isolate=isolate))


def outcome(report: StressReport, case: str, name: str = "test") -> PassOutcome:
    """Of a pass at an extreme."""
    found: CaseOutcome = next(c for c in report.cases if c.name == case)
    return next(entry for entry in found.passes if entry.name == name)


@pytest.mark.parametrize(
    ("name", "case", "texel"),
    [
        ("width_minus_one", "frame_1x1", (0, 0)),
        ("zero_vector", "frame_odd", (18, 11)),
        ("overflow", "frame_8191x1", (1000, 0)),
    ],
)
def test_mistakes_are_found_at_their_texel(tmp_path: Path, name: str, case: str, texel: tuple[int, int]) -> None:
    bad, healthy = write_pair(tmp_path, name)
    report = run(bad, "as_written", case)
    assert outcome(report, "as_written").status == "pass"
    found = outcome(report, case)
    assert found.status == "fail"
    assert [f.check for f in found.failures] == ["finite"]
    at = found.failures[0].texel
    assert at is not None
    assert (at.port, at.x, at.y) == ("color", *texel)
    assert not all(map(math.isfinite, at.value))
    assert not run(healthy, "as_written", case).failed


@pytest.mark.parametrize("case", ["nan_texels", "inf_texels"])
def test_what_is_let_through_is_found_with_its_inputs(tmp_path: Path, case: str) -> None:
    found = outcome(run(write_reader(tmp_path, "reader", READS[0]), case), case)
    assert found.status == "fail"
    at = found.failures[0].texel
    assert at is not None
    assert (at.x, at.y) == (0, 0)  # the lower left one of the four
    assert not any(map(math.isfinite, at.inputs["u_in"]))
    assert "4 of 128" in found.failures[0].text
    assert outcome(run(write_reader(tmp_path, "healthy", READS[1]), case), case).status == "pass"


def test_what_comes_in_bad_is_not_blamed_on_who_reads_it(tmp_path: Path) -> None:
    file = write_reader(tmp_path, "reader", READS[0])
    (tmp_path / "plain.frag").write_text((tmp_path / "plain.frag").read_text().replace("0.25", "1e30 * 1e30"))
    report = run(file, "as_written")
    assert outcome(report, "as_written", "source").status == "fail"
    assert outcome(report, "as_written").status == "inherited"
    assert {d.data["name"] for d in stress_findings(report)} == {"source"}


@pytest.fixture
def declare(monkeypatch: pytest.MonkeyPatch):  # type: ignore[no-untyped-def]
    """Give the fullscreen node other extremes."""

    def change(*extremes: Extreme) -> None:
        monkeypatch.setattr(find_node("fullscreen"), "extremes", extremes)

    return change


def test_a_check_may_be_left_out_with_a_reason(tmp_path: Path, declare) -> None:  # type: ignore[no-untyped-def]
    bad, _ = write_pair(tmp_path, "width_minus_one")
    declare(Extreme("frame_1x1", "", skips={"finite": "for the test"}))
    found = outcome(run(bad, "frame_1x1"), "frame_1x1")
    assert (found.status, found.skipped["finite"]) == ("pass", "for the test")


def test_a_declared_refusal_passes_and_a_missing_or_another_one_fails(tmp_path: Path, declare) -> None:  # type: ignore[no-untyped-def]
    broken = write_one(tmp_path, "broken", "out vec4 color;\nvoid main() { color = nothing; }\n")
    assert [(c.state, c.code, c.failed) for c in run(broken, "frame_1x1").cases] == [("failed", "RG515", True)]
    declare(Extreme("frame_1x1", "", refused="RG515"))
    assert [(c.state, c.code, c.failed) for c in run(broken, "frame_1x1").cases] == [("refused", "RG515", False)]
    _, healthy = write_pair(tmp_path, "overflow")
    report = run(healthy, "frame_1x1")
    assert [(c.state, c.failed) for c in report.cases] == [("not_refused", True)]
    assert [d.code for d in stress_findings(report)] == ["RG767"]


def test_one_failing_extreme_does_not_stop_the_others(tmp_path: Path, declare) -> None:  # type: ignore[no-untyped-def]
    bad, _ = write_pair(tmp_path, "width_minus_one")

    class BrokenError(Exception):
        pass

    def build(self: object, b: object) -> None:
        raise BrokenError("on purpose")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(find_node("fullscreen"), "build", build)
        first = run(bad, "as_written", "frame_1x1")
    assert [c.state for c in first.cases] == ["failed", "failed"]
    assert "on purpose" in first.cases[0].text
    assert [d.code for d in stress_findings(first)] == ["RG766", "RG766"]
    assert not run(bad, "as_written").failed


def test_own_extremes_are_tried_on_the_nodes_own_graph_alone(tmp_path: Path) -> None:
    own = {c.name for c in run("tonemap", "as_written", "darkest").cases}
    assert own == {"as_written", "darkest"}
    with pytest.raises(RenderGraphError) as raised:
        run(write_pair(tmp_path, "overflow")[0], "darkest")
    assert raised.value.diagnostics[0].code == "RG769"


@pytest.mark.parametrize(("target", "code"), [("tonemapp", "RG768"), ("no/such.yaml", "RG100")])
def test_unknown_targets(target: str, code: str) -> None:
    with pytest.raises(RenderGraphError) as raised:
        run(target)
    assert (raised.value.diagnostics[0].code, raised.value.exit_code) == (code, 2)


def test_the_record_has_its_shape_and_survives_json(tmp_path: Path) -> None:
    report = run(write_pair(tmp_path, "width_minus_one")[0], "frame_1x1", "fov_1")
    record = json.loads(json.dumps(stress_record(report), allow_nan=False))
    StressRecord.model_validate(record)
    assert record["counts"] == {"extremes": 2, "failed": 1, "refused": 0, "not_applicable": 1}
    assert "nan" in record["extremes"][0]["passes"][0]["failures"][0]["texel"]["value"]
    with pytest.raises(ValueError, match="extra"):
        StressRecord.model_validate({**record, "surprise": 1})
    assert [CaseOutcome.from_json(json.loads(json.dumps(c.to_json()))).failed for c in report.cases] == [True, False]
