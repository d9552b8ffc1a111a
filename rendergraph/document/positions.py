"""Where each key and value of a document was written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from rendergraph.plan.graph import Position


class Mark(Protocol):
    """A place as PyYAML gives it: 0-based line and column."""

    @property
    def line(self) -> int:
        """0-based line."""

    @property
    def column(self) -> int:
        """0-based column in characters."""


class Branch:
    """The places inside a mapping or list: for every key or index where the key and the value stand."""

    __slots__ = ("children", "mark")

    def __init__(self, mark: Mark | Position, children: dict[str | int, tuple[Mark | Position | None, Place]]) -> None:
        self.mark = mark
        self.children = children


#: Scalars keep the parser's own mark, unconverted, so that a document without errors pays nothing for positions. A
#: ``Position`` stands where an override replaced the value.
Place = Branch | Mark | Position


def start(place: Place) -> Mark | Position:
    """Where a key, scalar, mapping or list begins."""
    return place.mark if isinstance(place, Branch) else place


def to_position(file: str, mark: Mark | Position) -> Position:
    """A mark of ``file`` as a 1-based position."""
    return mark if isinstance(mark, Position) else Position(file, mark.line + 1, mark.column + 1)


@dataclass(frozen=True, slots=True)
class PositionMap:
    """Positions of a whole document by location, such as ``("passes", "light", "set", "radius")``."""

    file: str
    root: Place

    def find(self, loc: Sequence[str | int], *, key: bool = False) -> Position:
        """The place of a value (or of its ``key``); for a location that is not there, of its nearest parent's key."""
        place: Place = self.root
        key_mark: Mark | Position | None = None
        for part in loc:
            if not isinstance(place, Branch) or part not in place.children:
                key = True
                break
            key_mark, place = place.children[part]
        return to_position(self.file, key_mark if key and key_mark is not None else start(place))

    def find_at(self, *loc: str | int, key: bool = False) -> Position:
        """``find`` with the location spelled out."""
        return self.find(loc, key=key)
