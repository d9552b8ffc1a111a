"""The terminal tables of a bench record: medians of each side, and what the frame is bound by."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.report.bound_text import bound_text


def bench_tables(record: dict[str, Any]) -> Iterator[RenderableType]:
    """Times, then bounds where they were asked for."""
    yield _times(record)
    for name, bound in record["bound"].items():
        yield Text(bound_text(name, bound))


def _times(record: dict[str, Any]) -> RenderableType:
    sides = list(record["sides"])
    first = record["sides"]["A"]
    table = Table(box=None, pad_edge=False)
    table.add_column("median ms", no_wrap=True)
    for name in sides:
        table.add_column(name, justify="right", no_wrap=True)
    if len(sides) == 2:
        table.add_column("B / A", justify="right", no_wrap=True)
    names = dict.fromkeys(entry["name"] for name in sides for entry in record["sides"][name]["passes"])
    for label in (None, *names):
        values = [_median(record["blocks"], side, label) for side in sides]
        row = [f"{value:.3f}" if value is not None else "" for value in values]
        if len(values) == 2:
            a, b = values
            row.append(f"{b / a:.3f}" if a and b is not None else "")
        table.add_row("whole frame" if label is None else f"  {label}", *row, style="bold" if label is None else None)
    design, device = record["design"], first["device"]
    lines = [
        f"{device['renderer']}, {device['driver']}, {device['threads']} threads, clock {first['clock']['name']}, "
        f"{first['size'][0]}x{first['size'][1]}",
        f"{design['processes']} processes x {design['blocks']} blocks x {design['frames']} frames",
    ]
    return Group(table, Text("\n".join(lines), style="dim"))


def _median(blocks: list[dict[str, Any]], side: str, name: str | None) -> float | None:
    runs = [block[side]["frame_ms"] if name is None else block[side]["passes"].get(name, []) for block in blocks]
    samples = [value for run in runs for value in run]
    return median(samples) if samples else None
