"""`rg bench --vs-full`: what specialising on the scene saves, in time and in bytes.

The two sides of one bench: A is the graph built in full, B the same graph for what its scene requires. Times come with
the verdict of paired statistics (:mod:`rendergraph.measure.statistics`), bytes and counts are exact.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any, Final

from rendergraph.measure.bench_job import Side
from rendergraph.measure.statistics import Change
from rendergraph.plan.explain import explain_decision
from rendergraph.plan.graph import Decision
from rendergraph.report.diff import FRAME, DiffOptions, diff_records

SCHEMA: Final = "rendergraph.vs_full/1"

#: What is counted, a frame: name in the counters, and what it is called.
COUNTED: Final = {
    "transient_bytes": "transient memory",
    "bytes_read": "bytes read",
    "bytes_written": "bytes written",
    "draws": "draws",
    "dispatches": "dispatches",
    "passes": "passes",
    "subpasses": "sub-passes",
    "resources": "resources",
    "barriers": "barriers",
}


@dataclass(frozen=True, slots=True)
class TimeSaved:
    """The time of a pass, or of the whole frame (``name`` empty), in milliseconds. ``saved`` is a share of the full
    time, negative where specialisation costs; ``low`` and ``high`` are its interval. ``verdict``: faster, slower,
    unchanged, inconclusive, or left_out for a pass that only the full graph runs.
    """

    name: str
    full_ms: float | None
    specialised_ms: float | None
    saved: float | None
    low: float | None
    high: float | None
    verdict: str
    reason: str


@dataclass(frozen=True, slots=True)
class Amount:
    """An exact quantity of a frame on both sides."""

    name: str
    full: int
    specialised: int

    @property
    def saved(self) -> float | None:
        """The share of the full amount that is saved; ``None`` of nothing."""
        return 1.0 - self.specialised / self.full if self.full else None


@dataclass(frozen=True, slots=True)
class VsFull:
    """What is saved, and the decisions behind it: each as its record's ``kind``, ``reason``, ``subject``, ``why``."""

    graph: str
    frame: TimeSaved
    passes: tuple[TimeSaved, ...]
    amounts: tuple[Amount, ...]
    decisions: tuple[dict[str, Any], ...]


def vs_full_sides(graph: str, overrides: tuple[str, ...] = ()) -> dict[str, Side]:
    """The sides to bench: A full, B specialised."""
    return {"A": Side(graph, overrides, full=True), "B": Side(graph, overrides)}


def vs_full(path: str | Path, options: DiffOptions | None = None) -> VsFull:
    """What a bench file of :func:`vs_full_sides` says.

    :raises RenderGraphError: as :func:`rendergraph.report.diff.diff_records`.
    """
    comparison = diff_records(str(path), options=options)
    record = json.loads(Path(path).read_text(encoding="utf-8"))
    full, specialised = record["sides"]["A"], record["sides"]["B"]
    times = {entry.name: _saved(entry.name, entry.change) for entry in comparison.times}
    kept = {entry["name"] for entry in specialised["passes"]}
    gone = [entry["name"] for entry in full["passes"] if entry["name"] not in kept]
    left_out = [TimeSaved(name, _median(record, name), 0.0, 1.0, None, None, "left_out", "left_out") for name in gone]
    passes = [times[entry["name"]] for entry in full["passes"] if entry["name"] in times] + left_out
    decisions = [
        {**d, "why": explain_decision(Decision(**d))}
        for d in specialised["resources"]["decisions"]
        if d["kind"] == "specialise"
    ]
    amounts = (_amounts(full), _amounts(specialised))
    return VsFull(
        full["graph"],
        times[FRAME],
        tuple(sorted(passes, key=lambda entry: -((entry.full_ms or 0.0) - (entry.specialised_ms or 0.0)))),
        tuple(Amount(name, amounts[0][name], amounts[1][name]) for name in COUNTED),
        tuple(decisions),
    )


def vs_full_record(found: VsFull) -> dict[str, Any]:
    """As JSON-ready data."""
    return {
        "schema": SCHEMA,
        "graph": found.graph,
        "frame": asdict(found.frame),
        "passes": [asdict(entry) for entry in found.passes],
        "amounts": [{**asdict(entry), "saved": entry.saved} for entry in found.amounts],
        "decisions": list(found.decisions),
    }


def _saved(name: str, change: Change) -> TimeSaved:
    def share(shift: float | None) -> float | None:
        return -shift / change.before if shift is not None and change.before else None

    return TimeSaved(
        name,
        change.before,
        change.after,
        share(change.shift),
        share(change.high),
        share(change.low),
        change.verdict.value,
        change.reason,
    )


def _median(record: dict[str, Any], name: str) -> float | None:
    samples = [value for block in record["blocks"] for value in block["A"]["passes"].get(name, ())]
    return median(samples) if samples else None


def _amounts(side: dict[str, Any]) -> dict[str, int]:
    resources = side["resources"]
    counted = {
        name: sum(entry["counters"][name] or 0 for entry in side["passes"])
        for name in ("bytes_read", "bytes_written", "draws", "dispatches")
    }
    return {
        **counted,
        "transient_bytes": resources["totals"]["used"],
        "passes": len(side["passes"]),
        "subpasses": len(resources["order"]),
        "resources": len(resources["resources"]),
        "barriers": len(resources["barriers"]),
    }
