"""A stress report made up, with one of everything."""

from __future__ import annotations

import json
from typing import Any

from rendergraph.document.load import load_document
from rendergraph.measure.stress.outcome import BadTexel, CaseOutcome, Failure, PassOutcome
from rendergraph.measure.stress.stress import StressReport
from rendergraph.measure.stress.target import find_target
from rendergraph.report.stress import stress_record


def made_up_stress() -> dict[str, Any]:
    """A record: an extreme that fails, one that is refused."""
    texel = BadTexel("color", 3, 4, 0, (float("nan"), 0.5), {"color before": (float("inf"),)})
    passes = (
        PassOutcome("tonemap", "tonemap", "fail", (Failure("finite", "color is not finite", texel),), {"error": "why"}),
        PassOutcome("other", "tonemap", "not_run", reason="the plan leaves it out"),
    )
    cases = (
        CaseOutcome("frame_1x1", "One texel.", True, "ran", (1, 1), 0.25, passes=passes),
        CaseOutcome("white_of_zero", "No white.", False, "refused", (48, 27), 0.5, "RG123", "must be above 0"),
    )
    report = StressReport(find_target("tonemap"), load_document("tonemap"), (48, 27), cases, "made up", "1")
    made: dict[str, Any] = json.loads(json.dumps(stress_record(report), allow_nan=False))
    return made
