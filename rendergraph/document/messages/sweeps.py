"""RG75x and RG76x: sweeps over parameters, and attribution of error."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {}
