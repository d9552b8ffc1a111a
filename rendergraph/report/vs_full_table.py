"""What specialisation saves, as terminal tables."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.measure.vs_full import COUNTED, TimeSaved, VsFull

_STYLES = {"faster": "green", "left_out": "green", "slower": "bold red", "inconclusive": "yellow", "unchanged": "dim"}
_SHOWN = 40  # decisions


def vs_full_tables(found: VsFull) -> Iterator[RenderableType]:
    """Times, exact amounts, and the decisions behind them."""
    times = Table(title="Saved time", title_justify="left", box=None, pad_edge=False)
    for heading in ("pass", "verdict"):
        times.add_column(heading, no_wrap=True)
    for heading in ("full ms", "specialised ms", "saved", "interval"):
        times.add_column(heading, justify="right", no_wrap=True)
    for entry in (found.frame, *found.passes):
        times.add_row(
            Text(entry.name or "whole frame"),
            Text(entry.verdict.replace("_", " "), _STYLES[entry.verdict]),
            milliseconds(entry.full_ms),
            milliseconds(entry.specialised_ms),
            share(entry.saved),
            interval(entry),
        )
    yield times
    amounts = Table(title="Saved amounts, a frame", title_justify="left", box=None, pad_edge=False)
    amounts.add_column("", no_wrap=True)
    for heading in ("full", "specialised", "saved"):
        amounts.add_column(heading, justify="right", no_wrap=True)
    for amount in found.amounts:
        saved = share(amount.saved)
        amounts.add_row(COUNTED[amount.name], f"{amount.full:,}", f"{amount.specialised:,}", saved)
    yield amounts
    lines = [Text("Because", "italic"), *(Text(f"  {d['why']}") for d in found.decisions[:_SHOWN])]
    if len(found.decisions) > _SHOWN:
        lines.append(Text(f"  and {len(found.decisions) - _SHOWN} more"))
    yield Text("\n").join(lines if found.decisions else [Text("Nothing could be left out")])


def milliseconds(value: float | None) -> str:
    """To the microsecond."""
    return "" if value is None else f"{value:.3f}"


def share(value: float | None) -> str:
    """In percent."""
    return "" if value is None else f"{100 * value:.1f} %"


def interval(entry: TimeSaved) -> str:
    """What the saving lies between."""
    return "" if entry.low is None or entry.high is None else f"{share(entry.low)} .. {share(entry.high)}"
