"""Diagnostics as text: position, code and message, the source line with a caret, and what to do. Also as JSON data."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any
from unicodedata import east_asian_width

from rendergraph.document.messages import Diagnostic
from rendergraph.document.overrides import SET_PREFIX
from rendergraph.document.yaml_errors import LINE_BREAK
from rendergraph.plan.graph import Position

_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
_WIDEST = 160  # characters of a source line shown around the caret
_LARGEST = 8 << 20  # bytes of a file read for its source line


def format_diagnostics(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str] | None = None) -> str:
    """All diagnostics, blank lines between them.

    ``sources`` gives the text of files by the name their positions use; other files are read from the disk, and where
    that fails the source frame is left out. Paths below the working directory are shown relative to it.
    """
    lines: dict[str, list[str]] = {}

    def line_of(at: Position) -> str | None:
        if at.file not in lines:
            text = _text(at.file, sources or {})
            lines[at.file] = LINE_BREAK.split(text) if text and "\0" not in text else []  # no frames of binary files
        found = lines[at.file]
        return found[at.line - 1] if 0 < at.line <= len(found) else None

    return "\n\n".join(_format(d, line_of(d.position) if d.position else None) for d in diagnostics)


def diagnostic_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic as plain JSON data: code, severity, message, help, and file, line and column (null without)."""
    at = diagnostic.position
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": _printable(diagnostic.text),
        "help": _printable(diagnostic.help),
        "file": _printable(_relative(at.file)) if at else None,
        "line": at.line if at else None,
        "column": at.column if at else None,
    }


def _format(diagnostic: Diagnostic, line: str | None) -> str:
    severity = "" if diagnostic.severity == "error" else f"{diagnostic.severity}: "
    head = f"{diagnostic.code} {severity}{_printable(diagnostic.text)}"
    parts = []
    if diagnostic.position is None:
        parts.append(head)
    else:
        parts.append(f"{_place(diagnostic.position)}: {head}")
        if line is not None:
            parts += _frame(diagnostic.position, line)
    if diagnostic.help:
        parts.append(f"  help: {_printable(diagnostic.help)}")
    return "\n".join(parts)


def _place(at: Position) -> str:
    file = _printable(_relative(at.file))
    return file if at.file.startswith(SET_PREFIX) else f"{file}:{at.line}:{at.column}"


def _frame(at: Position, line: str) -> list[str]:
    """The source line and a caret under the column; of a long line the part around it."""
    column = min(at.column - 1, len(line))
    first = max(0, column - _WIDEST // 2) if len(line) > _WIDEST else 0
    shown = line[first : first + _WIDEST]
    # The caret's line repeats tabs and the width of wide characters, so that both are indented alike on any terminal.
    indent = "".join(_blank(character) for character in _printable(shown[: column - first]))
    number = str(at.line)
    bar = f"{' ' * len(number)} |"
    return [f" {bar}", f" {number} | {_printable(shown)}".rstrip(), f" {bar} {indent}^"]


def _blank(character: str) -> str:
    return "\t" if character == "\t" else "  " if east_asian_width(character) in "WF" else " "


def _text(file: str, sources: Mapping[str, str]) -> str:
    if file in sources:
        return sources[file]
    if file.startswith(SET_PREFIX):
        return file.removeprefix(SET_PREFIX)
    try:
        path = Path(file)
        if not path.is_file():  # a pipe would be read a second time
            return ""
        with path.open("rb") as opened:
            return opened.read(_LARGEST).decode("utf-8-sig", "replace")
    except (OSError, ValueError):
        return ""


def _relative(file: str) -> str:
    try:
        path = Path(file)
        return str(path.relative_to(Path.cwd())) if path.is_absolute() else file
    except (OSError, ValueError):
        return file


def _printable(text: str) -> str:
    """Control characters, which could move the cursor or recolour the terminal, as escapes."""
    return _CONTROL.sub(lambda found: found[0].encode("unicode_escape").decode("ascii"), text)
