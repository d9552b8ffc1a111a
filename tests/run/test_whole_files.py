"""Files appear whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.document.whole_files import cannot_write, whole_file


def test_success_replaces_the_file(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "a.txt"
    for text in ("one", "two"):
        with whole_file(target) as temporary:
            temporary.write_text(text)
        assert target.read_text() == text
    assert [p.name for p in target.parent.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_failure_keeps_the_old_file_and_leaves_nothing(tmp_path: Path, error: type[BaseException]) -> None:
    target = tmp_path / "a.txt"
    target.write_text("old")
    with pytest.raises(error), whole_file(target) as temporary:
        temporary.write_text("half")
        raise error
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_disk_full_is_a_diagnostic_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(RenderGraphError) as caught, whole_file(tmp_path / "a.txt"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert caught.value.diagnostics[0].code == "RG560"
    assert caught.value.diagnostics[0].data["reason"] == "the disk is full"
    assert caught.value.exit_code == 2
    assert not list(tmp_path.iterdir())


def test_a_file_in_the_way_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RenderGraphError) as caught, whole_file(tmp_path / "file" / "a.txt"):
        pytest.fail("the body must not run")
    assert caught.value.diagnostics[0].code == "RG560"


def test_a_folder_in_the_way_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(RenderGraphError) as caught, whole_file(tmp_path / "a.txt") as temporary:
        temporary.write_text("text")
    assert caught.value.diagnostics[0].code == "RG560"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_unknown_reasons_are_passed_on() -> None:
    error = cannot_write(Path("x"), OSError(errno.EIO, os.strerror(errno.EIO)))
    assert error.diagnostics[0].data["reason"] == "input/output error"
