"""Every diagnostic the tool can give: one table of stable codes, and the error that carries them.

Codes: RG1xx syntax, 2xx graph, 3xx resource and format, 4xx barrier, 5xx device, 6xx scene, 7xx accuracy and budget.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from rendergraph.plan.graph import Position


@dataclass(frozen=True, slots=True)
class Message:
    """One row of the table: ``text`` and ``help`` are ``str.format`` templates, ``explain`` is what ``rg explain`` adds."""

    severity: str  # "error" | "warning" | "note"
    text: str
    help: str
    explain: str = ""


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
    # ---- RG1xx: the file and its syntax
    # ---- RG2xx: the graph
    # ---- RG3xx: resources and formats
    # ---- RG4xx: barriers
    # ---- RG5xx: the device, programs, files written
    # ---- RG6xx: the scene
    # ---- RG7xx: accuracy and budget
}
