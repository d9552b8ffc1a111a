"""Findings as workflow commands of GitHub Actions, which become annotations, and as Markdown for the step's summary.

GitHub shows at most ten annotations of a kind a step and silently drops the rest, so the last one sums up what is left.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rendergraph.document.whole_files import cannot_write
from rendergraph.report.checked_graphs import SEVERITIES, CheckedGraph, Finding, ranked

#: Annotations of one kind that GitHub keeps of one step.
CAP: Final = 10
#: Rows of the summary's table: GitHub refuses summaries above 1 MiB.
MOST_ROWS: Final = 500
_LONGEST: Final = 1000  # characters of a message in the summary

_COMMANDS: Final = {"error": "error", "warning": "warning", "note": "notice"}


def github_lines(graphs: Sequence[CheckedGraph]) -> list[str]:
    """Lines for standard output: annotations, errors first; then in plain text what had no room; then the count."""
    findings = ranked(graphs)
    lines: list[str] = []
    left: list[Finding] = []
    for severity in SEVERITIES:
        found = [finding for finding in findings if finding.severity == severity]
        shown = found if len(found) <= CAP else found[: CAP - 1]
        lines += [_annotation(finding) for finding in shown]
        if len(shown) < len(found):
            lines.append(_rolled_up(found[len(shown) :]))
            left += found[len(shown) :]
    # A line must not look like a command, which may start after blanks or, in the old form, anywhere.
    lines += [f"- {_plain(finding)}".replace("##[", "## [") for finding in left]
    return [*lines, count_line(graphs)]


def count_line(graphs: Sequence[CheckedGraph]) -> str:
    """How many graphs, and findings of each severity."""
    count = Counter(finding.severity for graph in graphs for finding in graph.findings)
    parts = (_counted(count[severity], severity) for severity in SEVERITIES)
    return ", ".join([_counted(len(graphs), "graph"), *parts])


def step_summary(graphs: Sequence[CheckedGraph]) -> str:
    """Markdown: the count and a table of the findings, worst first."""
    findings = ranked(graphs)
    lines = ["### rg validate", "", count_line(graphs), ""]
    if findings:
        lines += ["| Severity | Code | Place | Message | Help |", "|---|---|---|---|---|"]
    for finding in findings[:MOST_ROWS]:
        place = finding.file if finding.line is None else f"{finding.file}:{finding.line}:{finding.column}"
        cells = [finding.severity, finding.code, place, finding.message, finding.help]
        lines.append(f"| {' | '.join(_cell(cell) for cell in cells)} |")
    if len(findings) > MOST_ROWS:
        lines += ["", f"{len(findings) - MOST_ROWS} more are in the log."]
    return "\n".join(lines) + "\n"


def append_step_summary(graphs: Sequence[CheckedGraph]) -> None:
    """Add the summary to the file that ``$GITHUB_STEP_SUMMARY`` names, where it is set.

    Raises ``RenderGraphError`` RG560 when it cannot be written.
    """
    name = os.environ.get("GITHUB_STEP_SUMMARY")
    if name:
        try:
            with Path(name).open("a", encoding="utf-8") as file:
                file.write(step_summary(graphs))
        except OSError as error:
            raise cannot_write(Path(name), error) from None


# ---------------------------------------------------------------- workflow commands


def escape_data(text: str) -> str:
    """Text as the message of a workflow command."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def escape_property(text: str) -> str:
    """Text as the value of a workflow command's property."""
    return escape_data(text).replace(":", "%3A").replace(",", "%2C")


def _command(severity: str, properties: dict[str, str], message: str) -> str:
    listed = ",".join(f"{key}={escape_property(value)}" for key, value in properties.items())
    return f"::{_COMMANDS[severity]} {listed}::{escape_data(message)}"


def _annotation(finding: Finding) -> str:
    properties = {"file": finding.file}
    if finding.line is not None:
        properties |= {"line": str(finding.line), "col": str(finding.column)}
    message = finding.message + (f"\nhelp: {finding.help}" if finding.help else "")
    return _command(finding.severity, properties | {"title": f"rg validate {finding.code}"}, message)


def _rolled_up(findings: Sequence[Finding]) -> str:
    severity = findings[0].severity
    codes = Counter(finding.code for finding in findings)
    listed = ", ".join(f"{code} x {codes[code]}" for code in sorted(codes, key=lambda code: (-codes[code], code)))
    more = _counted(len(findings), f"more {severity}")
    files = _counted(len({finding.file for finding in findings}), "file")
    return _command(severity, {"title": f"rg validate: {more}"}, f"{more} in {files}: {listed}\nThe log lists them.")


def _plain(finding: Finding) -> str:
    place = finding.file if finding.line is None else f"{finding.file}:{finding.line}:{finding.column}"
    return f"{place}: {finding.code} {finding.severity}: {finding.message}".replace("\n", " ")


def _cell(text: str) -> str:
    """Text inside a cell of a Markdown table, with nothing in it read as markup or as HTML."""
    short = text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
    for mark in "\\`*_[]<>|~#!":
        short = short.replace(mark, f"\\{mark}")
    return short.replace("&", "&amp;").replace("\n", " ").replace("\r", " ")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
