"""`rg validate`, `plan`, `graph`, `explain`: everything that can be said of a graph without a GPU."""

from __future__ import annotations

from enum import StrEnum
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


class Drawing(StrEnum):
    """How a graph is drawn."""

    MERMAID = "mermaid"
    DOT = "dot"
    SVG = "svg"


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command("validate")(validate)
    app.command("plan")(plan)
    app.command("graph")(graph)
    app.command("explain")(explain)


def validate(
    graphs: Annotated[list[str], typer.Argument(metavar="GRAPH...", help="Graph files, or shipped graphs' names.")],
    overrides: SetOption = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Check graphs without a GPU; exit 1 when one has errors."""
    from rendergraph.cli.console import report, write_json, write_text
    from rendergraph.document.messages import Diagnostic
    from rendergraph.document.render_text import diagnostic_json
    from rendergraph.plan.validate import validate_graph

    code = 0
    findings: list[Diagnostic] = []
    for name in graphs:
        diagnostics, failed = validate_graph(name, overrides or ())
        findings += diagnostics
        code = max(code, failed)
        if format is Format.TEXT:
            report(diagnostics)
            if not any(d.severity == "error" for d in diagnostics):
                write_text(f"{name}: valid")
    if format is Format.JSON:
        write_json([diagnostic_json(d) for d in findings])
    raise typer.Exit(code)


def plan(
    graph: GraphArgument,
    overrides: SetOption = None,
    scene: SceneOption = None,
    size: SizeOption = None,
    frames: FramesOption = None,
    no_alias: NoAliasOption = False,
    no_cull: NoCullOption = False,
    full: FullOption = False,
    order: OrderOption = Order.DEFAULT,
    order_seed: SeedOption = 0,
    format: FormatOption = Format.TEXT,
) -> None:
    """Show what a run would do: order, barriers, lifetimes, memory, and what is left out."""
    from rendergraph.cli.console import report, write_json, write_table
    from rendergraph.document.load import load_document
    from rendergraph.plan.plan import PlanOptions
    from rendergraph.report.plan_table import order_table
    from rendergraph.report.resources import resources_record
    from rendergraph.report.tables import lifetime_table
    from rendergraph.run.plan_document import plan_document

    document = load_document(graph, overrides or ())
    options = PlanOptions(alias=not no_alias, cull=not no_cull, order=order.value, seed=order_seed)
    planned = plan_document(document, options, scene=scene, size=parse_size(size), frames=frames, full=full)
    report(planned.warnings)
    record = resources_record(planned.plan, document.model.title)
    if format is Format.JSON:
        write_json(record)
    else:
        write_table(order_table(planned.plan), lifetime_table(record))


def graph(
    graph: GraphArgument,
    overrides: SetOption = None,
    drawing: Annotated[Drawing, typer.Option("--format", help="How to draw.")] = Drawing.MERMAID,
    subpasses: Annotated[bool, typer.Option("--subpasses", help="Draw sub-passes instead of passes.")] = False,
) -> None:
    """Draw a graph: passes and resources, as Mermaid or DOT text or as an SVG picture.

    The scene is not loaded: passes are drawn as for a scene with every feature, and none is culled.
    """
    from rendergraph.cli.console import write_text
    from rendergraph.document.load import load_document
    from rendergraph.plan.plan import PlanOptions
    from rendergraph.plan.validate import plan_without_scene
    from rendergraph.report.drawing import draw_graph

    planned, _ = plan_without_scene(load_document(graph, overrides or ()), PlanOptions(cull=False))
    write_text(draw_graph(planned, drawing.value, subpasses=subpasses))


def explain(
    subject: Annotated[str, typer.Argument(help="A code (RG203), or a graph to explain the decisions of.")],
    name: Annotated[
        str | None, typer.Argument(help="A pass, sub-pass or resource of the graph; all when left out.")
    ] = None,
    overrides: SetOption = None,
    scene: SceneOption = None,
    full: FullOption = False,
    format: FormatOption = Format.TEXT,
) -> None:
    """Explain a diagnostic code, or why a graph's passes are culled, ordered, shared and fenced as they are."""
    import re

    from rendergraph.cli.console import write_json, write_text
    from rendergraph.plan.explain import explain_code, explain_subject

    if re.fullmatch(r"[Rr][Gg]\d+", subject):
        write_text(explain_code(subject.upper()))
        return
    from rendergraph.document.load import load_document
    from rendergraph.plan.plan import PlanOptions
    from rendergraph.run.plan_document import plan_document

    planned = plan_document(load_document(subject, overrides or ()), PlanOptions(), scene=scene, full=full)
    sentences = explain_subject(planned.plan, name)
    if format is Format.JSON:
        write_json(sentences)
    else:
        write_text("\n".join(sentences))
