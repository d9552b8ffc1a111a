"""The terminal table of errors beside times and bytes, drawn from the record so that both say the same."""

from __future__ import annotations

from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.report.tables import mebibytes

_STYLES = {"within": "green", "above": "bold red", "cannot_judge": "bold yellow", "": "dim"}
_SAID = {"within": "within", "above": "above", "cannot_judge": "cannot judge", "": "no reference"}


def accuracy_table(record: dict[str, Any]) -> RenderableType:
    """One row a measure: what its pass takes, its error, tolerance and verdict."""
    table = Table(title="Accuracy", title_justify="left", box=None, pad_edge=False)
    for heading, justify in (
        ("pass", "left"),
        ("node", "left"),
        ("median ms", "right"),
        ("bytes", "right"),
        ("measure", "left"),
        ("metric", "left"),
        ("error", "right"),
        ("tolerance", "right"),
        ("verdict", "left"),
        ("worst texel", "left"),
        ("reference", "left"),
    ):
        table.add_column(heading, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    for entry in record["passes"]:
        takes = ["" if entry["ms"] is None else f"{entry['ms']:.3f}", mebibytes(entry["bytes"])]
        if not entry["measures"]:
            table.add_row(entry["name"], entry["node"], *takes, "", "", "", "", _verdict(""), "", entry["reason"])
        for index, measure in enumerate(entry["measures"]):
            first = [entry["name"], entry["node"], *takes] if index == 0 else ["", "", "", ""]
            table.add_row(*first, *_measure(measure), _reference(entry) if index == 0 else "")
    counts = record["verdicts"]
    broken = sum(len(entry["broken"]) for entry in record["passes"])
    unjudged = sum(not entry["measures"] for entry in record["passes"])
    line = f"{counts['within']} within, {counts['above']} above their tolerance, {counts['cannot_judge']} not judged"
    line += f" · {broken} broken invariants · {unjudged} passes without a verdict · frame {record['frame']}"
    return Group(table, Text(line, style="dim"))


def _measure(measure: dict[str, Any]) -> list[str | Text]:
    unit = f" {measure['unit']}" if measure["unit"] else ""
    worst = measure["worst_texel"]
    masked = f", {100 * measure['masked']:.1f} % masked" if measure["masked"] else ""
    return [
        measure["name"],
        measure["metric"],
        shown(measure["value"]) + unit,
        shown(measure["tolerance"]) + unit,
        _verdict(measure["verdict"]),
        (f"({worst['x']}, {worst['y']})" if worst else "") + masked,
    ]


def _verdict(verdict: str) -> Text:
    return Text(_SAID[verdict], _STYLES[verdict])


def _reference(entry: dict[str, Any]) -> str:
    return f"{entry['method']}, {entry['reference_ms']:.0f} ms" + (" (cached)" if entry["cached"] else "")


def shown(value: float | str | None) -> str:
    """A number of the record."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.4g}"
