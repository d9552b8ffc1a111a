"""Graphs checked together for a CI system: their findings with the repository's own paths, the worst first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic
from rendergraph.document.overrides import SET_PREFIX
from rendergraph.document.render_text import diagnostic_json
from rendergraph.document.source_file import find_graph
from rendergraph.measure.budget import check_memory
from rendergraph.plan.plan import Plan
from rendergraph.plan.validate import validate_graph
from rendergraph.report.memory_advice import advise
from rendergraph.report.resources import resources_record

SEVERITIES: Final = ("error", "warning", "note")


@dataclass(frozen=True, slots=True)
class Finding:
    """A diagnostic and where CI shows it: ``file`` relative to the repository with forward slashes (as given, where it
    lies outside), 1-based ``line`` and ``column``, which are ``None`` for what has no place in a file.
    """

    code: str
    severity: str
    message: str
    help: str
    file: str
    line: int | None
    column: int | None


@dataclass(frozen=True, slots=True)
class CheckedGraph:
    """One graph: ``file`` as in :class:`Finding`, its findings ranked, and the exit code it deserves: 0 fine, 1 errors,
    2 unreadable.
    """

    name: str
    file: str
    diagnostics: tuple[Diagnostic, ...]
    findings: tuple[Finding, ...]
    exit_code: int


def check_graphs(names: Sequence[str], overrides: Sequence[str] = ()) -> tuple[CheckedGraph, ...]:
    """Check graph files, or shipped graphs by name, without a GPU and without loading their scenes."""
    return tuple(_check(name, overrides) for name in names)


def ranked(graphs: Iterable[CheckedGraph]) -> list[Finding]:
    """All findings: errors first, then by file and line."""
    return sorted((finding for graph in graphs for finding in graph.findings), key=_rank)


def finding_json(finding: Finding) -> dict[str, Any]:
    """A finding as JSON data."""
    return {name: getattr(finding, name) for name in Finding.__slots__}


def repository_path(file: str | Path) -> str:
    """A file's path from the root of its Git repository (else from the working directory), with forward slashes.

    Links are followed, since that is where the repository has the file. Unchanged where the file lies outside.
    """
    try:
        path = Path(file).resolve()
        root = next((parent for parent in path.parents if (parent / ".git").exists()), Path.cwd().resolve())
        return path.relative_to(root).as_posix()
    except (OSError, ValueError):
        return str(file)


def _check(name: str, overrides: Sequence[str]) -> CheckedGraph:
    diagnostics, exit_code = validate_graph(name, overrides, _budgets)
    file = repository_path(find_graph(name))
    diagnostics = tuple(sorted(diagnostics, key=lambda d: SEVERITIES.index(d.severity)))
    findings = tuple(sorted((_located(d, file) for d in diagnostics), key=_rank))
    return CheckedGraph(name, file, diagnostics, findings, exit_code)


def _budgets(document: Document, plan: Plan) -> list[Diagnostic]:
    record = resources_record(plan, advice=advise(document, plan) if document.model.budget.transient_mib else ())
    return check_memory(document, record, assumed=document.model.scene is not None)


def _located(diagnostic: Diagnostic, graph: str) -> Finding:
    """The finding at its place; one about an override, or about no place, belongs to the graph as a whole."""
    shown, at = diagnostic_json(diagnostic), diagnostic.position
    message: str = shown["message"]
    if at is None or at.file.startswith(SET_PREFIX):
        message = message if at is None else f"{message} ({at.file})"
        return Finding(diagnostic.code, diagnostic.severity, message, shown["help"], graph, None, None)
    file = repository_path(at.file)
    return Finding(diagnostic.code, diagnostic.severity, message, shown["help"], file, at.line, at.column)


def _rank(finding: Finding) -> tuple[int, str, int, int, str]:
    place = finding.line or 0, finding.column or 0
    return SEVERITIES.index(finding.severity), finding.file, *place, finding.code
