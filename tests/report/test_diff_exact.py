"""Real changes of a real graph are found exactly, named, and told apart by direction."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import Comparison, DiffOptions, compare_records, diff_records
from rendergraph.report.diff_exact import Direction, ExactChange
from rendergraph.report.read_records import read_record
from tests.report.diff_records import bench, resources, samples, timing, write


def compare(tmp_path: Path, before: dict[str, Any], after: dict[str, Any]) -> Comparison:
    """Two records compared by their files."""
    return diff_records(write(tmp_path / "a.json", before), write(tmp_path / "b.json", after))


def by_kind(found: Comparison, kind: str) -> dict[str, ExactChange]:
    """The differences of a kind by subject."""
    return {change.subject: change for change in found.exact if change.kind == kind}


def test_the_same_graph_has_no_difference(tmp_path: Path) -> None:
    found = compare(tmp_path, resources(), resources())
    assert found.exact == ()
    assert found.compared == {"exact"}
    assert found.regressions() == []


def test_a_doubled_format_is_named_with_its_bytes(tmp_path: Path) -> None:
    before = resources()
    old = {r["name"]: r for r in before["resources"]}
    name = next(n for n, r in old.items() if r["desc"].get("format") == "rgba16f" and r["kind"] == "transient")
    found = compare(tmp_path, before, resources(f"resources.{name}.format=rgba32f"))
    change = by_kind(found, "resource")[name]
    assert change.direction is Direction.WORSE
    assert (change.before, change.after) == (old[name]["bytes"], 2 * old[name]["bytes"])
    assert change in found.regressions("exact")
    back = compare(tmp_path, resources(f"resources.{name}.format=rgba32f"), before)
    assert by_kind(back, "resource")[name].direction is Direction.BETTER


def test_a_knob_raised(tmp_path: Path) -> None:
    """Four times the shadow map's texels."""
    found = compare(tmp_path, resources(), resources("resources.shadow.fixed=[4096, 4096]"))
    change = by_kind(found, "resource")["shadow"]
    assert change.direction is Direction.WORSE
    assert change.after == 4 * change.before
    assert found.exact[0].subject == "used"  # worst first
    assert found.exact[0].direction is Direction.WORSE


def test_memory_sharing_lost(tmp_path: Path) -> None:
    found = compare(tmp_path, resources(), resources(alias=False))
    assert by_kind(found, "total")["used"].direction is Direction.WORSE
    assert by_kind(found, "sharing")


def test_a_widened_barrier_names_the_bits(tmp_path: Path) -> None:
    before, after = resources(), resources()
    barrier = after["barriers"][0]
    added = next(bit for bit in (0x40, 0x20, 0x8) if not barrier["bits"] & bit)
    names = {
        0x40: "GL_COMMAND_BARRIER_BIT",
        0x20: "GL_SHADER_IMAGE_ACCESS_BARRIER_BIT",
        0x8: "GL_TEXTURE_FETCH_BARRIER_BIT",
    }
    barrier["bits"] |= added
    barrier["names"].append(names[added])
    (change,) = compare(tmp_path, before, after).exact
    assert (change.kind, change.subject, change.direction) == ("barrier", barrier["before"], Direction.WORSE)
    assert set(change.after) - set(change.before) == {names[added]}
    (change,) = compare(tmp_path, after, before).exact
    assert change.direction is Direction.BETTER


def test_barriers_without_names_are_compared_by_bits(tmp_path: Path) -> None:
    before = resources()
    for barrier in before["barriers"]:
        del barrier["names"]
    after = copy.deepcopy(before)
    after["barriers"][0]["texture_barrier"] ^= True
    del after["barriers"][1]
    found = by_kind(compare(tmp_path, before, after), "barrier")
    assert set(found) == {before["barriers"][0]["before"], before["barriers"][1]["before"]}
    assert found[before["barriers"][1]["before"]].direction is Direction.BETTER


def test_order_moved(tmp_path: Path) -> None:
    before, after = resources(), resources()
    moved = after["order"].pop(1)
    after["order"].insert(3, moved)
    (change,) = by_kind(compare(tmp_path, before, after), "order").values()
    assert change.direction is Direction.CHANGED
    assert change.subject == moved


