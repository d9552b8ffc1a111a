"""The smallest case that still fails: dimensions are dropped one by one, then an order comes as near to the usual as it
can.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from rendergraph.measure.fuzz_run import FuzzCase, TestBed

#: Runs that reducing an order may take.
BUDGET: Final = 120

Fails = Callable[[FuzzCase], bool]


@dataclass(frozen=True, slots=True)
class Smallest:
    """``swaps``: pairs of sub-passes that must run in this order, against the usual one, for it to fail."""

    case: FuzzCase
    swaps: tuple[tuple[str, str], ...] = ()


def minimise(bed: TestBed, case: FuzzCase, fails: Fails) -> Smallest:
    """A case of which no dimension can be dropped, with the fewest swaps of neighbours. ``fails`` runs a case."""
    for dimension in case.varied:
        simpler = case.without(dimension)
        if simpler.varied and fails(simpler):
            case = simpler
    if case.order is None:
        return Smallest(case)
    return _reduce_order(bed, case, fails)


def _reduce_order(bed: TestBed, case: FuzzCase, fails: Fails) -> Smallest:
    """Sort the order towards the usual one, neighbour by neighbour, keeping every swap back that still fails.

    A pair of neighbours that stands the other way round in a legal order does not depend on each other, so each step
    is a legal order.
    """
    usual = {step.name: at for at, step in enumerate(bed.plan(case.without("order")).order)}
    names = [step.name for step in bed.plan(case).order]
    left, needed = BUDGET, True
    while needed:
        needed = False
        for at in range(len(names) - 1):
            if usual[names[at]] < usual[names[at + 1]] or left == 0:
                continue
            tried = [*names[:at], names[at + 1], names[at], *names[at + 2 :]]
            left -= 1
            if fails(replace(case, order=tuple(tried))):
                names, needed = tried, True
    swaps = [(a, b) for at, a in enumerate(names) for b in names[at + 1 :] if usual[a] > usual[b]]
    return Smallest(replace(case, order=tuple(names)), tuple(swaps))
