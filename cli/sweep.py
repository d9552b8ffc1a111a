"""`rg sweep`: what each setting of some knobs costs in time and bytes, and what error it leaves."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rendergraph.cli.options import (
    Format,
    FormatOption,
    GraphArgument,
    SceneOption,
    SetOption,
    SizeOption,
    parse_size,
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("sweep")(sweep)


def sweep(
    graph: GraphArgument,
    over: Annotated[
        list[str],
        typer.Option("--over", metavar="AXIS,...", help="PASS.KNOB, PASS.KNOB=low:high:count[:log], PATH=a|b|c."),
    ],
    overrides: SetOption = None,
    budget_ms: Annotated[
        float | None, typer.Option("--budget-ms", min=0, help="Recommend the most accurate setting within this time.")
    ] = None,
    max_error: Annotated[
        float | None, typer.Option("--max-error", min=0, help="Recommend the fastest setting within this error.")
    ] = None,
    error: Annotated[
        str, typer.Option("--error", metavar="PASS[.MEASURE]|image[:METRIC]", help="By what settings are judged.")
    ] = "",
    samples: Annotated[
        int | None, typer.Option("--samples", min=1, help="Measure so many, a Latin hypercube, instead of all.")
    ] = None,
    frames: Annotated[int, typer.Option("--frames", min=1, max=1000, help="Timed frames a round.")] = 2,
    rounds: Annotated[int, typer.Option("--rounds", min=1, max=1000, help="Rounds of all settings held.")] = 8,
    scene: SceneOption = None,
    size: SizeOption = None,
    seed: Annotated[int, typer.Option("--seed", min=0, max=2**32 - 1, help="Of the order and the hypercube.")] = 0,
    jobs: Annotated[int, typer.Option("--jobs", min=1, max=64, help="Processes at a time.")] = 1,
    device: Annotated[
        list[int] | None,
        typer.Option("--device", min=0, help="EGL device index; repeat it to spread the jobs. `rg doctor` lists them."),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Where it is kept, and goes on.")
    ] = Path("sweep"),
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin anew: forget what the folder holds.")] = False,
    html: Annotated[bool, typer.Option("--html", help="Also write sweep.html, one self-contained page.")] = False,
    png: Annotated[bool, typer.Option("--png", help="Also write sweep.png, the plot.")] = False,
    format: FormatOption = Format.TEXT,
) -> None:
    """Measure time, bytes and error over the settings of some knobs; mark the Pareto front, recommend a setting.

    An interrupted sweep goes on when the same command is given again.
    """
    from rendergraph.cli.console import progress_bar, report, write_json, write_table, write_text
    from rendergraph.measure.sweep.outcome import Limits, sweep_outcome
    from rendergraph.measure.sweep.run import Sweep, new_job
    from rendergraph.report.sweep import sweep_record
    from rendergraph.report.sweep_files import write_sweep
    from rendergraph.report.sweep_table import sweep_tables

    if budget_ms is not None and max_error is not None:
        raise typer.BadParameter("give one of --budget-ms and --max-error", param_hint="--budget-ms")
    job = new_job(
        graph,
        overrides=tuple(overrides or ()),
        frames=frames,
        rounds=rounds,
        size=parse_size(size),
        scene=scene,
        seed=seed,
    )
    found = Sweep(job, over=over, samples=samples, error=error)
    limits = Limits(budget_ms, max_error)
    try:
        with progress_bar() as progress:
            found.run(output, jobs=jobs, devices=device or (), fresh=fresh, progress=progress)
    finally:  # also after Ctrl-C: what is complete is shown in the record
        files = write_sweep(output, sweep_record(found, sweep_outcome(found, limits)), html=html, png=png) if (
            found.stored.chunks
        ) else ()  # fmt: skip
    outcome = sweep_outcome(found, limits)
    report(outcome.findings)
    record = sweep_record(found, outcome)
    if format is Format.JSON:
        write_json(record)
    else:
        write_table(*sweep_tables(record))
        write_text("\n".join(f"wrote {file}" for file in files))
    raise typer.Exit(int(any(finding.severity == "error" for finding in outcome.findings)))