def test_culled_and_no_longer_culled(tmp_path: Path) -> None:
    before, after = resources(), resources()
    name = before["order"][-1]
    before["order"].remove(name)
    before["culled"].append(name)
    found = by_kind(compare(tmp_path, before, after), "culled")
    assert found[name].direction is Direction.WORSE
    found = by_kind(compare(tmp_path, after, before), "culled")
    assert found[name].direction is Direction.CHANGED


def test_resources_that_come_and_go(tmp_path: Path) -> None:
    before, after = resources(), resources()
    gone = before["resources"][0]["name"]
    after["resources"][0]["name"] = "newcomer"
    found = by_kind(compare(tmp_path, before, after), "resource")
    assert found[gone].after is None
    assert found["newcomer"].before is None


def test_draws_and_steady_state_of_timing_records(tmp_path: Path) -> None:
    before, after = timing(), timing()
    after["passes"][0]["counters"]["draws"] = 6
    after["steady_state"]["objects_created"] = 2
    found = compare(tmp_path, before, after)
    counter = by_kind(found, "counter")["light.draws"]
    assert (counter.direction, counter.before, counter.after) == (Direction.WORSE, 3, 6)
    assert by_kind(found, "steady_state")["objects_created"].direction is Direction.WORSE
    assert len(found.exact) == 2
    assert {c.direction for c in compare(tmp_path, after, before).exact} == {Direction.BETTER}


def test_a_new_pass_raises_the_draws_of_the_frame(tmp_path: Path) -> None:
    before = timing()
    after = copy.deepcopy(before)
    after["passes"].append({**after["passes"][0], "name": "glow", "node": "glow"})
    found = compare(tmp_path, before, after)
    assert by_kind(found, "pass")["glow"].before is None
    assert by_kind(found, "counter")["whole frame.draws"].direction is Direction.WORSE
    assert [entry.name for entry in found.times if entry.name == "glow"] == []


def test_a_renamed_pass_takes_its_subpasses_and_resources_along(tmp_path: Path) -> None:
    before_folder, after_folder = tmp_path / "a", tmp_path / "b"
    record = resources()
    text = json.dumps(record)
    renamed = json.loads(text.replace('"meter', '"gauge'))
    passes = dict.fromkeys(dict.fromkeys(name.split(".")[0] for name in record["order"]), [1.0] * 20)
    times = timing(passes)
    write(before_folder / "timing.json", times)
    write(before_folder / "resources.json", record)
    changed = json.loads(json.dumps(times).replace('"name": "meter"', '"name": "gauge"'))
    write(after_folder / "timing.json", changed)
    write(after_folder / "resources.json", renamed)
    assert any(name.startswith("meter.") for name in record["order"])
    found = diff_records(str(before_folder), str(after_folder))
    (change,) = found.exact
    assert (change.kind, change.before, change.after) == ("pass", "meter", "gauge")
    assert found.regressions() == []
    assert "gauge" in [entry.name for entry in found.times]


@pytest.mark.parametrize("total", ["used", "load", "placed", "view_pool", "exact_pool", "unshared"])
def test_only_memory_in_use_is_a_regression(tmp_path: Path, total: str) -> None:
    before, after = resources(), resources()
    after["totals"][total] += 256
    (change,) = compare(tmp_path, before, after).exact
    assert (change.kind, change.subject) == ("total", total)
    assert change.direction is (Direction.WORSE if total == "used" else Direction.CHANGED)


def test_worst_first(tmp_path: Path) -> None:
    before, after = resources(), resources()
    after["totals"]["used"] -= 256
    after["totals"]["load"] -= 256
    after["resources"][3]["bytes"] += 1000
    after["order"][1], after["order"][0] = after["order"][0], after["order"][1]
    kinds = [change.direction for change in compare(tmp_path, before, after).exact]
    assert kinds == sorted(kinds, key=[Direction.WORSE, Direction.CHANGED, Direction.BETTER].index)
    assert kinds[0] is Direction.WORSE
    assert kinds[-1] is Direction.BETTER


def test_records_can_be_compared_without_files(tmp_path: Path) -> None:
    record = read_record(write(tmp_path / "a.json", resources()))
    assert compare_records(record, record, DiffOptions()).exact == ()


def test_another_node_under_the_same_name_is_said(tmp_path: Path) -> None:
    before, after = timing(), timing()
    after["passes"][0]["node"] = "clustered"
    (change,) = compare(tmp_path, before, after).exact
    assert (change.kind, change.subject, change.before, change.after) == ("pass", "light", "light_node", "clustered")


# ---- sub-passes and bounds


