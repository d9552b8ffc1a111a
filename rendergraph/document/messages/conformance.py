"""RG78x: what every node must show; RG79x: specialisation and scenes that change."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {}
