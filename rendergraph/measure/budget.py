"""Compares what the records of a run say it took with the ``budget:`` of the graph file, and names who is to blame."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any, Final

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, diagnose

_MIB: Final = 2**20
_SHOWN: Final = 3  # holders of the peak that are named
_UNTIMED: Final = {"reason": "no frame was timed", "hint": "time some with --samples"}


@dataclass(frozen=True, slots=True)
class Spending:
    """What a run took a frame. Times are medians in milliseconds, ``None`` or absent where nothing was timed.

    ``frame_ms`` is of whole frames; ``passes_ms`` goes by pass, and ``draws`` too, with every pass that ran;
    ``steps_ms`` by sub-pass, ``pass.step``. ``draw_calls`` are of the frame.
    """

    frame_ms: float | None = None
    passes_ms: Mapping[str, float] = field(default_factory=dict)
    steps_ms: Mapping[str, float] = field(default_factory=dict)
    draws: Mapping[str, int] = field(default_factory=dict)
    draw_calls: int = 0


def check_run(
    document: Document, timing: Mapping[str, Any], resources: Mapping[str, Any], *, judged: bool = False
) -> list[Diagnostic]:
    """All limits against a run's timing and resources records: what both checks below find, errors first. ``judged``:
    errors were measured too, and their budgets are checked with them (report/accuracy_findings.py).
    """
    passes = timing["passes"]
    spent = Spending(
        frame_ms=_median(timing["frame_ms"]["samples"]),
        passes_ms=_medians((entry["name"], entry["ms"]["samples"]) for entry in passes),
        steps_ms=_medians((step["name"], step["ms"]["samples"]) for entry in passes for step in entry["subpasses"]),
        draws={entry["name"]: entry["counters"]["draws"] for entry in passes},
        draw_calls=sum(entry["counters"]["draw_calls"] for entry in passes),
    )
    found = [*check_memory(document, resources), *check_spending(document, spent)]
    return _errors_first([finding for finding in found if not (judged and finding.code == "RG709")])


def check_bench(document: Document, bench: Mapping[str, Any], side: str) -> list[Diagnostic]:
    """All limits of ``document`` against its side, ``A`` or ``B``, of a bench record; errors first."""
    passes = bench["sides"][side]["passes"]
    blocks = [block[side] for block in bench["blocks"]]
    spent = Spending(
        frame_ms=_median([sample for block in blocks for sample in block["frame_ms"]]),
        passes_ms=_medians((e["name"], [s for block in blocks for s in block["passes"][e["name"]]]) for e in passes),
        steps_ms=_medians(
            (step["name"], [s for block in blocks for s in block["subpasses"][step["name"]]])
            for entry in passes
            for step in entry["subpasses"]
        ),
        draws={entry["name"]: entry["counters"]["draws"] for entry in passes},
        draw_calls=sum(entry["counters"]["draw_calls"] for entry in passes),
    )
    who = f"side {side}: " if len(bench["sides"]) > 1 else ""
    resources = bench["sides"][side]["resources"]
    found = [*check_memory(document, resources, who=who), *check_spending(document, spent, who=who)]
    # Errors are judged apart (bench_errors.py).
    return _errors_first([finding for finding in found if finding.code != "RG709"])


def check_memory(
    document: Document, resources: Mapping[str, Any], *, assumed: bool = False, who: str = ""
) -> list[Diagnostic]:
    """RG703 when a resources record exceeds the budget of memory, and RG709 for budgets that need references.

    ``assumed``: the plan is for a scene with every feature, not for the real one; RG705 then, a warning. ``who`` goes
    before the message.
    """
    budget, found = document.model.budget, []
    used, peak = resources["totals"]["used"] / _MIB, resources["peak"]
    if budget.transient_mib is not None and used > budget.transient_mib and peak is not None:
        advice = resources["advice"]
        hint = advice[0]["why"] if advice else f"narrow or scale '{peak['resources'][0]['name']}', or raise the limit"
        values = {
            "who": who,
            "found": used,
            "limit": budget.transient_mib,
            "at": peak["subpass"],
            "peak": _listed(peak["resources"]),
            "hint": hint,
        }
        code = "RG705" if assumed else "RG703"
        found.append(diagnose(code, document.position("budget", "transient_mib"), **values))
    for what in ("flip", "error"):
        if getattr(budget, what) not in (None, {}):
            found.append(diagnose("RG709", document.position("budget", what), what=what))
    return found


def check_spending(document: Document, spent: Spending, *, who: str = "") -> list[Diagnostic]:
    """RG701, RG702 and RG704 for every limit exceeded, and notes (RG707, RG708) for those that nothing was compared
    with. ``who`` goes before the message.
    """
    budget, found = document.model.budget, []
    if budget.frame_ms is not None:
        place = document.position("budget", "frame_ms")
        if spent.frame_ms is None:
            found.append(diagnose("RG708", place, what="frame_ms", **_UNTIMED))
        elif spent.frame_ms > budget.frame_ms:
            name, took = _most(spent.passes_ms)
            values = {
                "found": spent.frame_ms,
                "limit": budget.frame_ms,
                "share": 100 * took / (sum(spent.passes_ms.values()) or 1),
            }
            found.append(diagnose("RG701", place, who=who, name=name, node=_node(document, name), **values))
    for name, limit in budget.passes.items():
        place = document.position("budget", "passes", name)
        if name not in spent.draws:
            found.append(diagnose("RG707", document.position("budget", "passes", name, key=True), name=name))
        elif name not in spent.passes_ms:
            found.append(diagnose("RG708", place, what=f"pass '{name}'", **_UNTIMED))
        elif spent.passes_ms[name] > limit:
            values = {"found": spent.passes_ms[name], "limit": limit}
            worst, node = _worst_step(name, spent), _node(document, name)
            found.append(diagnose("RG702", place, who=who, name=name, node=node, worst=worst, **values))
    total = sum(spent.draws.values())
    if budget.draws is not None and total > budget.draws:
        name, most = _most(spent.draws)
        place = document.position("budget", "draws")
        values = {"found": total, "calls": spent.draw_calls, "limit": budget.draws}
        found.append(diagnose("RG704", place, who=who, name=name, most=most, **values))
    return found


def _node(document: Document, name: str) -> str:
    return document.model.passes[name].node


def _errors_first(found: list[Diagnostic]) -> list[Diagnostic]:
    return sorted(found, key=lambda finding: finding.severity != "error")


def _worst_step(name: str, spent: Spending) -> str:
    """The slowest of a pass's sub-passes, where it has several."""
    steps = {step: took for step, took in spent.steps_ms.items() if step.partition(".")[0] == name}
    if len(steps) < 2:
        return ""
    worst, took = _most(steps)
    return f", and {took:.3f} ms of it are '{worst}'"


def _most(by_name: Mapping[str, float]) -> tuple[str, float]:
    name = max(sorted(by_name), key=by_name.__getitem__)
    return name, by_name[name]


def _listed(holders: Iterable[Mapping[str, Any]]) -> str:
    shown = [f"'{holder['name']}' ({holder['bytes'] / _MIB:.2f} MiB)" for holder in holders]
    rest = len(shown) - _SHOWN
    return ", ".join(shown[:_SHOWN]) + (f" and {rest} more" if rest > 0 else "")


def _median(samples: list[float]) -> float | None:
    return median(samples) if samples else None


def _medians(samples: Iterable[tuple[str, list[float]]]) -> dict[str, float]:
    return {name: median(values) for name, values in samples if values}
