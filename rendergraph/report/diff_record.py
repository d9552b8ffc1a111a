"""A comparison as JSON-ready data, schema ``rendergraph.diff/1``."""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from typing import Any, Final

from rendergraph.document.render_text import diagnostic_json
from rendergraph.report.diff import Comparison
from rendergraph.report.diff_text import sentence

SCHEMA: Final = "rendergraph.diff/1"


def diff_record(comparison: Comparison, gate: str) -> dict[str, Any]:
    """All findings, worst first; times in milliseconds; ``null`` for what is not known or not finite. The whole frame
    stands among the times with the name ``null``.
    """
    return {
        "schema": SCHEMA,
        "before": comparison.before,
        "after": comparison.after,
        "gate": gate,
        "compared": sorted(comparison.compared),
        "thresholds": {
            **asdict(comparison.options.thresholds),
            "image_rmse": comparison.options.image_tolerance,
        },
        "regressions": [sentence(found) for found in comparison.regressions(gate)],
        "exact": [{**asdict(change), "direction": change.direction.value} for change in comparison.exact],
        "times": [
            {
                "name": entry.name or None,
                "node": entry.node or None,
                **{key: _plain(value) for key, value in asdict(entry.change).items()},
                "verdict": entry.change.verdict.value,
                "relative": _plain(entry.change.relative),
            }
            for entry in comparison.times
        ],
        "images": [
            {
                "name": image.name,
                "status": image.status,
                "error": {k: _plain(v) for k, v in asdict(image.error).items()} if image.error else None,
            }
            for image in comparison.images
        ],
        "warnings": [diagnostic_json(found) for found in comparison.warnings],
    }


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return list(value)
    return None if isinstance(value, float) and not isfinite(value) else value
