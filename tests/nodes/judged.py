"""Verdicts on a graph's passes of one node, by measure."""

from __future__ import annotations

from dataclasses import dataclass

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.measure.truth.invariants import broken_invariants
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.observe import observe
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document

SMALL = "frame.size=[96, 54]"


@dataclass(frozen=True)
class Judged:
    """What was found: ``above`` and ``within`` name measures, ``values`` their metric; ``broken`` are invariants."""

    above: tuple[str, ...]
    within: tuple[str, ...]
    values: dict[str, float | None]
    broken: tuple[str, ...]


def passes_of(device: Device, graph: str, node: str, *overrides: str) -> dict[str, PassRun]:
    """The passes of a node in a graph's last frame."""
    document = load_document(graph, [SMALL, *overrides])
    planned = plan_document(document, PlanOptions())
    return observe(document, planned, device, [n for n, m in document.model.passes.items() if m.node == node])


def judge_run(node: str, run: PassRun) -> Judged:
    """One pass."""
    found = judge_pass("p", find_node(node), run, flip=False)
    verdicts = {j.measure: j.verdict for j in found}
    return Judged(
        tuple(m for m, verdict in verdicts.items() if verdict == "above"),
        tuple(m for m, verdict in verdicts.items() if verdict == "within"),
        {j.measure: j.value for j in found},
        broken_invariants("p", find_node(node), run),
    )


def judge_node(device: Device, node: str, *overrides: str, graph: str = "") -> Judged:
    """The first pass of a node in its own graph."""
    return judge_run(node, next(iter(passes_of(device, graph or node, node, *overrides).values())))
