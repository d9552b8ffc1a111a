"""What a demand is, and what is found of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from rendergraph.conformance.subject import Subject


@dataclass(frozen=True, slots=True)
class Shortfall:
    """One thing that a node does not show. ``reason`` is a stable word, ``text`` the sentence for its author."""

    reason: str
    text: str


@dataclass(frozen=True, slots=True)
class Note:
    """What was seen and is not wrong, such as a measure that its graph cannot show."""

    text: str


Check = Callable[["Subject"], Iterable["Shortfall | Note"]]


@dataclass(frozen=True, slots=True)
class Demand:
    """``name`` is what a node's ``exempt`` calls it, ``code`` its row of the message table, ``help`` what it asks in a
    sentence. ``needs_graph`` demands are not tried where there is no graph of the node's that plans.
    """

    name: str
    code: str
    help: str
    check: Check
    needs_graph: bool = True


Status = Literal["met", "missed", "exempt", "not_tried"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of one demand on one node. ``reason`` says why it is exempt or was not tried."""

    node: str
    demand: str
    code: str
    status: Status
    shortfalls: tuple[Shortfall, ...] = ()
    notes: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0
