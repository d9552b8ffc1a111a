"""The terminal's view of a sweep, drawn from the record so that both say the same."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.report.accuracy_table import shown
from rendergraph.report.tables import mebibytes

_BARS = "▁▂▃▄▅▆▇█"
_PLAIN = "_.-~+*#@"
_SHAPES = {
    "falls": "falls",
    "flat": "does not fall: flat",
    "rises": "does not fall: rises",
    "bumpy": "falls, not evenly",
}
_WHY = {
    "asked": "as asked",
    "one_pass": "the reference of the one pass that is swept",
    "several_passes": "what is swept belongs to no single pass",
    "no_ideal_reference": "the swept pass's node has no ideal reference",
}


def sweep_tables(record: dict[str, Any]) -> tuple[RenderableType, ...]:
    """Every setting, the largest error first; the error along each quality axis; what to take."""
    parts: list[RenderableType] = [_settings(record)]
    if any(axis["errors"] for axis in record["axes"]):
        parts.append(_axes(record))
    parts.append(_advice(record))
    return tuple(parts)


def _settings(record: dict[str, Any]) -> RenderableType:
    error = record["error"]
    unit = f"{error['metric']} of {error['quantity']}"
    title = f"Settings by {error['name']} ({unit}; {_WHY[error['why']]})"
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    for axis in record["axes"]:
        table.add_column(axis["name"], justify="right", no_wrap=True)
    for heading in ("ms", "95 %", "bytes", "error", "verdict"):
        table.add_column(heading, justify="left" if heading in ("95 %", "verdict") else "right", no_wrap=True)
    chosen = record["recommended"]["point"] if record["recommended"] else None
    order = sorted(range(len(record["points"])), key=lambda at: _worst_first(record["points"][at]))
    for at in order:
        point = record["points"][at]
        mark = ("→" if at == chosen else " ") + ("●" if point["front"] else " ")
        values = [override.partition("=")[2] for override in point["set"]]
        table.add_row(_plain(mark), *values, *_measured(point), style="bold" if point["front"] else "")
    if not any(point["own"] for point in record["points"]):
        table.add_row("", *["as is"] * len(record["axes"]), *_measured(record["control"]), style="dim")
    legend = _plain("● on the Pareto front of time, bytes and error · → recommended")
    return Group(table, Text(legend, style="dim"))


def _worst_first(point: dict[str, Any]) -> tuple[float, float]:
    error = {"inf": float("inf"), None: float("inf")}.get(point["error"], point["error"])
    return -error, point["ms"]["estimate"] if point["ms"] else 0.0


def _measured(point: dict[str, Any]) -> list[str]:
    ms = point["ms"]
    if ms is None:
        return ["", "", "", "", f"refused: {point['reason']}"]
    high = ms["high"] if isinstance(ms["high"], str) else f"{ms['high']:.3f}"
    spread = "" if point["own"] else f"{ms['low']:.3f} {_plain('–')} {high}"
    error = shown(point["error"])
    if point["standard_error"]:
        error += f" {_plain('±')} {shown(point['standard_error'])}"
    notes = [point["verdict"].replace("_", " ")]
    notes += ["as is"] * point["own"] + ["contended"] * point["contended"] + ["not steady"] * (not point["steady"])
    return [f"{ms['estimate']:.3f}", spread, mebibytes(point["bytes"]), error, ", ".join(notes)]


def _axes(record: dict[str, Any]) -> RenderableType:
    title = "Error along each quality axis, cheap to accurate"
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for heading in ("axis", "error", "", "values", "at"):
        table.add_column(heading, no_wrap=True)
    for axis in record["axes"]:
        if axis["errors"]:
            at = ", ".join(axis["at"]) if axis["method"] == "slice" else "mean over all settings"
            steps = ", ".join(f"{v}: {shown(e)}" for v, e in zip(axis["values"], axis["errors"], strict=True))
            table.add_row(axis["name"], sparkline(axis["errors"]), _SHAPES.get(axis["shape"], "unknown"), steps, at)
    return table


def sparkline(values: Sequence[float | str | None], plain: bool | None = None) -> str:
    """A letter a value, from 0 to the largest; ``?`` for none. ``plain`` ASCII by default where NO_COLOR is set or the
    terminal is dumb.
    """
    letters = _PLAIN if (_dumb() if plain is None else plain) else _BARS
    known = [value for value in values if isinstance(value, int | float)]
    most = max(known, default=0.0)

    def letter(value: float | str | None) -> str:
        if not isinstance(value, int | float):
            return "?" if value is None else letters[-1]
        return letters[round(value / most * (len(letters) - 1))] if most > 0 else letters[0]

    return "".join(letter(value) for value in values)


def _advice(record: dict[str, Any]) -> RenderableType:
    limits, chosen, lines = record["limits"], record["recommended"], []
    if chosen:
        why = "the nearest to the best time and the best error at once"
        if limits["budget_ms"] is not None:
            why = f"the most accurate within {limits['budget_ms']:g} ms"
        elif limits["max_error"] is not None:
            why = f"the fastest with an error of at most {limits['max_error']:g}"
        cost = f"{chosen['ms']:.3f} ms, {mebibytes(chosen['bytes'])}, error {shown(chosen['error'])}"
        lines.append(f"take ({why}): {cost}")
        lines.append(f"  {chosen['set']}")
    else:
        lines.append("no setting to recommend")
    device = record["device"]
    lines.append(f"{device['renderer']}, {record['size'][0]}x{record['size'][1]}; " + _plain(_design(record)))
    return Text("\n".join(lines))


def _design(record: dict[str, Any]) -> str:
    design = record["design"]
    note = "" if record["complete"] else "; interrupted: run the same command again to go on"
    return f"{design['rounds']} rounds of {design['frames']} frames in turn with the document's own setting{note}"


def _dumb() -> bool:
    return "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb"


def _plain(text: str) -> str:
    """The text in ASCII where the terminal asks for that."""
    if not _dumb():
        return text
    return text.translate({ord("●"): "*", ord("→"): ">", ord("–"): "-", ord("±"): "+-", ord("·"): "|"})
