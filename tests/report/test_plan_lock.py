"""The plan lock: stable and small, and every change of the plan is told, the worst first."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.document.load import load_document
from rendergraph.document.messages import MESSAGES, RenderGraphError
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.lock_changes import Change, change_diagnostics, lock_changes
from rendergraph.report.plan_lock import PlanLock, lock_text, plan_lock, read_lock, write_lock
from rendergraph.report.resources import resources_record

GRAPH = "deferred_shading"


def lock_of(*overrides: str, graph: str | Path = GRAPH, **options: Any) -> PlanLock:
    """The lock of a graph's plan."""
    plan, _ = plan_without_scene(load_document(graph, overrides), PlanOptions(**options))
    return plan_lock(resources_record(plan))


def edited(**changes: Any) -> PlanLock:
    """The graph's lock with parts replaced by functions of them."""
    data = lock_of().model_dump(by_alias=True)
    for key, edit in changes.items():
        data[key] = edit(data[key])
    return PlanLock.model_validate(data)


def changes_of(**changes: Any) -> list[Change]:
    return lock_changes(lock_of(), edited(**changes))


# ---------------------------------------------------------------- the file


def test_it_reads_back_and_compares_equal(tmp_path: Path) -> None:
    path = tmp_path / "plan.lock.json"
    write_lock(path, lock_of())
    assert read_lock(path) == lock_of()
    assert lock_changes(read_lock(path), lock_of()) == []


def test_it_is_small_and_has_one_entry_a_line() -> None:
    text, lock = lock_text(lock_of()), lock_of()
    entries = len(lock.order) + len(lock.culled) + len(lock.barriers) + len(lock.slots) + len(lock.resources)
    assert entries <= len(text.splitlines()) <= entries + 20
    assert max(map(len, text.splitlines())) < 200


def test_it_names_no_path_version_or_title() -> None:
    document = load_document(GRAPH)
    text = lock_text(lock_of())
    assert str(document.path.parent) not in text
    assert document.model.title not in text
    assert "0.1.0" not in text


def test_the_order_of_the_file_changes_nothing(tmp_path: Path) -> None:
    text = load_document(GRAPH).text
    head, _, rest = text.partition("passes:\n")
    body, _, tail = rest.partition("outputs:")
    passes = ["  " + part for part in body.removeprefix("  ").split("\n  ") if part]
    groups: list[str] = []
    for line in passes:
        if not line.startswith("   "):
            groups.append(line)
        else:
            groups[-1] += "\n" + line
    path = tmp_path / "shuffled.yaml"
    path.write_text(f"# another comment\n{head}passes:\n" + "\n".join(reversed(groups)).rstrip() + f"\noutputs:{tail}")
    assert lock_text(lock_of(graph=path)) == lock_text(lock_of())


def test_the_whole_record_serves_as_a_lock(tmp_path: Path) -> None:
    plan, _ = plan_without_scene(load_document(GRAPH), PlanOptions())
    path = tmp_path / "record.json"
    path.write_text(json.dumps(resources_record(plan)))
    assert read_lock(path) == lock_of()


@pytest.mark.parametrize(
    "content",
    [
        None,
        b"",
        b"\xff\xfe",
        b"[1]",
        b"{}",
        b"[" * 100_000,
        b'{"schema": "rendergraph.timing/1"}',
        b'{"schema": "rendergraph.plan_lock/2"}',
        b'{"schema": "rendergraph.plan_lock/1"}',
        b'{"schema": "rendergraph.resources/1", "order": 3}',
        b'{"schema": ["rendergraph.plan_lock/1"]}',
        b'<<<<<<< ours\n{"schema": "rendergraph.plan_lock/1"}',
    ],
)
def test_what_is_no_lock_is_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "plan.lock.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RenderGraphError) as caught:
        read_lock(path)
    assert (caught.value.exit_code, [d.code for d in caught.value.diagnostics]) == (2, ["RG720"])
    assert caught.value.diagnostics[0].help