def divided(opaque: list[float], masked: list[float], draws: int = 3, name: str = "light") -> dict[str, Any]:
    """A timing record whose pass has two sub-passes, and another pass that has one."""
    record = timing({name: [a + b for a, b in zip(opaque, masked, strict=True)], "sky": samples(1.0)})
    steps = {"opaque": (opaque, draws), "masked": (masked, 6 - draws)}
    record["passes"][0]["node"] = "light_node"
    record["passes"][0]["subpasses"] = [
        {"name": f"{name}.{step}", "ms": {"samples": values}, "counters": {"draws": count}}
        for step, (values, count) in steps.items()
    ]
    sky = record["passes"][1]
    sky["subpasses"] = [{"name": "sky.draw", "ms": sky["ms"], "counters": dict(sky["counters"])}]
    return record


@pytest.mark.parametrize("name", ["light", "shade"])
def test_a_slower_subpass_is_named_also_where_its_pass_was_renamed(tmp_path: Path, name: str) -> None:
    before = divided(samples(2.0), samples(0.5, seed=2))
    after = divided(samples(2.0, seed=3), samples(0.6, seed=4), name=name)
    verdicts = {entry.name: entry.change.verdict for entry in compare(tmp_path, before, after).times}
    assert verdicts[f"{name}.masked"] is Verdict.SLOWER
    assert verdicts[f"{name}.opaque"] is Verdict.UNCHANGED
    assert "sky.draw" not in verdicts, "the only sub-pass is its pass"
    assert set(verdicts) == {"", name, f"{name}.opaque", f"{name}.masked", "sky"}


def test_only_subpasses_of_both_sides_are_compared(tmp_path: Path) -> None:
    """A node that does in one sub-pass now what took two: the one they have in common is compared."""
    before, after = divided(samples(2.0), samples(0.5)), divided(samples(2.5), samples(0.5))
    after["passes"][0]["subpasses"].pop()
    found = compare(tmp_path, before, after)
    assert {entry.name for entry in found.times if "." in entry.name} == {"light.opaque"}
    back = compare(tmp_path, after, before)
    assert {entry.name for entry in back.times if "." in entry.name} == {"light.opaque"}


def test_draws_moved_between_subpasses_are_told_and_no_regression(tmp_path: Path) -> None:
    before, after = (divided(samples(2.0), samples(0.5), draws) for draws in (3, 4))
    found = compare(tmp_path, before, after)
    counters = by_kind(found, "counter")
    assert set(counters) == {"light.opaque.draws", "light.masked.draws"}
    assert {change.direction for change in counters.values()} == {Direction.CHANGED}
    assert found.regressions() == []


def test_records_without_subpasses_compare_as_before(tmp_path: Path) -> None:
    found = compare(tmp_path, timing(), divided(samples(2.0), samples(0.5)))
    assert not any("." in entry.name for entry in found.times)


def bound(by: str, agreement: float = 1.0) -> dict[str, Any]:
    return {"class": by, "agreement": agreement}


def test_another_bound_is_noted_and_fails_no_gate(tmp_path: Path) -> None:
    found = compare(tmp_path, timing(bound=bound("draw_calls", 0.86)), timing(bound=bound("gpu")))
    (change,) = by_kind(found, "bound").values()
    assert (change.before, change.after, change.direction) == ("draw_calls", "gpu", Direction.CHANGED)
    assert "86 %" in change.text
    assert "100 %" in change.text
    assert found.regressions() == []


@pytest.mark.parametrize("other", [{"bound": bound("gpu", 0.4)}, {"bound": None}, {}])
def test_the_same_bound_or_an_unknown_one_is_no_difference(tmp_path: Path, other: dict[str, Any]) -> None:
    assert by_kind(compare(tmp_path, timing(bound=bound("gpu")), timing(**other)), "bound") == {}


def test_bounds_of_a_bench_file_s_sides(tmp_path: Path) -> None:
    record = {**bench(), "bound": {"A": bound("sync"), "B": bound("gpu")}}
    found = diff_records(write(tmp_path / "b.json", record))
    assert [(c.before, c.after) for c in by_kind(found, "bound").values()] == [("sync", "gpu")]


def test_a_broken_bound_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RenderGraphError) as caught:
        compare(tmp_path, timing(bound=bound("gpu", 3.0)), timing())
    assert [d.code for d in caught.value.diagnostics] == ["RG734"]
