"""Anchors, aliases and merge keys of YAML (1.2.2, chapter 3.2.2.2; the merge key type of YAML 1.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rendergraph.document.positions import Branch, Place


@dataclass(slots=True)
class Anchored:
    """The value behind an anchor. ``values`` is what an alias to it adds to the number of values in the document,
    ``height`` how deep it is nested in itself: 0 for a scalar, negative while the value is still being read.
    """

    value: Any
    place: Place
    values: int
    height: int


class AliasError(ValueError):
    """An alias that leads nowhere, or into itself."""

    def __init__(self, problem: str, hint: str) -> None:
        super().__init__(problem)
        self.problem = problem
        self.hint = hint


def find_anchored(anchors: dict[str, Anchored], name: str) -> Anchored:
    """What the alias ``*name`` stands for. Raises ``AliasError``."""
    found = anchors.get(name)
    shown = name if len(name) <= 40 else name[:37] + "..."
    if found is None:
        raise AliasError(f"alias *{shown} has no anchor &{shown} before it", "mark the value to repeat with an anchor")
    if found.height < 0:
        raise AliasError(f"alias *{shown} stands inside its own value", "a value cannot contain itself")
    return found


def merge_sources(value: Any, place: Place) -> list[tuple[dict[str, Any], Branch]] | None:
    """The mappings that ``<<: value`` merges, with their places; ``None`` when it names anything but mappings."""
    sources: list[tuple[Any, Place]] = [(value, place)]
    if isinstance(value, list) and isinstance(place, Branch):
        sources = [(item, place.children[index][1]) for index, item in enumerate(value)]
    found = [(source, where) for source, where in sources if isinstance(source, dict) and isinstance(where, Branch)]
    return found if len(found) == len(sources) else None


def merge(container: dict[str, Any], branch: Branch, sources: list[tuple[dict[str, Any], Branch]]) -> None:
    """Add what ``container`` lacks, from earlier sources first."""
    for source, places in sources:
        for key, value in source.items():
            if key not in container:
                container[key] = value
                branch.children[key] = places.children[key]
