"""Collects what expansion finds wrong, so that a user sees all of a graph's mistakes at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.document.model_errors import MAX_MISTAKES
from rendergraph.document.models import DocumentModel
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.params import Params
from rendergraph.plan.graph import Position


class SourceDocument(Protocol):
    """What expansion needs of a loaded graph file (``rendergraph.document.load.Document``)."""

    @property
    def model(self) -> DocumentModel:
        """The validated file."""

    @property
    def path(self) -> Path:
        """Where it was read from."""

    @property
    def params(self) -> Mapping[str, Params]:
        """Validated node parameters by pass."""

    def position(self, *loc: str | int, key: bool = False) -> Position:
        """The place of a value (or of its key) in the file."""


@dataclass
class Findings:
    """Errors, and warnings or notes, each at the place of ``loc`` in the document."""

    document: SourceDocument
    errors: list[Diagnostic] = field(default_factory=list)
    notes: list[Diagnostic] = field(default_factory=list)

    @cached_property
    def folder(self) -> Path:
        """The graph file's folder, to which every file it names is relative."""
        return self.document.path.resolve().parent

    def suggest(self, word: str, choices: Iterable[str]) -> str:
        """A help line: what was probably meant. Looks through all choices, so only the first mistakes get one: who
        misspells a resource that thousands of passes read should not wait for thousands of the same answer.
        """
        return did_you_mean(word, choices) if len(self.errors) < MAX_MISTAKES else "check the spelling"

    def add(self, code: str, *loc: str | int, key: bool = False, **data: Any) -> None:
        """Record a row of the message table at ``loc``."""
        found = diagnose(code, self.document.position(*loc, key=key), **data)
        (self.errors if found.severity == "error" else self.notes).append(found)
