"""What is demanded of every node, in the order in which it is tried."""

from __future__ import annotations

from typing import Final

from rendergraph.conformance.demand import Demand
from rendergraph.conformance.extremes import check_extremes
from rendergraph.conformance.knobs import check_knobs
from rendergraph.conformance.own_graph import check_graph
from rendergraph.conformance.parameters import check_parameters
from rendergraph.conformance.plan_invariants import check_plan
from rendergraph.conformance.readme import check_readme
from rendergraph.conformance.reference import check_reference
from rendergraph.conformance.same_image import check_poison, check_sharing, check_specialisation

DEMANDS: Final = {
    demand.name: demand
    for demand in (
        Demand("graph", "RG780", "a graph of its own that validates and runs it", check_graph, needs_graph=False),
        Demand("readme", "RG781", "a README: what, when and when not, cost, accuracy, source", check_readme, False),
        Demand(
            "parameters", "RG782", "parameters with help, unit, range, and what they trade", check_parameters, False
        ),
        Demand("reference", "RG783", "a reference, and an error within what it states", check_reference),
        Demand("knobs", "RG784", "an error that falls as its quality knobs rise", check_knobs),
        Demand("extremes", "RG785", "extremes survived: finite, bounded, no driver error", check_extremes),
        Demand("plan", "RG786", "a sound plan that hangs on no file order", check_plan),
        Demand("poison", "RG787", "the same image whatever transients held before", check_poison),
        Demand("sharing", "RG788", "the same image with and without shared memory", check_sharing),
        Demand("specialisation", "RG789", "the same image specialised and in full", check_specialisation),
    )
}
