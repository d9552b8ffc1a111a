"""Findings as JUnit XML, which nearly every CI system shows as test results: one test case a graph."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from rendergraph.report.checked_graphs import CheckedGraph, Finding

#: What XML 1.0 cannot hold, not even escaped.
_NOT_XML: Final = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit_xml(graphs: Sequence[CheckedGraph]) -> str:
    """The report as text. A graph with errors has one ``failure`` with all of them, one that cannot be read an
    ``error``; warnings and notes are its ``system-out``.
    """
    unreadable = sum(graph.exit_code == 2 for graph in graphs)
    failed = sum(graph.exit_code == 1 for graph in graphs)
    counts = {"tests": str(len(graphs)), "failures": str(failed), "errors": str(unreadable)}
    root = Element("testsuites", {"name": "rg validate", **counts})
    suite = SubElement(root, "testsuite", {"name": "rg validate", **counts, "skipped": "0"})
    for graph in graphs:
        _case(suite, graph)
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode")


def _case(suite: Element, graph: CheckedGraph) -> None:
    file = _clean(graph.file)
    case = SubElement(suite, "testcase", classname="rg.validate", name=file, file=file)
    errors = [finding for finding in graph.findings if finding.severity == "error"]
    others = [finding for finding in graph.findings if finding.severity != "error"]
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        kind = "error" if graph.exit_code == 2 else "failure"
        message = _clean(f"{errors[0].code} {errors[0].message}{more}")
        SubElement(case, kind, type=errors[0].code, message=message).text = _lines(errors)
    if others:
        SubElement(case, "system-out").text = _lines(others)


def _lines(findings: Iterable[Finding]) -> str:
    return "\n".join(_clean(_line(finding)) for finding in findings)


def _line(finding: Finding) -> str:
    place = finding.file if finding.line is None else f"{finding.file}:{finding.line}:{finding.column}"
    advice = f"\n  help: {finding.help}" if finding.help else ""
    return f"{place}: {finding.code} {finding.severity}: {finding.message}{advice}"


def _clean(text: str) -> str:
    return _NOT_XML.sub("\N{REPLACEMENT CHARACTER}", text)
