"""What a sweep keeps in its folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.errors import PointError
from rendergraph.measure.sweep.store import FILE, ChunkResult, PointResult, Store, differing, locked

HEADER = {"graph": "abc", "rounds": 8}


def chunk(number: int, *indices: int) -> ChunkResult:
    control = PointResult(-1, number, 5, PointError(0.0, "measured"), ((1.0, 2.0),), True, 3.0)
    points = tuple(PointResult(i, number, 7, PointError(0.5, "above", tolerance=0.1), ((1.5,),), True) for i in indices)
    return ChunkResult(number, control, points)


def code(raised: pytest.ExceptionInfo[RenderGraphError]) -> str:
    return raised.value.diagnostics[0].code


def test_what_is_kept_comes_back(tmp_path: Path) -> None:
    first = Store(tmp_path, HEADER)
    first.take_device({"renderer": "r"})
    first.add(chunk(0, 0, 1))
    first.add(ChunkResult(1, chunk(1).control, (PointResult(2, 1, refused="RG123 no"),), True))
    again = Store(tmp_path, HEADER)
    assert again.stored == first.stored
    assert again.next_number() == 2


def test_half_a_line_and_what_follows_a_broken_one_is_measured_again(tmp_path: Path) -> None:
    store = Store(tmp_path, HEADER)
    store.add(chunk(0, 0, 1))
    path = tmp_path / FILE
    whole = path.read_bytes()
    path.write_bytes(whole[:-9])
    again = Store(tmp_path, HEADER)
    assert [p.index for p in again.stored.chunks[0].points] == [0]
    assert path.read_bytes().endswith(b"\n")
    again.add(chunk(1, 1))
    assert [p.index for p in Store(tmp_path, HEADER).stored.chunks[1].points] == [1]


def test_another_sweep_is_refused_and_told_what_differs(tmp_path: Path) -> None:
    Store(tmp_path, HEADER).add(chunk(0, 0))
    with pytest.raises(RenderGraphError) as refused:
        Store(tmp_path, {**HEADER, "rounds": 9})
    assert code(refused) == "RG754"
    assert refused.value.diagnostics[0].data["what"] == "rounds was 8, is 9"
    fresh = Store(tmp_path, {**HEADER, "rounds": 9}, fresh=True)
    assert fresh.stored.chunks == {}
    assert json.loads((tmp_path / FILE).read_text())["header"]["rounds"] == 9


def test_another_device_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path, HEADER)
    store.take_device({"renderer": "a", "threads": 2})
    store.take_device({"renderer": "a", "threads": 2})
    with pytest.raises(RenderGraphError) as refused:
        Store(tmp_path, HEADER).take_device({"renderer": "b", "threads": 2})
    assert code(refused) == "RG754"
    assert "renderer" in refused.value.diagnostics[0].data["what"]


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / FILE).write_text("nonsense\n")
    with pytest.raises(RenderGraphError) as refused:
        Store(tmp_path, HEADER)
    assert code(refused) == "RG754"


def test_two_sweeps_in_one_folder(tmp_path: Path) -> None:
    with locked(tmp_path):
        with pytest.raises(RenderGraphError) as refused, locked(tmp_path):
            pass
        assert code(refused) == "RG755"
        with locked(tmp_path / "other"):
            pass
    with locked(tmp_path):
        pass


def test_a_folder_that_is_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RenderGraphError) as refused, locked(tmp_path / "file"):
        pass
    assert code(refused) == "RG560"


def test_differences_are_short() -> None:
    assert differing({"a": 1, "b": "x"}, {"a": 1, "b": "y" * 99}) == f"b was x, is {'y' * 37}..."
    assert differing({}, {"c": [1, 2]}) == "c was null, is [1, 2]"
