"""What a frame is bound by, in words: one text for the terminal's tables and the page."""

from __future__ import annotations

from typing import Any


def bound_text(what: str, bound: dict[str, Any]) -> str:
    """What ``what`` is bound by and what says so, in three lines. ``bound`` is the record of perturbed runs
    (:func:`rendergraph.measure.bound.classify`).
    """
    return "\n".join([f"{what} is bound by {bound['class']} ({agreement(bound)}): {bound['advice']}", *evidence(bound)])


def agreement(bound: dict[str, Any]) -> str:
    """``86 % of rounds agree``."""
    return f"{100 * bound['agreement']:.0f} % of rounds agree"


def evidence(bound: dict[str, Any]) -> list[str]:
    """What the class was told from, in two lines."""
    found = bound["evidence"]
    runs = {name: found[name.replace(" ", "_")] for name in _RUNS}
    left = ", ".join(f"{name} {100 * value:.0f} %" for name, value in runs.items() if value is not None)
    draws = f"{found['draws']} draw{'s' if found['draws'] != 1 else ''}"
    if found["primitives_per_draw"] is not None:
        per_draw = f"{found['primitives_per_draw']:.0f}"
        draws += f" of {per_draw} primitive{'s' if per_draw != '1' else ''}"
    return [
        f"  of the frame is left: {left}",
        f"  handing over takes {100 * found['submit_share']:.0f} %, waiting for readbacks "
        f"{100 * found['readback_share']:.0f} %; {draws}",
    ]


_RUNS = ("half resolution", "nothing rasterised", "no draws", "no readback")
