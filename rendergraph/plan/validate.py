"""Checks a graph file without a GPU and without loading its scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from rendergraph.document.collector import collector_paused
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.scene.source import source_problem


def plan_without_scene(document: Document, options: PlanOptions) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """Plan a document as if its scene held every feature: the largest graph it can become."""
    with collector_paused():
        graph, warnings = expand(document)
        plan, more = compile_plan(graph, options)
    return plan, (*document.warnings, *warnings, *more)


def validate_graph(
    path: str | Path,
    overrides: Sequence[str] = (),
    check: Callable[[Document, Plan], Sequence[Diagnostic]] = lambda document, plan: (),
) -> tuple[tuple[Diagnostic, ...], int]:
    """All findings of one file, and the exit code they deserve: 0 fine (warnings allowed), 1 errors, 2 unreadable.

    ``check`` may find more in the document and its plan.
    """
    try:
        document = load_document(path, overrides)
    except RenderGraphError as error:
        return error.diagnostics, error.exit_code
    missing = _missing_scene(document)
    try:
        plan, warnings = plan_without_scene(document, PlanOptions())
    except RenderGraphError as error:
        return (*missing, *error.diagnostics), error.exit_code
    findings = (*missing, *warnings, *check(document, plan))
    return findings, int(any(finding.severity == "error" for finding in findings))


def _missing_scene(document: Document) -> tuple[Diagnostic, ...]:
    """The scene is not loaded here, but it has to be there."""
    scene = document.model.scene
    if scene is None:
        return ()
    place = document.position("scene", "source")
    problem = source_problem(scene.source, document.path.parent, place, base="the graph file")
    return () if problem is None else (problem,)
