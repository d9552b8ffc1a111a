"""`rg diff`: two records side by side, and a verdict for CI."""

from __future__ import annotations

import os
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rendergraph.report.diff import Comparison


class DiffFormat(StrEnum):
    """How a comparison is printed."""

    TEXT = "text"
    JSON = "json"
    MARKDOWN = "markdown"
    GITHUB = "github"


class Gate(StrEnum):
    """What makes the command exit 1."""

    EXACT = "exact"
    TIME = "time"
    ALL = "all"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diff")(diff)


def diff(
    before: Annotated[
        str, typer.Argument(metavar="A", help="A folder of `rg render`, a record in it, or a bench file (or FILE@B).")
    ],
    after: Annotated[
        str | None, typer.Argument(metavar="B", help="The same; left out, A is a bench file of two sides.")
    ] = None,
    gate: Annotated[
        Gate | None,
        typer.Option("--gate", help="Which regressions exit 1. Default: exact where CI is set, else all."),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Compare although clock, renderer, driver, CPU, threads or size differ.")
    ] = False,
    floor: Annotated[
        float | None,
        typer.Option(
            "--floor",
            metavar="PERCENT",
            min=0,
            max=100,
            help="Smallest change of a time that counts. Default: 3 or, where one process was measured, 5.",
        ),
    ] = None,
    floor_us: Annotated[
        float, typer.Option("--floor-us", metavar="US", min=0, help="The same in microseconds; the larger floor holds.")
    ] = 10.0,
    alpha: Annotated[
        float, typer.Option("--alpha", min=1e-6, max=0.2, help="Chance of one false alarm among all passes.")
    ] = 0.01,
    image_rmse: Annotated[
        float | None,
        typer.Option("--image-rmse", min=0, max=1, help="RMSE from which images differ. Default: half an 8-bit step."),
    ] = None,
    format: Annotated[DiffFormat, typer.Option("--format", help="How to print.")] = DiffFormat.TEXT,
) -> None:
    """Compare two records: bytes, order and draws exactly, times by statistics, images by metric."""
    from rendergraph.cli.console import report
    from rendergraph.measure.statistics import Thresholds
    from rendergraph.report.diff import DiffOptions, diff_records, require_gate

    thresholds = Thresholds(alpha=alpha, absolute_ms=floor_us / 1000)
    if floor is not None:
        thresholds = Thresholds(alpha, floor / 100, floor / 100, floor_us / 1000)
    options = DiffOptions(thresholds, force=force)
    if image_rmse is not None:
        options = DiffOptions(thresholds, image_rmse, force)
    comparison = diff_records(before, after, options)
    chosen = (gate or _default_gate()).value
    require_gate(comparison, chosen)
    if format is not DiffFormat.GITHUB:
        report(comparison.warnings)
    _print(comparison, chosen, format)
    raise typer.Exit(1 if comparison.regressions(chosen) else 0)


def _default_gate() -> Gate:
    return Gate.EXACT if os.environ.get("CI", "").lower() not in ("", "0", "false") else Gate.ALL


def _print(comparison: Comparison, gate: str, format: DiffFormat) -> None:
    from rendergraph.cli.console import write_json, write_table, write_text

    if format is DiffFormat.JSON:
        from rendergraph.report.diff_record import diff_record

        write_json(diff_record(comparison, gate))
    elif format is DiffFormat.MARKDOWN:
        from rendergraph.report.diff_markdown import diff_markdown

        write_text(diff_markdown(comparison, gate))
    elif format is DiffFormat.GITHUB:
        from rendergraph.report.diff_github import append_summary, diff_annotations

        write_text(diff_annotations(comparison, gate))
        append_summary(comparison, gate)
    else:
        from rendergraph.report.diff_tables import diff_tables

        write_table(*diff_tables(comparison, gate))
