"""Records that are no records: a code for each, and never a verdict."""

import json
from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.report.diff import diff_records
from rendergraph.report.read_records import read_pair, read_record
from tests.report.diff_records import bench, resources, timing, write


def refused(place: str | Path) -> str:
    """The code with which a record is refused; the exit code is that of unreadable input."""
    with pytest.raises(RenderGraphError) as caught:
        read_record(str(place))
    assert caught.value.exit_code == 2
    (found,) = caught.value.diagnostics
    return found.code


def test_nothing_there(tmp_path: Path) -> None:
    assert refused(tmp_path / "gone.json") == "RG730"
    assert refused(tmp_path / "gone" / "gone.json") == "RG730"
    (tmp_path / "empty").mkdir()
    assert refused(tmp_path / "empty") == "RG730"
    assert refused("/dev/null") == "RG730"


@pytest.mark.parametrize(
    "content",
    [b"", b"{", b'{"schema": "rendergraph.timing/1", "size', b"\xff\xfe\x00", b"[" * 100_000, b"{} {}", b"nul"],
)
def test_what_is_not_json(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "timing.json"
    path.write_bytes(content)
    assert refused(path) == "RG731"
    assert refused(tmp_path) == "RG731"


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
def test_a_truncated_record_points_at_its_end(tmp_path: Path, share: float) -> None:
    text = json.dumps(timing(), indent=1)
    path = tmp_path / "timing.json"
    path.write_text(text[: int(len(text) * share)])
    with pytest.raises(RenderGraphError) as caught:
        read_record(str(path))
    (found,) = caught.value.diagnostics
    assert found.code == "RG731"
    assert found.position is not None
    assert found.position.line > 1


@pytest.mark.parametrize(
    "data",
    [
        [],
        3,
        {},
        {"schema": 1},
        {"schema": "other/1"},
        {"schema": "rendergraph.flip/1"},
        {"schema": "rendergraph.timing/x"},
    ],
)
def test_foreign_json(tmp_path: Path, data: Any) -> None:
    path = tmp_path / "timing.json"
    path.write_text(json.dumps(data))
    assert refused(path) == "RG732"


def test_a_record_of_another_kind_in_the_folder(tmp_path: Path) -> None:
    write(tmp_path / "timing.json", resources())
    assert refused(tmp_path) == "RG732"


@pytest.mark.parametrize("kind", ["timing", "resources", "bench"])
def test_a_newer_schema(tmp_path: Path, kind: str) -> None:
    assert refused(write(tmp_path / "r.json", {"schema": f"rendergraph.{kind}/2"})) == "RG733"


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), float("-inf"), -1e-9, -5.0])
@pytest.mark.parametrize("where", ["frame", "pass", "block"])
def test_a_sample_that_is_no_time(tmp_path: Path, bad: float, where: str) -> None:
    record = bench() if where == "block" else timing()
    if where == "frame":
        record["frame_ms"]["samples"][3] = bad
    elif where == "pass":
        record["passes"][1]["ms"]["samples"][0] = bad
    else:
        record["blocks"][7]["B"]["passes"]["sky"][2] = bad
    path = write(tmp_path / "r.json", record)
    with pytest.raises(RenderGraphError) as caught:
        read_pair(path) if where == "block" else read_record(path)
    (found,) = caught.value.diagnostics
    assert found.code == "RG735"
    assert {"frame": "3", "pass": "sky", "block": "sky"}[where] in found.data["where"] or where == "pass"


@pytest.mark.parametrize(
    "changes",
    [
        {"clock": {}},
        {"clock": None},
        {"device": []},
        {"size": [1]},
        {"size": ["a", 1]},
        {"passes": {}},
        {"passes": [{"name": 1}]},
        {"frame_ms": {"samples": ["1.0"]}},
        {"frame_ms": {"samples": [True]}},
        {"frame_ms": {"samples": None}},
        {"steady_state": {"objects_created": -1}},
        {"passes": [{"name": "a"}, {"name": "a"}]},
        {"passes": [{"name": "a", "counters": {"draws": 1.5}}]},
        {"passes": [{"name": "\x1b[2Jcleared"}]},
        {"passes": [{"name": "a\n::error::forged"}]},
    ],
)
def test_a_record_against_its_schema(tmp_path: Path, changes: dict[str, Any]) -> None:
    assert refused(write(tmp_path / "timing.json", {**timing(), **changes})) == "RG734"


@pytest.mark.parametrize("key", ["order", "totals", "resources", "barriers", "slots"])
def test_resources_with_a_part_missing(tmp_path: Path, key: str) -> None:
    record = resources()
    del record[key]
    assert refused(write(tmp_path / "r.json", record)) == "RG734"
    record[key] = {"used": -1} if key == "totals" else [{}]
    assert refused(write(tmp_path / "r.json", record)) == "RG734"


def test_bench_files_whose_blocks_do_not_fit(tmp_path: Path) -> None:
    for spoil in (
        lambda r: r["blocks"][0].pop("B"),
        lambda r: r["sides"].pop("B"),
        lambda r: r["sides"].pop("A"),
        lambda r: r["blocks"][0]["A"]["passes"].update(stranger=[1.0]),
        lambda r: r["blocks"][0]["A"]["subpasses"].update({"light.stranger": [1.0]}),
        lambda r: r["blocks"][0].pop("process"),
    ):
        record = json.loads(json.dumps(bench()))
        spoil(record)
        assert refused(write(tmp_path / "r.json", record) + "@A") == "RG734"


def test_sides_of_a_bench_file(tmp_path: Path) -> None:
    two, one = write(tmp_path / "two.json", bench(1.5)), write(tmp_path / "one.json", bench(sides="A"))
    a, b = read_pair(two)
    assert a.times is not None
    assert b.times is not None
    assert a.times.passes["light"].runs.processes == tuple(p for p in range(10) for _ in range(3))
    assert len(b.times.frame.samples) == 30
    assert list(b.times.steps) == ["light.cull", "light.shade", "sky.draw"]
    assert b.times.steps["light.cull"].runs.count == b.times.passes["light"].runs.count == 150
    assert read_record(f"{two}@B").times is not None
    assert read_record(one).times is not None
    assert refused(two) == "RG737"  # which side?
    assert refused(f"{one}@B") == "RG737"


@pytest.mark.parametrize("name", ["one.json", "timing.json", "resources.json", "folder"])
def test_alone_only_a_bench_file_of_two_sides_can_be_compared(tmp_path: Path, name: str) -> None:
    write(tmp_path / "one.json", bench(sides="A"))
    write(tmp_path / "timing.json", timing())
    write(tmp_path / "resources.json", resources())
    write(tmp_path / "folder" / "timing.json", timing())
    with pytest.raises(RenderGraphError) as caught:
        diff_records(str(tmp_path / name))
    assert [d.code for d in caught.value.diagnostics] == ["RG737"]


def test_a_folder_holds_records_and_images(tmp_path: Path) -> None:
    write(tmp_path / "timing.json", timing())
    for name in ("b.png", "sub/a.npy", "page.html", "notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    found = read_record(str(tmp_path))
    assert sorted(found.images) == ["b.png", "sub/a.npy"]
    assert found.resources is None
    assert found.times is not None


def test_unknown_counts_are_left_out(tmp_path: Path) -> None:
    found = read_record(write(tmp_path / "t.json", timing()))
    assert found.times is not None
    assert found.times.passes["light"].counters == {"draws": 3}
