"""`rg stress`: a graph or node at the numerical extremes."""

from __future__ import annotations

from typing import Annotated

import typer

from rendergraph.cli.options import Format, FormatOption, SetOption, SizeOption, parse_size


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("stress")(stress)


def stress(
    target: Annotated[
        str, typer.Argument(metavar="GRAPH|NODE", help="A graph file, a shipped graph, or a node (on its own graph).")
    ],
    only: Annotated[
        list[str] | None, typer.Option("--only", metavar="NAME", help="Try this extreme alone (repeatable).")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the extremes, and try none.")] = False,
    overrides: SetOption = None,
    size: SizeOption = None,
    isolate: Annotated[
        bool,
        typer.Option(
            "--isolate/--no-isolate", help="In a process of its own, so that a driver's crash costs one extreme."
        ),
    ] = True,
    timeout: Annotated[
        float, typer.Option("--timeout", min=1, max=86400, help="Seconds that one extreme may take, when isolated.")
    ] = 300.0,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Run a graph or node at numerical extremes and check every pass; exit 1 where one fails, with its first texel."""
    from rendergraph.cli.console import progress_bar, report, write_json, write_table
    from rendergraph.measure.stress import stress as at_extremes
    from rendergraph.report.stress import stress_findings, stress_record
    from rendergraph.report.stress_table import stress_table

    names, set_ = tuple(only or ()), tuple(overrides or ())
    if list_:
        _list(target, names, set_, format)
        return
    options = at_extremes.StressOptions(names, set_, parse_size(size), device, isolate, timeout)
    with progress_bar() as progress:
        found = at_extremes.stress(target, options, progress)
    findings = tuple(stress_findings(found))
    report(findings)
    if format is Format.JSON:
        write_json(stress_record(found))
    else:
        write_table(stress_table(found))
    raise typer.Exit(int(bool(findings)))


def _list(target: str, only: tuple[str, ...], overrides: tuple[str, ...], format: Format) -> None:
    from rendergraph.cli.console import write_json, write_text
    from rendergraph.measure.stress.cases import cases_of
    from rendergraph.measure.stress.target import find_target, load_target

    found = find_target(target)
    cases = cases_of(found, load_target(found, overrides), only)
    if format is Format.JSON:
        write_json([{"name": c.name, "help": c.extreme.help, "common": c.common} for c in cases])
    else:
        width = max(len(case.name) for case in cases)
        write_text("\n".join(f"{case.name:{width}}  {case.extreme.help}" for case in cases))
