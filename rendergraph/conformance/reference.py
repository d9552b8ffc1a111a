"""Demand `reference`: the node says how wrong it may be, and on its own graph it is no more than that."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.measure.truth.judge import reference_module
from rendergraph.measure.truth.judgement import Judgement


def check_reference(subject: Subject) -> Iterator[Shortfall | Note]:
    """A ``reference`` with metric and stated error, or ``exact``; ``judge(run)``; every verdict on the own graph."""
    node = subject.node
    if node.reference is None and not node.exact:
        yield Shortfall("no_reference", "declare reference = Reference(...), or exact = True, with a reference.py")
        return
    if reference_module(node) is None:
        yield Shortfall("no_judge", "there is no reference.py with judge(run) beside the node")
        return
    for key, measure in (node.reference.measures if node.reference else {}).items():
        if not (isfinite(measure.tolerance) and measure.tolerance >= 0):
            yield Shortfall("no_stated_error", f"measure '{key}' states no finite tolerance")
    judgements = [judged for entry in subject.judged for judged in entry.judgements]
    for entry in subject.judged:
        if entry.reason:
            yield Note(f"{entry.name} was not judged: {entry.reason}")
        for sentence in entry.broken:
            yield Shortfall("invariant_broken", f"{entry.name}: {sentence}")
    for judged in judgements:
        if judged.verdict == "above":
            yield Shortfall("off", f"{told(judged)}, above the stated {judged.tolerance:.4g}")
        elif judged.verdict == "cannot_judge" and judged.reason != "all_masked":
            yield Shortfall("cannot_judge", f"{judged.pass_name}.{judged.measure}: {judged.reason}")
        elif judged.verdict == "cannot_judge":
            yield Note(f"{judged.pass_name}.{judged.measure} is not known anywhere in this graph")
        else:
            yield Note(f"{told(judged)}, within {judged.tolerance:.4g}")
    if not any(judged.verdict != "cannot_judge" for judged in judgements):
        yield Shortfall("not_judged", "no measure of its reference is judged on its own graph")


def told(judged: Judgement) -> str:
    """A judgement's value in words."""
    value = "without error" if judged.value is None else f"{judged.value:.4g}"
    return f"{judged.pass_name}.{judged.measure}: {judged.metric} {value}{' ' * bool(judged.unit)}{judged.unit}"
