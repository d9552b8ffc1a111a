"""Compile errors of the drivers, decoded to the author's file, line and column."""

from __future__ import annotations

import re
from typing import Final

from rendergraph.device.includes import FileTable
from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.plan.graph import Position

#: Mesa ``0:12(5): error: text``, NVIDIA ``0(12) : error C0000: text``, AMD and ANGLE ``ERROR: 0:12: text``.
_DIALECTS: Final = (
    re.compile(r"^\s*\d+:(?P<line>\d+)\((?P<column>\d+)\): (?:preprocessor )?error: (?P<text>.*)$"),
    re.compile(r"^\s*\d+\((?P<line>\d+)\) : error (?P<text>C\d+: .*)$"),
    re.compile(r"^\s*ERROR: \d+:(?P<line>\d+): (?P<text>.*)$"),
)
_MOST: Final = 10


def decode_compile_log(log: str, stage: str, files: FileTable, asked_by: Position | None) -> list[Diagnostic]:
    """RG515 for each line a compiler's log complains of, at most ten; a log in no known dialect becomes one as a whole.

    Only a line's first error is kept: the others are mostly its consequences.
    """
    needed = f"the pass at {asked_by}" if asked_by else "this program"
    found: dict[tuple[str, int], Diagnostic] = {}
    for line in log.splitlines():
        for dialect in _DIALECTS:
            if match := dialect.match(line):
                parts = match.groupdict()
                place = files.locate(int(parts["line"]), int(parts.get("column") or 1))
                error = diagnose("RG515", place, stage=stage, detail=parts["text"].strip(), needed=needed)
                found.setdefault((place.file, place.line), error)
                break
    if not found:
        detail = " ".join(log.split()) or "the driver gives no reason"
        return [diagnose("RG515", files.locate(0), stage=stage, detail=detail, needed=needed)]
    return list(found.values())[:_MOST]
