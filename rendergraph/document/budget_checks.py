"""Checks that a budget's passes are passes of the graph.

Works on the plain data of the file, so that these mistakes are reported together with all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.document.node_checks import Locate
from rendergraph.document.suggest import did_you_mean


def check_budget_names(data: Mapping[str, Any], locate: Locate) -> list[Diagnostic]:
    """RG706 for every pass that has a budget but does not exist; ``locate(*loc, key=False)`` gives positions.

    Parts of ``data`` of the wrong type are passed over: the document's own models report them.
    """
    budget, passes = data.get("budget"), data.get("passes")
    if not isinstance(budget, dict) or not isinstance(passes, dict):
        return []
    limits = [(kind, budget.get(kind)) for kind in ("passes", "error")]
    return [
        diagnose(
            "RG706",
            locate("budget", kind, name, key=True),
            name=name,
            hint=did_you_mean(name, passes, "passes: {choices}"),
        )
        for kind, by_name in limits
        if isinstance(by_name, dict)
        for name in by_name
        if name not in passes
    ]
