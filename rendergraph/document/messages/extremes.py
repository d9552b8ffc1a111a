"""RG765 to RG779: stress and fuzzing."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {}
