"""Real changes of a real graph are found exactly, named, and told apart by direction."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from rendergraph.report.diff import Comparison, DiffOptions, compare_records, diff_records
from rendergraph.report.diff_exact import Direction, ExactChange
from rendergraph.report.read_records import read_record
from tests.report.diff_records import resources, timing, write


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