def test_a_lock_cut_short_or_with_wrong_types_is_refused(tmp_path: Path) -> None:
    path, text = tmp_path / "plan.lock.json", lock_text(lock_of())
    for broken in (text[: len(text) // 2], text.replace('"used": ', '"used": -'), text.replace('"order"', '"odrer"')):
        path.write_text(broken)
        with pytest.raises(RenderGraphError):
            read_lock(path)


# ---------------------------------------------------------------- changes


def test_bytes_that_grew_come_first_and_name_the_resource() -> None:
    found = lock_changes(lock_of(), lock_of("resources.hdr.format=rgba32f"))
    assert [(c.code, c.subject, c.values["what"], c.values["change"]) for c in found[:3]] == [
        ("RG721", "hdr", "used", "grew"),
        ("RG721", "hdr", "load", "grew"),
        ("RG721", "hdr", "unshared", "grew"),
    ]
    assert {c.code for c in found[3:]} == {"RG725", "RG726"}
    assert (found[0].values["after"] - found[0].values["before"]) == 1280 * 720 * 8


def test_bytes_that_shrank_come_last() -> None:
    found = lock_changes(lock_of("resources.hdr.format=rgba32f"), lock_of())
    assert [c.values.get("change") for c in found[-3:]] == ["shrank"] * 3
    assert found[0].code != "RG721"


def test_a_barrier_added_widened_and_removed() -> None:
    new = {"before": "sky.draw", "bits": ["GL_TEXTURE_FETCH_BARRIER_BIT"], "resources": ["hdr"]}
    assert [(c.code, c.subject) for c in changes_of(barriers=lambda b: [*b, new])] == [("RG722", "sky.draw")]
    wide = {**lock_of().barriers[0].model_dump()}
    wide["bits"] = [*wide["bits"], "GL_COMMAND_BARRIER_BIT"]
    (found,) = changes_of(barriers=lambda b: [wide, *b[1:]])
    assert (found.code, found.subject) == ("RG722", lock_of().barriers[0].before)
    assert "GL_COMMAND_BARRIER_BIT" in found.values["change"]
    (found,) = changes_of(barriers=lambda b: b[1:])
    assert (found.code, found.subject) == ("RG722", lock_of().barriers[0].before)
    more = changes_of(barriers=lambda b: [*b[1:], new])
    assert [c.subject for c in more] == ["sky.draw", lock_of().barriers[0].before]  # the new one is worse


def test_an_order_that_changed_names_the_fewest_that_moved() -> None:
    (found,) = changes_of(order=lambda o: [o[-1], *o[:-1]])
    assert (found.code, found.subject) == ("RG723", lock_of().order[-1])
    found_three = changes_of(order=lambda o: [*o[1:3], "glass.extra", o[0], *o[3:-1]])
    assert [(c.code, c.subject) for c in found_three] == [
        ("RG723", lock_of().order[-1]),  # gone
        ("RG723", "glass.extra"),  # new
        ("RG723", lock_of().order[0]),  # moved
    ]


@given(st.permutations(range(13)))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_taking_out_the_moved_leaves_both_orders_alike(permutation: list[int]) -> None:
    before = lock_of()
    after = edited(order=lambda o: [o[i] for i in permutation])
    moved = {c.subject for c in lock_changes(before, after)}
    assert [n for n in before.order if n not in moved] == [n for n in after.order if n not in moved]
    longest = [0] * 13  # of the ascending runs that end here: as many can stay, and no more
    for i, place in enumerate(permutation):
        longest[i] = 1 + max((longest[j] for j in range(i) if permutation[j] < place), default=0)
    assert len(moved) == 13 - max(longest)


def test_what_is_culled_is_told_once() -> None:
    name = lock_of().order[-1]
    (found,) = changes_of(order=lambda o: o[:-1], culled=lambda c: [*c, name])
    assert (found.code, found.subject) == ("RG724", name)
    (back,) = lock_changes(edited(order=lambda o: o[:-1], culled=lambda c: [*c, name]), lock_of())
    assert (back.code, back.subject) == ("RG724", name)


def test_slots_resources_and_size() -> None:
    (split,) = [c for c in changes_of(slots=lambda s: s[1:]) if c.code == "RG725"]
    assert split.subject == lock_of().slots[0].tenants[0]
    (used_longer,) = changes_of(resources=lambda r: [{**r[0], "last": "sky.draw"}, *r[1:]])
    assert (used_longer.code, used_longer.subject) == ("RG726", lock_of().resources[0].name)
    assert [c.code for c in changes_of(resources=lambda r: r[1:])] == ["RG726"]
    assert [c.code for c in changes_of(size=lambda s: [s[0], 1])] == ["RG727"]


def test_each_part_of_the_lock_is_compared() -> None:
    spoiled = {
        "size": [1, 1],
        "order": ["x"],
        "culled": ["x"],
        "bytes": {},
        "barriers": [],
        "slots": [],
        "resources": [],
    }
    assert spoiled.keys() == PlanLock.model_fields.keys() - {"version"}
    for key, value in spoiled.items():
        assert changes_of(**{key: lambda _, value=value: value}), key


def test_changes_point_at_the_file_and_every_message_can_be_made() -> None:
    document = load_document(GRAPH)
    after = edited(
        size=lambda s: [1, 1],
        order=lambda o: [*o[1:], "new.step"],
        culled=lambda c: ["sky.extra"],
        bytes=lambda b: {name: 2 * size for name, size in b.items()},
        barriers=lambda b: b[1:],
        slots=lambda s: s[1:],
        resources=lambda r: [{**entry, "bytes": entry["bytes"] + 1} for entry in r],
    )
    changes = lock_changes(lock_of(), after)
    found = change_diagnostics(changes, document, "plan.lock.json")
    assert {d.code for d in found} == {f"RG72{n}" for n in range(1, 8)}
    assert [c.rank for c in changes] == sorted(c.rank for c in changes)
    lines = document.text.splitlines()
    for change, diagnostic in zip(changes, found, strict=True):
        assert MESSAGES[diagnostic.code].severity == "error"
        assert diagnostic.position is not None
        owner = change.subject.partition(".")[0]
        if owner in document.model.passes or owner in document.model.resources:
            assert lines[diagnostic.position.line - 1].lstrip().startswith(f"{owner}:")
