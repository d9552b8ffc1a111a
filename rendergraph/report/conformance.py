"""What `rg conform` found, as a record and as a table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Final

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

import rendergraph
from rendergraph.conformance.conform import ConformReport
from rendergraph.conformance.demand import Status
from rendergraph.conformance.demands import DEMANDS

SCHEMA: Final = "rendergraph.conformance/1"
_SHORT: Final[dict[Status, str]] = {"met": "yes", "missed": "NO", "exempt": "exempt", "not_tried": "-"}


def conformance_record(report: ConformReport) -> dict[str, Any]:
    """The report as JSON-ready data: demands with their codes, and every verdict with shortfalls and notes."""
    states = [verdict.status for verdict in report.verdicts]
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "device": {"renderer": report.renderer, "driver": report.driver},
        "nodes": list(report.nodes),
        "demands": {name: {"code": demand.code, "help": demand.help} for name, demand in DEMANDS.items()},
        "counts": {state: states.count(state) for state in _SHORT},
        "verdicts": [
            {**asdict(verdict), "notes": list(verdict.notes), "seconds": round(verdict.seconds, 3)}
            for verdict in report.verdicts
        ],
    }


def conformance_table(report: ConformReport) -> RenderableType:
    """One row a node, a column a demand; below it the exemptions and what could not be tried, with their reasons."""
    asked = list(dict.fromkeys(verdict.demand for verdict in report.verdicts))
    table = Table(box=None, pad_edge=False)
    table.add_column("node")
    for name in asked:
        table.add_column(name)
    table.add_column("s", justify="right")
    for node in report.nodes:
        own = [verdict for verdict in report.verdicts if verdict.node == node]
        table.add_row(node, *(_SHORT[v.status] for v in own), f"{sum(v.seconds for v in own):.1f}")
    told = [Text(f"{v.node} {v.demand}: {v.status.replace('_', ' ')}: {v.reason}") for v in report.verdicts if v.reason]
    return Group(table, *told)
