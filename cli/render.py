"""`rg render`: run a graph and write its images and records."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rendergraph.cli.options import (
    Format,
    FormatOption,
    FramesOption,
    FullOption,
    GraphArgument,
    NoAliasOption,
    NoCullOption,
    Order,
    OrderOption,
    SceneOption,
    SeedOption,
    SetOption,
    SizeOption,
    parse_size,
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("render")(render)


def render(
    graph: GraphArgument,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for images and records.")
    ] = Path("out"),
    overrides: SetOption = None,
    scene: SceneOption = None,
    size: SizeOption = None,
    frames: FramesOption = None,
    samples: Annotated[
        int, typer.Option("--samples", min=0, max=1000, help="Extra frames timed after the last one.")
    ] = 5,
    capture: Annotated[
        list[str] | None,
        typer.Option(
            "--capture",
            metavar="RESOURCE",
            help="Save this target too: .png, and its exact values as .exr or .npy (repeatable).",
        ),
    ] = None,
    html: Annotated[bool, typer.Option("--html", help="Write report.html too: graph, times, memory, targets.")] = False,
    bound: Annotated[
        bool, typer.Option("--bound", help="Then run it perturbed, and record what the frame is bound by.")
    ] = False,
    trace: Annotated[bool, typer.Option("--trace", help="Write trace.json too, for Perfetto.")] = False,
    poison: Annotated[bool, typer.Option("--poison", help="Fill every target with NaN before its first use.")] = False,
    no_alias: NoAliasOption = False,
    no_cull: NoCullOption = False,
    full: FullOption = False,
    check_finite: Annotated[
        bool, typer.Option("--check-finite", help="Stop at the first NaN or Inf a pass writes into a float texture.")
    ] = False,
    order: OrderOption = Order.DEFAULT,
    order_seed: SeedOption = 0,
    device: Annotated[
        int | None, typer.Option("--device", min=0, help="EGL device index; `rg doctor` lists them.")
    ] = None,
    reference: Annotated[
        bool,
        typer.Option("--reference", help="Hold each pass of the last frame against its reference: accuracy.json."),
    ] = False,
    reference_pass: Annotated[
        list[str] | None,
        typer.Option("--reference-pass", metavar="PASS", help="Only this pass; implies --reference (repeatable)."),
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Run a graph; write its images and records, and print the records as tables.

    Exit 1 above the budget or, with --reference, where a pass is further off than its node states.
    """
    from rendergraph.cli.console import progress_bar, report, write_json, write_table, write_text
    from rendergraph.cli.references import Judging
    from rendergraph.document.load import load_document
    from rendergraph.document.whole_files import require_folder
    from rendergraph.measure.budget import check_run
    from rendergraph.measure.perturb import perturb_document
    from rendergraph.plan.plan import PlanOptions
    from rendergraph.report.accuracy_findings import accuracy_findings
    from rendergraph.report.accuracy_table import accuracy_table
    from rendergraph.report.html import ErrorGallery, TargetGallery
    from rendergraph.report.tables import lifetime_table, timing_table
    from rendergraph.report.trace import require_samples
    from rendergraph.report.write import write_result
    from rendergraph.run.image_files import write_image
    from rendergraph.run.render import RenderOptions, render_document

    document = load_document(graph, overrides or ())
    require_folder(output)
    if trace:
        require_samples(samples)
    page = TargetGallery() if html else None
    errors = ErrorGallery() if html else None
    judging = Judging(document, reference_pass or (), errors) if reference or reference_pass else None
    options = RenderOptions(
        size=parse_size(size),
        frames=frames,
        samples=samples,
        scene=scene,
        captures=tuple(capture or ()),
        inspect=page.add if page else None,
        take_frame=lambda file, pixels: write_image(output / file, pixels),
        afterwards=judging.judge if judging else None,
        poison=poison,
        full=full,
        check_finite=check_finite,
        device=device,
        plan=PlanOptions(alias=not no_alias, cull=not no_cull, order=order.value, seed=order_seed),
    )
    with progress_bar() as progress:
        if judging:
            judging.progress = progress
        result = render_document(document, options, progress)
        judged = judging.passes if judging else None
        evidence = perturb_document(document, options, progress) if bound else None
        written = write_result(
            result,
            document,
            output,
            page=page,
            trace=trace,
            full=full,
            judged=judged,
            errors=errors,
            bound=evidence,
        )
    report([*result.warnings, *(judging.notes if judging else ())])
    if format is Format.JSON:
        records = {"timing": written.timing, "resources": written.resources}
        records |= {"accuracy": written.accuracy} if written.accuracy else {}
        write_json({**records, "files": [str(f) for f in written.files]})
    else:
        tables = [accuracy_table(written.accuracy)] if written.accuracy else []
        write_table(timing_table(written.timing), lifetime_table(written.resources), *tables)
        for file in written.files:
            write_text(f"wrote {file}")
    over = check_run(document, written.timing, written.resources, judged=judging is not None)
    over += accuracy_findings(document, judging.passes) if judging else []
    report(over)
    raise typer.Exit(int(any(finding.severity == "error" for finding in over)))
