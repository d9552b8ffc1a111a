"""Loads a graph file: text, positions, the validated model and every node's validated parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from rendergraph.document.budget_checks import check_budget_names
from rendergraph.document.collector import collector_paused
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.model_errors import MAX_MISTAKES, Mistake, validate_strictly
from rendergraph.document.models import DocumentModel
from rendergraph.document.node_checks import check_nodes, misplaced
from rendergraph.document.overrides import apply_overrides
from rendergraph.document.positions import Branch, PositionMap
from rendergraph.document.source_file import find_graph, read_source, shipped_graphs
from rendergraph.document.yaml_reader import read_yaml
from rendergraph.node.params import Params
from rendergraph.plan.graph import Position

__all__ = ["Document", "load_document", "shipped_graphs"]

_CODES: Final = {
    "missing": "RG120",
    "unknown": "RG121",
    "type": "RG122",
    "range": "RG123",
    "choice": "RG124",
    "name": "RG125",
    "length": "RG126",
    "consistency": "RG127",
}


@dataclass(frozen=True)
class Document:
    """A graph file that is valid by itself. ``params`` holds the node parameters by pass; ``warnings`` what is legal
    but probably not meant. Files named in it are relative to ``path.parent``.
    """

    model: DocumentModel
    path: Path
    text: str
    params: Mapping[str, Params]
    positions: PositionMap = field(repr=False)
    warnings: tuple[Diagnostic, ...] = ()

    def position(self, *loc: str | int, key: bool = False) -> Position:
        """Where the value at ``loc`` (or its ``key``) was written, such as ``("passes", "light", "set", "radius")``;
        where it was not written, its nearest parent's key. Values from ``--set`` name that argument as their file.
        """
        return self.positions.find(loc, key=key)

    def _repr_html_(self) -> str:
        from rendergraph.report.notebook import document_html

        return document_html(self)

    def _repr_png_(self) -> bytes | None:
        from rendergraph.report.notebook import document_picture

        return document_picture(self)


@collector_paused()
def load_document(path: str | Path, overrides: Sequence[str] = ()) -> Document:
    """Read and validate a graph file, or the shipped graph of that name; ``overrides`` are ``--set`` arguments.

    Raises ``RenderGraphError`` with everything found wrong (RG100 to RG131, RG200 to RG207, RG706, and RG301 to
    RG309 for keys of one resource), in file order; its exit code is 2 when the file or an override
    cannot be read at all, else 1.
    """
    file = find_graph(path)
    data = read_source(file)
    reading = read_yaml(data, str(file))
    if not isinstance(reading.root, Branch) or not isinstance(reading.value, dict):
        raise RenderGraphError([*reading.problems, _no_mapping(reading.value, str(file))])
    value, root, problems = apply_overrides(reading.value, reading.root, overrides)
    positions = PositionMap(str(file), root)
    model, mistakes = validate_strictly(DocumentModel, value)
    params, node_problems = check_nodes(value, positions.find_at)
    problems = _without_echoes(
        [*reading.problems, *problems],
        [
            *(_problem(m, value, positions) for m in mistakes),
            *node_problems,
            *check_budget_names(value, positions.find_at),
        ],
    )
    if model is None or any(p.severity == "error" for p in problems):
        raise RenderGraphError(_not_too_many(problems))
    return Document(model, file, data.decode("utf-8"), params, positions, tuple(problems))


def _no_mapping(value: Any, file: str) -> Diagnostic:
    problem = "the file holds no graph" if value is None else "the document is not a mapping"
    return diagnose("RG110", Position(file, 1, 1), problem=problem)


def _problem(mistake: Mistake, data: Any, positions: PositionMap) -> Diagnostic:
    place = positions.find(mistake.loc, key=mistake.at_key)
    if mistake.kind not in _CODES:
        return diagnose(mistake.kind, place, **{"resource": ".".join(map(str, mistake.loc[1:2])), **mistake.data})
    values = {"key": mistake.expected, "problem": mistake.expected, "expected": mistake.expected}
    hint = mistake.hint
    loc = mistake.loc
    if mistake.kind == "unknown":
        loc = loc[:-1]
        if len(loc) == 2 and loc[0] == "passes":
            hint = misplaced(data["passes"][loc[1]], mistake.expected) or hint
    elif mistake.kind == "missing" and hint:
        hint = f"add `{mistake.expected}:` ({hint})"
    where = ".".join(map(str, loc)) or "the document"
    return diagnose(_CODES[mistake.kind], place, where=where, found=mistake.found, hint=hint, **values)


def _not_too_many(problems: list[Diagnostic]) -> list[Diagnostic]:
    if len(problems) <= MAX_MISTAKES:
        return problems
    shown = problems[:MAX_MISTAKES]
    return [*shown, diagnose("RG114", shown[-1].position, limit=MAX_MISTAKES)]


def _without_echoes(first: Sequence[Diagnostic], second: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Both in file order, less what of ``second`` only follows from an error of ``first`` at the same place, and less
    warnings of ``first`` where ``second`` has an error.
    """

    def place(problem: Diagnostic) -> tuple[str, int, int]:
        at = problem.position
        return (at.file, at.line, at.column) if at else ("", 0, 0)

    wrong = {place(p) for p in first if p.severity == "error"}
    later = [p for p in second if place(p) not in wrong]
    wrong = {place(p) for p in later if p.severity == "error"}
    return sorted([*(p for p in first if p.severity == "error" or place(p) not in wrong), *later], key=place)
