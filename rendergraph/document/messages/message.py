"""One row of the message table."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Message:
    """One row of the table: ``text`` and ``help`` are ``str.format`` templates; ``rg explain`` adds ``explain``."""

    severity: str  # "error" | "warning" | "note"
    text: str
    help: str
    explain: str = ""
