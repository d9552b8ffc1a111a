"""`rg graph` and `explain`: what becomes of a graph, and why, without a GPU."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from rendergraph.cli.options import Format, FormatOption, FullOption, GraphArgument, SceneOption, SetOption


class Drawing(StrEnum):
    """How a graph is drawn."""

    MERMAID = "mermaid"
    DOT = "dot"
    SVG = "svg"


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command("graph")(graph)
    app.command("explain")(explain)


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
