"""`rg bench`: measure a graph, or two side by side, and keep every sample."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rendergraph.cli.options import Format, FormatOption, FullOption, SceneOption, SetOption, SizeOption, parse_size


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("bench")(bench)


def bench(
    graphs: Annotated[
        list[str], typer.Argument(metavar="GRAPH [GRAPH]", help="One graph, or two to compare: files or shipped names.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="The record, JSON.")] = Path(
        "bench.json"
    ),
    overrides: SetOption = None,
    a: Annotated[
        list[str] | None, typer.Option("--a", metavar="PATH=VALUE", help="Override on side A alone (repeatable).")
    ] = None,
    b: Annotated[
        list[str] | None, typer.Option("--b", metavar="PATH=VALUE", help="Override on side B alone (repeatable).")
    ] = None,
    processes: Annotated[int, typer.Option("--processes", min=1, max=100, help="Fresh processes, one by one.")] = 10,
    blocks: Annotated[int, typer.Option("--blocks", min=1, max=1000, help="Blocks of every side a process.")] = 3,
    frames: Annotated[int, typer.Option("--frames", min=1, max=1000, help="Timed frames a block.")] = 5,
    warm_up: Annotated[
        int, typer.Option("--warm-up", min=0, max=10000, help="Most frames run before a side must be steady.")
    ] = 60,
    bound: Annotated[
        bool, typer.Option("--bound", help="Also run the graph perturbed, and tell what its frame is bound by.")
    ] = False,
    scene: SceneOption = None,
    size: SizeOption = None,
    full: FullOption = False,
    vs_full: Annotated[
        bool, typer.Option("--vs-full", help="Measure the graph against itself under --full: what the scene saves it.")
    ] = False,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Measure a graph, or two in turn, in fresh processes after a warm-up to steady state; compare with `rg diff`."""
    from rendergraph.cli.console import progress_bar, report, write_json, write_table, write_text
    from rendergraph.document.load import load_document
    from rendergraph.document.whole_files import require_file
    from rendergraph.measure.bench import Bench, bench_sides
    from rendergraph.measure.bench_errors import check_errors
    from rendergraph.measure.bench_job import BenchJob
    from rendergraph.measure.budget import check_bench
    from rendergraph.measure.vs_full import vs_full as vs_full_of
    from rendergraph.measure.vs_full import vs_full_record, vs_full_sides
    from rendergraph.report.bench_table import bench_tables
    from rendergraph.report.vs_full_table import vs_full_tables
    from rendergraph.report.write import write_json as write_record

    if vs_full:
        _refuse_more(len(graphs), full=full, sides=bool(a or b))
        sides = vs_full_sides(graphs[0], tuple(overrides or ()))
    else:
        sides = bench_sides(graphs, tuple(overrides or ()), tuple(a or ()), tuple(b or ()))
    require_file(output)
    job = BenchJob(sides, processes, blocks, frames, parse_size(size), scene, full, device, warm_up, bound)
    run = Bench(job)
    try:
        with progress_bar() as progress:
            run.run(progress)
    finally:  # also after Ctrl-C, and when a later process fails: what is complete is kept
        if run.blocks:
            write_record(output, run.record())
    report(run.findings())
    record = run.record()
    if vs_full:
        found = vs_full_of(output)
        if format is Format.JSON:
            write_json(vs_full_record(found))
        else:
            write_table(*vs_full_tables(found))
            write_text(f"wrote {output}")
    elif format is Format.JSON:
        write_json(record)
    else:
        write_table(*bench_tables(record))
        write_text(f"wrote {output}")
    over = [
        finding
        for name, side in sides.items()
        for finding in [*check_bench(load_document(side.graph, side.overrides), record, name), *check_errors(job, side)]
    ]
    report(over)
    raise typer.Exit(int(any(finding.severity == "error" for finding in over)))


def _refuse_more(graphs: int, *, full: bool, sides: bool) -> None:
    """Raise RenderGraphError RG581 for what --vs-full leaves no room for: the sides are one graph's."""
    from rendergraph.document.messages import RenderGraphError, diagnose

    problem = f"{graphs} graphs are named" if graphs > 1 else "--full is given too" if full else "--a or --b is given"
    if graphs > 1 or full or sides:
        hint = "--vs-full takes one graph: its sides are the graph in full and for what its scene requires"
        raise RenderGraphError([diagnose("RG581", problem=problem, hint=hint)], exit_code=2)
