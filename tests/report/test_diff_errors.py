"""Errors of two records: what rose above the floor is a regression that names pass and measure; the rest is not."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.report.diff import Comparison, DiffOptions, diff_records, require_gate
from rendergraph.report.diff_exact import Direction
from rendergraph.report.read_records import read_record
from tests.report.diff_records import resources, timing, write
from tests.report.made_up_accuracy import made_up_accuracy

BASE = made_up_accuracy()


def changed(name: str = "tonemap", /, **changes: Any) -> dict[str, Any]:
    record = copy.deepcopy(BASE)
    (entry,) = (entry for entry in record["passes"] if entry["name"] == name)
    entry["measures"][0].update(changes)
    return record


def compare(tmp_path: Path, after: dict[str, Any], before: dict[str, Any] = BASE) -> Comparison:
    return diff_records(write(tmp_path / "a.json", before), write(tmp_path / "b.json", after))


def directions(found: Comparison) -> dict[str, Direction]:
    assert all(change.kind == "error" for change in found.exact)
    return {change.subject: change.direction for change in found.exact}


def test_the_same_errors_are_no_difference(tmp_path: Path) -> None:
    found = compare(tmp_path, BASE)
    assert found.exact == ()
    assert found.compared == {"exact"}


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.05 * 1.0099, {}),
        (0.05 * 1.0101, {"tonemap.color": Direction.WORSE}),
        (0.05 * 0.98, {"tonemap.color": Direction.BETTER}),
        ("inf", {"tonemap.color": Direction.WORSE}),
        ("nan", {"tonemap.color": Direction.WORSE}),
    ],
)
def test_an_error_that_rose_by_more_than_a_hundredth(tmp_path: Path, value: Any, expected: Any) -> None:
    before = changed(value=0.05)
    found = compare(tmp_path, changed(value=value), before)
    assert directions(found) == expected
    worse = [change for change in found.exact if change.direction is Direction.WORSE]
    assert found.regressions("exact") == found.regressions("all") == worse
    assert found.regressions("time") == []
    assert all("tonemap" in change.text and "color" in change.text for change in found.exact)


@pytest.mark.parametrize(("value", "count"), [(9e-10, 0), (1.1e-9, 1)])
def test_below_the_absolute_floor_nothing_rose(tmp_path: Path, value: float, count: int) -> None:
    assert len(compare(tmp_path, changed(value=value), changed(value=0.0)).regressions("exact")) == count


def test_infinite_errors_that_stay_are_no_difference(tmp_path: Path) -> None:
    assert compare(tmp_path, changed(value="inf"), changed(value="inf")).exact == ()
    assert directions(compare(tmp_path, changed(value=0.1), changed(value="inf"))) == {
        "tonemap.color": Direction.BETTER
    }


def test_where_more_is_better_less_is_worse(tmp_path: Path) -> None:
    before = changed(metric="psnr", value=40.0)
    assert directions(compare(tmp_path, changed(metric="psnr", value=39.0), before)) == {
        "tonemap.color": Direction.WORSE
    }
    for better in (41.0, None):  # none: equal images
        found = compare(tmp_path, changed(metric="psnr", value=better), before)
        assert directions(found) == {"tonemap.color": Direction.BETTER}


def test_a_verdict_that_fell(tmp_path: Path) -> None:
    before = changed(verdict="within", value=0.05)
    assert directions(compare(tmp_path, changed(verdict="above", value=0.05), before)) == {
        "tonemap.color": Direction.WORSE
    }
    unsure = compare(tmp_path, changed(verdict="cannot_judge", value=0.05), before)
    assert directions(unsure) == {"tonemap.color": Direction.WORSE}


def test_a_wider_tolerance_and_another_metric_are_said(tmp_path: Path) -> None:
    assert directions(compare(tmp_path, changed(tolerance=0.5))) == {"tonemap.color": Direction.CHANGED}
    assert directions(compare(tmp_path, changed(metric="mean"))) == {"tonemap.color": Direction.CHANGED}


def test_a_random_passs_error_is_not_compared_but_its_verdict_is(tmp_path: Path) -> None:
    assert compare(tmp_path, changed("shadows", value=0.5)).exact == ()
    assert directions(compare(tmp_path, changed("shadows", verdict="above"))) == {"shadows.noise": Direction.WORSE}


def test_a_measure_that_is_judged_no_more_is_a_regression(tmp_path: Path) -> None:
    after = copy.deepcopy(BASE)
    after["passes"][4]["measures"] = []
    assert directions(compare(tmp_path, after)) == {"tonemap.color": Direction.WORSE}
    assert directions(compare(tmp_path, BASE, after)) == {"tonemap.color": Direction.CHANGED}


def test_invariants_that_broke(tmp_path: Path) -> None:
    after = copy.deepcopy(BASE)
    after["passes"][4]["broken"] = ["it leaks"]
    assert directions(compare(tmp_path, after)) == {"tonemap": Direction.WORSE}
    assert directions(compare(tmp_path, BASE, after)) == {"tonemap": Direction.BETTER}


def test_a_renamed_pass_is_compared_as_one(tmp_path: Path) -> None:
    after = changed(value=0.2)
    after["passes"][4]["name"] = "curve"
    assert "curve.color" in directions(compare(tmp_path, after))


def test_folders_compare_their_accuracy_too(tmp_path: Path) -> None:
    for side, value in (("a", 0.05), ("b", 0.06)):
        write(tmp_path / side / "timing.json", timing())
        write(tmp_path / side / "resources.json", resources())
        write(tmp_path / side / "accuracy.json", changed(value=value))
    found = diff_records(str(tmp_path / "a"), str(tmp_path / "b"))
    assert directions(found) == {"tonemap.color": Direction.WORSE}
    (tmp_path / "b" / "accuracy.json").unlink()
    assert diff_records(str(tmp_path / "a"), str(tmp_path / "b")).exact == ()


def test_another_renderer_or_size_is_not_compared_unless_forced(tmp_path: Path) -> None:
    for change in ({"size": [1, 1]}, {"device": BASE["device"] | {"renderer": "other"}}):
        after = changed(value=0.2) | change
        with pytest.raises(RenderGraphError) as refused:
            compare(tmp_path, after)
        assert [d.code for d in refused.value.diagnostics] == ["RG736"]
        forced = diff_records(str(tmp_path / "a.json"), str(tmp_path / "b.json"), DiffOptions(force=True))
        assert directions(forced) == {"tonemap.color": Direction.WORSE}
        assert [d.code for d in forced.warnings] == ["RG739"]


def test_a_gate_of_times_has_nothing_to_judge(tmp_path: Path) -> None:
    require_gate(compare(tmp_path, BASE), "exact")
    with pytest.raises(RenderGraphError):
        require_gate(compare(tmp_path, BASE), "time")


# ---- reading


def refused(path: Path, text: str) -> str:
    path.write_text(text)
    with pytest.raises(RenderGraphError) as caught:
        read_record(str(path))
    return caught.value.diagnostics[0].code


def test_records_that_are_none_are_refused(tmp_path: Path) -> None:
    text = json.dumps(BASE)
    path = tmp_path / "accuracy.json"
    assert refused(path, text[: len(text) // 2]) == "RG731"
    assert refused(path, json.dumps(BASE | {"schema": "rendergraph.accuracy/2"})) == "RG733"
    assert refused(path, json.dumps(BASE | {"schema": "somebody.accuracy/1"})) == "RG732"


@pytest.mark.parametrize(
    "spoil",
    [
        lambda r: r.pop("passes"),
        lambda r: r.pop("device"),
        lambda r: r["passes"].append(r["passes"][0]),
        lambda r: r["passes"][0]["measures"].append(r["passes"][0]["measures"][0]),
        lambda r: r["passes"][4]["measures"][0].update(value="bad"),
        lambda r: r["passes"][4]["measures"][0].update(value=True),
        lambda r: r["passes"][4]["measures"][0].update(value=float("nan")),
        lambda r: r["passes"][4]["measures"][0].update(tolerance=None),
        lambda r: r["passes"][4]["measures"][0].update(verdict="fine"),
        lambda r: r["passes"][4].update(name="\x1b[2Jcleared"),
    ],
)
def test_a_record_against_its_schema(tmp_path: Path, spoil: Any) -> None:
    record = copy.deepcopy(BASE)
    spoil(record)
    assert refused(tmp_path / "accuracy.json", json.dumps(record)) == "RG734"


def test_a_folders_accuracy_of_another_kind(tmp_path: Path) -> None:
    write(tmp_path / "resources.json", resources())
    write(tmp_path / "accuracy.json", resources())
    with pytest.raises(RenderGraphError) as caught:
        read_record(str(tmp_path))
    assert caught.value.diagnostics[0].code == "RG732"
