"""Puts the page together: every figure comes from the plan or the timing record, every text is escaped by the template.

The page asks the network for nothing, and its content security policy forbids it to.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache, partial
from importlib.resources import files
from pathlib import Path
from typing import Any

import rendergraph
from rendergraph.document.messages import Diagnostic
from rendergraph.document.whole_files import whole_file
from rendergraph.plan.barriers import BITS
from rendergraph.plan.explain import all_decisions, explain_decision
from rendergraph.plan.plan import Barrier, Plan
from rendergraph.report.bound_text import agreement, evidence
from rendergraph.report.drawing import drawing, svg
from rendergraph.report.html.memory import lifetime_chart
from rendergraph.report.html.targets import TargetGallery, target_entries
from rendergraph.report.html.times import AXIS, time_chart

#: What each kind of decision is about, in the order a reader asks.
_KINDS = {
    "expand": "Expanded", "specialise": "Specialised", "cull": "Culled", "order": "Ordered",
    "alias": "Memory shared", "barrier": "Barriers",
}  # fmt: skip

#: What the viewer of ``page.js`` needs of a target.
_VIEWED = (
    "name", "format", "width", "height", "layers", "layer_width", "channels", "columns", "rows",
    "samples", "type", "scale", "low", "high", "srgb", "data",
)  # fmt: skip


def html_page(
    plan: Plan,
    *,
    title: str = "",
    timing: dict[str, Any] | None = None,
    targets: TargetGallery | None = None,
    warnings: Sequence[Diagnostic] = (),
    accuracy: Sequence[dict[str, Any]] | None = None,
) -> str:
    """One self-contained page: of a plan alone, or with the ``timing`` record and ``targets`` of a run of it, and
    ``accuracy`` (:func:`rendergraph.report.html.accuracy.accuracy_entries`) where it was held against references.
    """
    timed = {entry["name"] for entry in timing["passes"]} if timing else set()
    entries = target_entries(plan.graph, targets.views) if targets else []
    text: str = (
        _environment()
        .get_template("page.html.jinja")
        .render(
            title=title or "Render graph",
            version=rendergraph.__version__,
            css=_text("page.css"),
            js=_text("page.js"),
            plan=plan,
            graph_svg=svg(drawing(plan), partial(_address, timed)),
            timing=timing,
            times=time_chart(timing) if timing else None,
            axis=AXIS,
            memory=lifetime_chart(plan),
            targets=entries,
            shown={entry["name"] for entry in entries},
            numbers=[{key: entry[key] for key in _VIEWED} for entry in entries],
            barriers=[(plan.order[b.index].name, _barrier_names(b), b.hazards) for b in plan.barriers],
            decisions=list(_decisions(plan)),
            warnings=warnings,
            accuracy=accuracy,
            agreement=agreement,
            evidence=evidence,
        )
    )
    return text


def write_page(path: Path, text: str) -> None:
    """Write a page, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _address(timed: set[str], kind: str, name: str) -> str:
    return "" if kind == "pass" and name not in timed else f"#{kind}-{name}"


def _barrier_names(barrier: Barrier) -> list[str]:
    names = [name for name, bit in BITS.items() if barrier.bits & bit]
    return names + ["texture_barrier"] * barrier.texture_barrier


def _decisions(plan: Plan) -> Iterable[tuple[str, list[tuple[str, str, str]]]]:
    """(heading, rows of subject, reason code and sentence) a kind of decision."""
    found = all_decisions(plan)
    for kind in dict.fromkeys([*_KINDS, *(d.kind for d in found)]):
        rows = [(d.subject, d.reason, explain_decision(d)) for d in found if d.kind == kind]
        if rows:
            yield _KINDS.get(kind, kind), rows


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


@cache
def _environment() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("rendergraph.report.html", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
