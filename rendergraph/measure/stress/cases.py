"""Which extremes a target is tried at: the common ones, as its nodes amend them, and the nodes' own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.measure.stress.case import Case
from rendergraph.measure.stress.common import COMMON
from rendergraph.measure.stress.target import StressTarget
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Extreme


def cases_of(target: StressTarget, document: Document, only: Sequence[str] = ()) -> tuple[Case, ...]:
    """The extremes to try, common ones first.

    A node's extreme of a common one's name amends it: its refusal, and for that node's passes its skips, with its
    overrides on the node's own graph. What a node declares beyond them is tried on its own graph.

    :raises RenderGraphError: RG769 for a name in ``only`` that is none of them.
    """
    nodes = sorted({model.node for model in document.model.passes.values()})
    cases = {case.name: case for case in COMMON}
    for name in nodes:
        for extreme in find_node(name).extremes:
            if extreme.name in cases and cases[extreme.name].common:
                cases[extreme.name] = _amended(cases[extreme.name], name, extreme, own=name in target.own)
            elif name in target.own:
                key = extreme.name if extreme.name not in cases else f"{name}.{extreme.name}"
                found = Case(replace(extreme, name=key), common=False)
                cases[key] = replace(found, skips={name: extreme.skips})
    return tuple(_chosen(cases, only))


def _amended(case: Case, node: str, by: Extreme, *, own: bool) -> Case:
    overrides = (*case.extreme.overrides, *by.overrides) if own else case.extreme.overrides
    extreme = replace(case.extreme, refused=case.extreme.refused or by.refused, overrides=overrides)
    return replace(case, extreme=extreme, skips={**case.skips, node: by.skips})


def _chosen(cases: dict[str, Case], only: Sequence[str]) -> Iterable[Case]:
    for name in only:
        if name not in cases:
            raise RenderGraphError([diagnose("RG769", name=name, hint=did_you_mean(name, cases))], exit_code=2)
    return [case for case in cases.values() if not only or case.name in only]
