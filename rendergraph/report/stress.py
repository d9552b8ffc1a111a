"""What `rg stress` found, as a record and in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any, Final

import rendergraph
from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.measure.stress.outcome import BadTexel, CaseOutcome
from rendergraph.measure.stress.stress import StressReport

SCHEMA: Final = "rendergraph.stress/1"

_BROKEN: Final = {"failed": "RG766", "not_refused": "RG767", "crashed": "RG772", "timed_out": "RG772"}


def stress_record(report: StressReport) -> dict[str, Any]:
    """The report as JSON-ready data, of the shape :class:`rendergraph.report.stress_shape.StressRecord`."""
    states = [case.state for case in report.cases]
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": report.document.model.title,
        "size": list(report.size),
        "graph": report.target.file.name,
        "node": report.target.node,
        "device": {"renderer": report.renderer, "driver": report.driver},
        "counts": {
            "extremes": len(report.cases),
            "failed": len(report.failed),
            "refused": states.count("refused"),
            "not_applicable": states.count("not_applicable"),
        },
        "extremes": [_extreme(case) for case in report.cases],
    }


def _extreme(case: CaseOutcome) -> dict[str, Any]:
    plain: dict[str, Any] = _plain(asdict(case))
    for entry in plain["passes"]:
        entry["skipped"] = [{"check": check, "reason": reason} for check, reason in entry["skipped"].items()]
    return {**plain, "failed": case.failed}


def _plain(value: Any) -> Any:
    """Lists for tuples, and the names of the numbers that JSON has not."""
    if isinstance(value, dict):
        return {key: _plain(held) for key, held in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(held) for held in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def stress_findings(report: StressReport) -> Iterable[Diagnostic]:
    """RG765 for each pass that fails an extreme, at the pass; RG766, RG767 and RG772 for runs that ended badly."""
    target = report.target.node or report.target.file.name
    for case in report.failed:
        if case.state in _BROKEN:
            text = f"{case.code} {case.text}".strip()
            yield diagnose(_BROKEN[case.state], None, extreme=case.name, text=text, target=target)
        for entry in case.passes:
            place = report.document.position("passes", entry.name, key=True)
            for failure in entry.failures if entry.status == "fail" else ():
                where = (
                    ""
                    if failure.texel is None
                    else f"; {'worst' if failure.check == 'error' else 'first'} {place_of(failure.texel)}"
                )
                yield diagnose(
                    "RG765", place, extreme=case.name, name=entry.name, node=entry.node, text=failure.text,
                    where=where, target=target, check=failure.check,
                )  # fmt: skip


def place_of(texel: BadTexel) -> str:
    """A bad texel with its inputs, in words."""
    layer = f" of layer {texel.layer}" if texel.layer else ""
    inputs = ", ".join(f"{port} {_tuple(values)}" for port, values in texel.inputs.items())
    given = f" with {inputs}" if inputs else ""
    return f"({texel.x}, {texel.y}){layer} of {texel.port}: {_tuple(texel.value)}{given}"


def _tuple(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in values) + ")"
