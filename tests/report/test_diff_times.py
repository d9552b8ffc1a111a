"""Times between records: verdicts by pass, gates, and records that must not be compared."""

from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import FRAME, DiffOptions, diff_records, require_gate
from tests.report.diff_records import bench, resources, samples, timing, write


def refused(*places: str, options: DiffOptions | None = None) -> tuple[str, dict[str, Any]]:
    """The code and data of a refusal."""
    with pytest.raises(RenderGraphError) as caught:
        diff_records(*places, options=options)
    assert caught.value.exit_code == 2
    (found,) = caught.value.diagnostics
    return found.code, found.data


def test_the_slower_pass_is_named_first(tmp_path: Path) -> None:
    before = write(tmp_path / "a.json", timing({"light": samples(2.0), "sky": samples(1.0, seed=2)}))
    slow = {"light": samples(2.0, seed=3), "sky": samples(1.3, seed=4)}
    after = write(tmp_path / "b.json", timing(slow, frame=samples(3.3, seed=5)))
    found = diff_records(before, after)
    assert [(entry.name, entry.change.verdict) for entry in found.times] == [
        ("sky", Verdict.SLOWER),
        (FRAME, Verdict.SLOWER),
        ("light", Verdict.UNCHANGED),
    ]
    sky = found.times[0]
    assert sky.node == "sky_node"
    assert sky.change.relative == pytest.approx(0.3, abs=0.01)
    assert sky.change.method == "mann_whitney"
    assert found.regressions("exact") == []
    assert len(found.regressions("time")) == 2
    back = diff_records(after, before)
    assert back.regressions() == []
    assert back.times[0].change.verdict is Verdict.FASTER


def test_interleaved_sides_are_compared_in_pairs(tmp_path: Path) -> None:
    found = diff_records(write(tmp_path / "bench.json", bench(1.15)))
    verdicts = {entry.name: entry.change.verdict for entry in found.times}
    assert verdicts == {
        "light.shade": Verdict.SLOWER,
        "light": Verdict.SLOWER,
        FRAME: Verdict.SLOWER,
        "light.cull": Verdict.UNCHANGED,
        "sky": Verdict.UNCHANGED,
    }
    assert all(entry.change.method in ("signed_rank", "clustered_t") for entry in found.times)
    assert found.times[0].change.compared == 30
    assert diff_records(write(tmp_path / "same.json", bench())).regressions() == []


def test_sides_of_two_bench_files(tmp_path: Path) -> None:
    one, two = write(tmp_path / "one.json", bench(sides="A")), write(tmp_path / "two.json", bench(1.3))
    slow = {e.name: e.change.verdict for e in diff_records(one, f"{two}@B").times}
    assert slow["light"] is Verdict.SLOWER
    assert not diff_records(one, f"{two}@A").regressions()


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("clock", {"clock": {"name": "gpu_timestamp"}}),
        ("renderer", {"device": {"renderer": "NVIDIA H200"}}),
        ("driver", {"device": {"driver": "Mesa 25.0"}}),
        ("cpu", {"device": {"cpu": "another"}}),
        ("threads", {"device": {"threads": 8}}),
        ("threads", {"device": {"threads": None}}),
        ("size", {"size": [128, 36]}),
    ],
)
def test_other_conditions_are_refused_by_name(tmp_path: Path, field: str, changes: dict[str, Any]) -> None:
    before, after = timing(), timing()
    for key, value in changes.items():
        after[key] = {**after[key], **value} if isinstance(value, dict) else value
    places = write(tmp_path / "a.json", before), write(tmp_path / "b.json", after)
    code, data = refused(*places)
    assert (code, data["fields"]) == ("RG736", field)
    forced = diff_records(*places, options=DiffOptions(force=True))
    assert [d.code for d in forced.warnings] == ["RG739"]
    assert forced.times


