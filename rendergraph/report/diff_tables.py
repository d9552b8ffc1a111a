"""A comparison as terminal tables, worst first."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import Comparison
from rendergraph.report.diff_exact import Direction
from rendergraph.report.diff_text import image_sentence, interval, milliseconds, pass_label, percent, summary, why

_STYLES = {
    Verdict.SLOWER.value: "bold red",
    Verdict.FASTER.value: "green",
    Verdict.INCONCLUSIVE.value: "yellow",
    Verdict.UNCHANGED.value: "dim",
    Direction.WORSE.value: "bold red",
    Direction.BETTER.value: "green",
    Direction.CHANGED.value: "yellow",
}


def diff_tables(comparison: Comparison, gate: str) -> Iterator[RenderableType]:
    """Exact differences, times, images, and the outcome."""
    if "exact" in comparison.compared:
        yield _exact_table(comparison) if comparison.exact else Text("Exact quantities: equal")
    if "time" in comparison.compared:
        yield _time_table(comparison)
    if "images" in comparison.compared:
        lines = [Text(image_sentence(i), "bold red" if i.worse else "") for i in comparison.images]
        yield Text("\n").join([Text("Images", "italic"), *lines])
    failed = bool(comparison.regressions(gate))
    yield Text(summary(comparison, gate), "bold red" if failed else "bold green")


def _exact_table(comparison: Comparison) -> Table:
    table = Table(title="Exact quantities", title_justify="left", box=None, pad_edge=False)
    table.add_column("", no_wrap=True)
    table.add_column("difference", overflow="fold")
    for change in comparison.exact:
        table.add_row(Text(change.direction.value, _STYLES[change.direction.value]), Text(change.text))
    return table


def _time_table(comparison: Comparison) -> Table:
    confidence = 100 * (1 - comparison.options.thresholds.alpha)
    table = Table(title="Times", title_justify="left", box=None, pad_edge=False)
    for heading in ("pass", "verdict"):
        table.add_column(heading, no_wrap=True)
    for heading in ("before ms", "after ms", "shift ms", "shift", f"{confidence:g} % interval ms", "p (Holm)"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("why", overflow="fold")
    for entry in comparison.times:
        change = entry.change
        table.add_row(
            Text(pass_label(entry)),
            Text(change.verdict.value, _STYLES[change.verdict.value]),
            milliseconds(change.before),
            milliseconds(change.after),
            milliseconds(change.shift, sign=True),
            percent(entry),
            interval(entry),
            "" if change.p_adjusted is None else f"{change.p_adjusted:.2g}",
            why(entry),
        )
    return table
