"""Every diagnostic the tool can give: one table of stable codes, and the error that carries them.

A file of rows for each hundred: RG1xx syntax, 2xx graph, 3xx resource and format, 4xx barrier, 5xx device, 6xx scene,
7xx accuracy, budget and records.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from rendergraph.document.messages import (
    accuracy,
    barriers,
    conformance,
    device,
    extremes,
    graph,
    records,
    resources,
    scene,
    sweeps,
    syntax,
)
from rendergraph.document.messages.message import Message
from rendergraph.plan.graph import Position

__all__ = ["MESSAGES", "Diagnostic", "Message", "RenderGraphError", "diagnose"]


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A message with its values and place. ``data`` holds the template's values, for tests and JSON."""

    code: str
    severity: str
    text: str
    help: str
    position: Position | None = None
    data: dict[str, Any] = field(default_factory=dict)


def diagnose(code: str, position: Position | None = None, **data: Any) -> Diagnostic:
    """Fill in a row of the table. ``KeyError`` for an unknown code or a value the template needs and did not get."""
    message = MESSAGES[code]
    return Diagnostic(code, message.severity, message.text.format(**data), message.help.format(**data), position, data)


class RenderGraphError(Exception):
    """A user's mistake, or the environment's: one or more diagnostics. ``exit_code`` is the command line's."""

    def __init__(self, diagnostics: Iterable[Diagnostic], exit_code: int = 1) -> None:
        self.diagnostics = tuple(diagnostics)
        self.exit_code = exit_code
        super().__init__("; ".join(f"{d.code} {d.text}" for d in self.diagnostics))


MESSAGES: Final[dict[str, Message]] = {
    code: row
    for rows in (syntax, graph, resources, barriers, device, scene, records, accuracy, sweeps, extremes, conformance)
    for code, row in rows.ROWS.items()
}