def test_all_differing_fields_are_named_at_once(tmp_path: Path) -> None:
    after = timing(size=[1, 1], clock={"name": "gpu_timestamp"})
    _, data = refused(write(tmp_path / "a.json", timing()), write(tmp_path / "b.json", after))
    assert data["fields"] == "clock, size"


def test_a_driver_is_told_by_its_version_where_no_driver_is_named(tmp_path: Path) -> None:
    before, after = timing(), timing()
    for record, version in ((before, "4.5 Mesa 22"), (after, "4.5 Mesa 23")):
        del record["device"]["driver"]
        record["device"]["version"] = version
    assert refused(write(tmp_path / "a.json", before), write(tmp_path / "b.json", after))[1]["fields"] == "driver"


def test_resources_compare_whatever_ran_them_but_not_at_another_size(tmp_path: Path) -> None:
    record = resources()
    a, b = write(tmp_path / "a.json", record), write(tmp_path / "b.json", {**record, "size": [8, 8]})
    assert refused(a, b)[1]["fields"] == "size"


def test_nothing_in_common(tmp_path: Path) -> None:
    a, b = write(tmp_path / "a.json", timing()), write(tmp_path / "b.json", resources())
    assert refused(a, b)[0] == "RG737"


@pytest.mark.parametrize("count", [0, 1, 5])
def test_too_few_samples_are_said_and_judged_inconclusive(tmp_path: Path, count: int) -> None:
    few = timing({"light": samples(2.0, count)}, frame=samples(3.0, count))
    slow = timing({"light": samples(9.0)}, frame=samples(9.0))
    places = write(tmp_path / "a.json", few), write(tmp_path / "b.json", slow)
    for found in (diff_records(*places), diff_records(*reversed(places))):
        assert {e.change.verdict for e in found.times} == {Verdict.INCONCLUSIVE}
        (warning,) = found.warnings
        assert (warning.code, warning.data["samples"]) == ("RG738", count)
        assert found.regressions() == []


def test_few_samples_of_one_pass_leave_the_others_judged(tmp_path: Path) -> None:
    a = write(tmp_path / "a.json", timing({"light": samples(2.0), "sky": samples(1.0, 3)}))
    b = write(tmp_path / "b.json", timing({"light": samples(3.0), "sky": samples(1.0, 3)}))
    found = diff_records(a, b)
    verdicts = {entry.name: entry.change.verdict for entry in found.times}
    assert verdicts == {"light": Verdict.SLOWER, "sky": Verdict.INCONCLUSIVE, FRAME: Verdict.UNCHANGED}
    assert found.warnings[0].data["name"] == "sky"


def test_passes_of_one_side_are_reported_and_not_judged(tmp_path: Path) -> None:
    a = write(tmp_path / "a.json", timing({"light": samples(2.0), "old": samples(1.0)}))
    b = write(tmp_path / "b.json", timing({"light": samples(2.0), "new": samples(9.0)}))
    found = diff_records(a, b)
    assert {entry.name for entry in found.times} == {FRAME, "light"}
    assert {c.subject for c in found.exact if c.kind == "pass"} == {"old", "new"}


def test_a_renamed_pass_is_still_judged(tmp_path: Path) -> None:
    before = timing({"light": samples(2.0), "sky": samples(1.0)})
    after = timing({"shade": samples(3.0), "sky": samples(1.0)})
    after["passes"][0]["node"] = "light_node"
    found = diff_records(write(tmp_path / "a.json", before), write(tmp_path / "b.json", after))
    assert found.times[0].name == "shade"
    assert found.times[0].change.verdict is Verdict.SLOWER


def test_a_gate_that_nothing_can_fail_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.json", resources())
    found = diff_records(path, path)
    require_gate(found, "exact")
    require_gate(found, "all")
    with pytest.raises(RenderGraphError) as caught:
        require_gate(found, "time")
    assert [d.code for d in caught.value.diagnostics] == ["RG737"]
