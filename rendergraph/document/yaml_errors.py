"""The YAML parser's errors as diagnostics, with help for the frequent causes."""

from __future__ import annotations

import re

import yaml

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.document.positions import to_position
from rendergraph.plan.graph import Position

LINE_BREAK = re.compile(r"\r\n|[\n\r\x85\u2028\u2029]")  # as the parser counts lines


def syntax_error(error: yaml.MarkedYAMLError, data: bytes, file: str) -> Diagnostic:
    """RG104 at the place where the parser gave up."""
    mark = error.problem_mark or error.context_mark
    position = Position(file, 1, 1) if mark is None else to_position(file, mark)
    problem = ", ".join(part for part in (error.context, error.problem) if part)
    lines = LINE_BREAK.split(data.decode("utf-8"))
    line = lines[position.line - 1] if position.line <= len(lines) else ""
    hint = "check brackets, quotes, indentation, and that a space follows every colon"
    if "\t" in line[: max(position.column, len(line) - len(line.lstrip()))]:
        problem, hint = "a tab where only spaces may stand", "indent with spaces"
    elif "mapping values are not allowed" in problem:
        hint = "quote text that holds a colon, or check the indentation of this and the line above"
    elif "expected ',' or" in problem:
        opened = f"opened in line {error.context_mark.line + 1} " if error.context_mark else ""
        hint = f"the bracket {opened}is not closed, or a comma is missing, before this place"
    return diagnose("RG104", position, problem=problem, hint=hint)


def unprintable(error: yaml.reader.ReaderError, data: bytes, file: str) -> Diagnostic:
    """RG104 at the first character that YAML does not allow."""
    text = data.decode("utf-8")
    bad = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if bad is None:
        return diagnose("RG104", Position(file, 1, 1), problem=str(error.reason), hint="save the file as plain UTF-8")
    lines = LINE_BREAK.split(text[: bad.start()])
    position = Position(file, len(lines), len(lines[-1]) + 1)
    problem = f"control character U+{ord(bad[0]):04X}"
    return diagnose("RG104", position, problem=problem, hint="remove it; a quoted text may write it as an escape")
