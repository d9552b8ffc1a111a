"""Demand `plan`: the plan of the node's graph is sound, and hangs on nothing that it should not."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.document.load import Document
from rendergraph.plan.compile import PlanError
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.plan.verify import verify

_ORDERS = 4


def check_plan(subject: Subject) -> Iterator[Shortfall | Note]:
    """Verified in the usual and in random orders; the same from a shuffled file and a second build; LOAD <= used."""
    plan = subject.planned(subject.document).plan
    for fault in verify(plan):
        yield Shortfall("not_sound", fault)
    if facts(subject.planned(subject.document).plan) != facts(plan):
        yield Shortfall("not_deterministic", "build() gives other sub-passes when it is called again")
        return
    for seed in range(_ORDERS):
        if facts(subject.planned(shuffled(subject.document, seed)).plan) != facts(plan):
            yield Shortfall(
                "depends_on_file_order", "with passes and resources listed in another order the plan differs"
            )
            break
    for seed in range(_ORDERS):
        try:
            subject.planned(subject.document, PlanOptions(order="random", seed=seed))
        except PlanError as error:
            yield Shortfall("not_sound", f"in a random legal order (seed {seed}): {error}")
    totals = plan.totals
    if totals.load > totals.used:
        yield Shortfall("below_load", f"{totals.used} bytes are used, below the {totals.load} that are alive at once")
    yield Note(f"{len(plan.order)} sub-passes, {totals.used} bytes of transients, {totals.load} alive at once")


def facts(plan: Plan) -> tuple[Any, ...]:
    """What must not change: order, what is left out, memory, barriers."""
    order = tuple(replace(step, position=None) for step in plan.order)
    slots = dict(sorted(plan.slot_of.items()))
    return order, sorted(plan.culled), slots, repr(plan.barriers), plan.totals


def shuffled(document: Document, seed: int) -> Document:
    """The same graph with its passes and resources listed in another order."""
    chance = random.Random(seed)

    def mixed(mapping: dict[str, Any]) -> dict[str, Any]:
        return dict(chance.sample(list(mapping.items()), len(mapping)))

    model = document.model
    update = {"passes": mixed(dict(model.passes)), "resources": mixed(dict(model.resources))}
    return replace(document, model=model.model_copy(update=update))
