"""Diagnostics as text, against frames written out by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rendergraph.document.messages import Diagnostic
from rendergraph.document.render_text import diagnostic_json, format_diagnostics
from rendergraph.plan.graph import Position


def found(line: int = 1, column: int = 1, file: str = "g.yaml", severity: str = "error") -> Diagnostic:
    return Diagnostic("RG999", severity, "it is wrong", "put it right", Position(file, line, column))


def test_frame() -> None:
    assert format_diagnostics([found(2, 4)], {"g.yaml": "a: 1\nb: x\n"}) == (
        "g.yaml:2:4: RG999 it is wrong\n   |\n 2 | b: x\n   |    ^\n  help: put it right"
    )


def test_warning_without_place_or_help() -> None:
    assert format_diagnostics([Diagnostic("RG999", "warning", "odd", "")]) == "RG999 warning: odd"


def test_several_are_apart() -> None:
    text = format_diagnostics([found(10, 1), found(1, 1)], {"g.yaml": "x\n" * 10})
    assert text.count("\n\n") == 1
    assert "\n 10 | x\n    | ^\n" in text


def test_tabs_and_wide_characters_keep_the_caret_in_place() -> None:
    text = format_diagnostics([found(1, 4)], {"g.yaml": "\t漢b!"})
    assert "\n   | \t   ^\n" in text


def test_lines_as_yaml_counts_them() -> None:
    text = format_diagnostics([found(4, 1)], {"g.yaml": "a\r\nb\rc\u2028d\x0be"})
    assert "\n 4 | d\\x0be\n" in text


def test_long_lines_are_cut_around_the_caret() -> None:
    text = format_diagnostics([found(1, 5001)], {"g.yaml": "x" * 5000 + "!" + "y" * 5000})
    _, _, source, caret, _ = text.split("\n")
    assert len(source) < 200
    assert source[caret.index("^")] == "!"


@pytest.mark.parametrize(("line", "column"), [(3, 1), (99, 1), (1, 50)])
def test_places_past_the_end(line: int, column: int) -> None:
    assert "help" in format_diagnostics([found(line, column)], {"g.yaml": "a\n"})


def test_control_characters_never_reach_the_terminal() -> None:
    evil = Diagnostic("RG999", "error", "a\x1b[31m\u202e", "b\x07", Position("\x1b.yaml", 1, 1))
    text = format_diagnostics([evil], {"\x1b.yaml": "\x1b]0;x"})
    assert "\x1b" not in text
    assert "\x07" not in text
    assert "\u202e" not in text
    assert "\\x1b" in text


def test_files_are_read_where_no_source_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "g.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\n")
    monkeypatch.chdir(tmp_path)
    text = format_diagnostics([found(file=str(path))])
    assert text.startswith("g.yaml:1:1: ")
    assert "\n 1 | a: 1\n" in text
    assert "|" not in format_diagnostics([found(file=str(tmp_path / "none.yaml"))])
    assert "|" not in format_diagnostics([found(file=str(tmp_path))])
    path.write_bytes(b"\x7fELF\0")
    assert "|" not in format_diagnostics([found(file=str(path))])


def test_overrides_show_the_argument() -> None:
    text = format_diagnostics([found(1, 13, "--set frame.count=x")])
    assert text.startswith("--set frame.count=x: RG999")
    assert "\n 1 | frame.count=x\n   |             ^\n" in text


def test_json() -> None:
    record = diagnostic_json(found(2, 3))
    assert json.loads(json.dumps(record)) == {
        "code": "RG999", "severity": "error", "message": "it is wrong", "help": "put it right",
        "file": "g.yaml", "line": 2, "column": 3,
    }  # fmt: skip
    assert diagnostic_json(Diagnostic("RG999", "note", "", ""))["line"] is None
