"""`rg conform`: nodes held against what every node must show."""

from __future__ import annotations

from typing import Annotated

import typer

from rendergraph.cli.options import Format, FormatOption


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("conform")(conform)


def conform(
    nodes: Annotated[
        list[str] | None, typer.Argument(metavar="[NODE]...", help="Nodes, or their packages' modules; all by default.")
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option("--only", metavar="DEMAND", help="Make this demand alone (repeatable).")
    ] = None,
    isolate: Annotated[
        bool,
        typer.Option("--isolate/--no-isolate", help="Try extremes in a process of their own, against driver crashes."),
    ] = True,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Demand of nodes what makes one done: graph, page, reference, knobs, extremes; exit 1 where one is missed."""
    from rendergraph.cli.console import progress_bar, report, write_json, write_table
    from rendergraph.conformance import conform as suite
    from rendergraph.report.conformance import conformance_record, conformance_table

    with progress_bar() as progress:
        found = suite.conform(tuple(nodes or ()), tuple(only or ()), device=device, isolate=isolate, progress=progress)
    findings = suite.findings(found)
    report(findings)
    if format is Format.JSON:
        write_json(conformance_record(found))
    else:
        write_table(conformance_table(found))
    raise typer.Exit(int(bool(found.missed)))
