"""Demand `extremes`: the node survives the common extremes and those it declares itself (`rg stress NODE`)."""

from __future__ import annotations

from collections.abc import Iterator

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.measure.stress.outcome import BROKEN


def check_extremes(subject: Subject) -> Iterator[Shortfall | Note]:
    """Extremes of its own, bounds of its float outputs, and no failure at any extreme."""
    node = subject.node
    if not node.extremes:
        yield Shortfall(
            "none_declared", "declare extremes = (Extreme(...), ...): the cases that this technique finds hard"
        )
    unbounded = [name for name, port in node.outputs.items() if port.formats and name not in node.bounds]
    if unbounded and not node.exact:
        text = f"{', '.join(unbounded)}: declare in bounds the least and largest value that the output may ever hold"
        yield Shortfall("unbounded", text)
    report = subject.stressed
    for case in report.failed:
        if case.state in BROKEN:
            yield Shortfall(case.state, f"{case.name}: {case.code} {case.text}".strip())
        for entry in case.passes:
            for failure in entry.failures if entry.status == "fail" else ():
                yield Shortfall(f"not_{failure.check}", f"{case.name}: {entry.name}: {failure.text}")
    tried = [case for case in report.cases if case.state in ("ran", "refused")]
    yield Note(f"{len(tried)} extremes tried, {len(report.cases) - len(tried)} do not apply to its graph")
