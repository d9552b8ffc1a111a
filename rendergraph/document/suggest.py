"""Did-you-mean: the nearest of the words that would have been right."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

_LONGEST = 64  # difflib is quadratic in the length of its words
_LISTED = 24


def closest(word: str, choices: Iterable[str]) -> str | None:
    """The choice nearest to ``word``, or ``None`` when nothing is near."""
    words = {choice.lower(): choice for choice in choices}
    found = get_close_matches(word[:_LONGEST].lower(), words, n=1, cutoff=0.6)
    return words[found[0]] if found else None


def did_you_mean(word: str, choices: Iterable[str], otherwise: str = "choose from {choices}") -> str:
    """A help line: the nearest choice, else ``otherwise`` with ``{choices}`` filled in."""
    known = sorted(choices)
    near = closest(word, known)
    if near is not None:
        return f"did you mean '{near}'?"
    if not known:
        return "none are known"
    listed = ", ".join(known[:_LISTED]) + (f" and {len(known) - _LISTED} more" if len(known) > _LISTED else "")
    return otherwise.replace("{choices}", listed)
