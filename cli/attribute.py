"""`rg attribute`: which pass the final image's error comes from, beside what each pass costs."""

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
    app.command("attribute")(attribute)


def attribute(
    graph: GraphArgument,
    overrides: SetOption = None,
    frame: Annotated[
        int | None, typer.Option("--frame", min=0, help="The frame judged; the graph's last by default.")
    ] = None,
    scene: SceneOption = None,
    size: SizeOption = None,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Also write DIR/attribution.json.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Replace each approximate pass by its truth, alone and all but it: where the image's error comes from."""
    from rendergraph.cli.console import progress_bar, write_json, write_table, write_text
    from rendergraph.device.context import open_device
    from rendergraph.document.whole_files import require_folder
    from rendergraph.measure.attribute import AttributeOptions
    from rendergraph.measure.attribute import attribute as attribute_error
    from rendergraph.report.attribution import attribution_record, attribution_table
    from rendergraph.report.write import write_json as write_record

    if output is not None:
        require_folder(output)
    options = AttributeOptions(tuple(overrides or ()), frame, parse_size(size), scene)
    opened = open_device(device)
    with progress_bar() as progress:
        found, document, planned = attribute_error(graph, opened, options, progress)
    record = attribution_record(found, planned, opened, graph, title=document.model.title, overrides=options.overrides)
    if output is not None:
        write_record(output / "attribution.json", record)
    if format is Format.JSON:
        write_json(record)
        return
    write_table(attribution_table(record))
    if output is not None:
        write_text(f"wrote {output / 'attribution.json'}")
