"""Demand `graph`: somebody who meets the node finds a graph of it that runs."""

from __future__ import annotations

from collections.abc import Iterator

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.document.messages import RenderGraphError


def check_graph(subject: Subject) -> Iterator[Shortfall | Note]:
    """``graphs/NODE.yaml``, or beside a package's node, that validates without a finding and runs the node."""
    try:
        file = subject.target.file
    except RenderGraphError as error:
        yield Shortfall("no_graph", error.diagnostics[0].text)
        return
    from rendergraph.plan.validate import validate_graph

    findings, _ = validate_graph(file)
    for found in findings:
        where = f"{file.name}:{found.position.line}: " if found.position else f"{file.name}: "
        yield Shortfall("does_not_validate", f"{where}{found.code} {found.text}")
    if any(found.severity == "error" for found in findings):
        return
    if subject.graph_problem:
        yield Shortfall("not_used", subject.graph_problem)
    yield Note(f"{file.name}: {', '.join(subject.passes)}")
