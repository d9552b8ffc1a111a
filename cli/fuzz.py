"""`rg fuzz`: vary what must not matter, and compare the images."""

from __future__ import annotations

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
    app.command("fuzz")(fuzz)


def fuzz(
    graph: GraphArgument,
    overrides: SetOption = None,
    orders: Annotated[
        int, typer.Option("--orders", min=0, max=1000, help="Random legal orders beside the usual one.")
    ] = 4,
    seed: Annotated[int, typer.Option("--seed", min=0, max=2**32 - 1, help="Seed of the orders.")] = 0,
    scene: SceneOption = None,
    size: SizeOption = None,
    frames: Annotated[
        int | None, typer.Option("--frames", min=1, max=10000, help="Frames a run; the file's, at most 3, by default.")
    ] = None,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Run a graph in random orders, poisoned, unshared and unspecialised; exit 1 where the image differs, and why."""
    from rendergraph.cli.console import progress_bar, report, write_json, write_text
    from rendergraph.document.load import load_document
    from rendergraph.measure.fuzz import FuzzOptions, fuzz_document
    from rendergraph.measure.fuzz_report import fuzz_findings, fuzz_record

    document = load_document(graph, overrides or ())
    options = FuzzOptions(orders, seed, parse_size(size), frames, scene, device)
    with progress_bar() as progress:
        found = fuzz_document(document, options, progress)
    findings = fuzz_findings(found, document)
    report(findings)
    if format is Format.JSON:
        write_json(fuzz_record(found, document.model.title, options))
    else:
        what = "all give one image" if found.failure is None else f"{found.failed} differ"
        size_ = f"{found.size[0]}x{found.size[1]}"
        write_text(f"{found.runs} variations in {found.orders} orders, {found.frames} frames of {size_}: {what}")
    raise typer.Exit(int(bool(findings)))
