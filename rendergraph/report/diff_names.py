"""Which pass of one record is which of the other: by name, and where a pass was only renamed, by node and place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Matching:
    """``renamed`` maps names before to names after; the others are on one side only. In execution order."""

    renamed: dict[str, str]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]

    def after_name(self, name: str) -> str:
        """What a pass, sub-pass or resource of before (``light``, ``light.cull``) is called after."""
        parent, dot, rest = name.partition(".")
        return self.renamed.get(parent, parent) + dot + rest


def match_passes(before: Mapping[str, str], after: Mapping[str, str]) -> Matching:
    """Match passes given as ``{name: node}`` in execution order.

    A pass is taken for renamed only where nothing else can be meant: the same node between the same neighbours, and
    one such pass on either side. A wrong match would compare the times of two different things.
    """
    lost, found = _strangers(before, after), _strangers(after, before)
    renamed = {
        names[0]: found[place][0] for place, names in lost.items() if len(names) == len(found.get(place, ())) == 1
    }
    gone, new = set(before) - set(after) - set(renamed), set(after) - set(before) - set(renamed.values())
    return Matching(renamed, tuple(n for n in before if n in gone), tuple(n for n in after if n in new))


def _strangers(passes: Mapping[str, str], others: Mapping[str, str]) -> dict[tuple[str, str, str], list[str]]:
    """Passes the other side has not: by node, and the nearest common passes before and behind them."""
    names = list(passes)
    following, upcoming = "", []
    for name in reversed(names):
        upcoming.append(following)
        following = name if name in others else following
    places: dict[tuple[str, str, str], list[str]] = {}
    previous = ""
    for name, behind in zip(names, reversed(upcoming), strict=True):
        if name in others:
            previous = name
        elif passes[name]:
            places.setdefault((passes[name], previous, behind), []).append(name)
    return places
