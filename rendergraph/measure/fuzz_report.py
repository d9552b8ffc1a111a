"""What `rg fuzz` found, as a record and in sentences."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any, Final

import rendergraph
from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.measure.fuzz import Failure, FuzzOptions, FuzzReport
from rendergraph.measure.fuzz_trace import Culprit

SCHEMA: Final = "rendergraph.fuzz/1"

_GUILTY: Final = {
    "order": "the order of the passes",
    "poison": "what transients hold before their first use",
    "alias": "whether transients share memory",
    "full": "specialisation on the scene",
}
_REASONS: Final = {
    "left_unwritten": "{subpass} leaves {texel} of {resource} unwritten, {count}",
    "writes_differ": "{subpass} is the first to write another {resource} from equal inputs: {texel}, {count}",
    "overwritten": "{subpass}, writing {by}, overwrites {resource}, which is still needed: {texel}, {count}",
    "runs_only_here": "{subpass}, which writes {resource}, does not run in the usual plan",
    "read_too_early": "{subpass} reads {resource} before anything has written it",
    "not_found": "no single sub-pass was found to begin it",
}


def fuzz_record(report: FuzzReport, title: str, options: FuzzOptions) -> dict[str, Any]:
    """The report as JSON-ready data. NaN and infinities become text."""
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": title,
        "size": list(report.size),
        "frames": report.frames,
        "seed": options.seed,
        "runs": report.runs,
        "orders": report.orders,
        "failed": report.failed,
        "failure": None if report.failure is None else _failure(report.failure),
    }


def _failure(failure: Failure) -> dict[str, Any]:
    culprit = failure.culprit
    return {
        "case": {**asdict(failure.case), "order": _order(failure.case.order)},
        "guilty": list(failure.guilty),
        "swaps": [list(pair) for pair in failure.swaps],
        "output": failure.output,
        "frame": failure.frame,
        "error": failure.error,
        "culprit": None
        if culprit is None
        else {
            **asdict(culprit),
            "pass": culprit.pass_name,
            "expected": [_number(v) for v in culprit.expected],
            "found": [_number(v) for v in culprit.found],
        },
    }


def _order(order: int | tuple[str, ...] | None) -> int | list[str] | None:
    return list(order) if isinstance(order, tuple) else order


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else str(value)


def fuzz_findings(report: FuzzReport, document: Document) -> list[Diagnostic]:
    """RG775 for an image that differs, RG776 for a variation that fails; at the pass to blame."""
    failure = report.failure
    if failure is None:
        return []
    guilty = " and ".join(_GUILTY[name] for name in failure.guilty) or "chance alone: equal runs differ"
    if failure.error:
        return [diagnose("RG776", None, guilty=guilty, reason=failure.error)]
    culprit = failure.culprit
    place = document.position("passes", culprit.pass_name, key=True) if culprit and culprit.subpass else None
    swaps = "".join(f"; {a} runs before {b}" for a, b in failure.swaps)
    return [
        diagnose(
            "RG775",
            place,
            output=failure.output,
            frame=failure.frame,
            failed=report.failed,
            runs=report.runs,
            guilty=guilty + swaps,
            blame=blame(culprit) if culprit else _REASONS["not_found"],
        )
    ]


def blame(culprit: Culprit) -> str:
    """Who made the difference, where, and by what values."""
    where = f"word {culprit.x}" if culprit.buffer else f"texel ({culprit.x}, {culprit.y})"
    where += "".join(f" of {name} {at}" for name, at in (("layer", culprit.layer), ("mip", culprit.mip)) if at)
    values = f"{_texel(culprit.found)} instead of {_texel(culprit.expected)} in frame {culprit.frame}"
    return _REASONS[culprit.reason].format(
        subpass=culprit.subpass,
        resource=culprit.resource,
        by=culprit.by,
        texel=f"{where} is {values}" if culprit.reason != "left_unwritten" else f"{where} ({values})",
        count=f"{culprit.differing} of {culprit.texels} {'words' if culprit.buffer else 'texels'} in all",
    )


def _texel(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"
