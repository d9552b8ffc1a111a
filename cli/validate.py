"""`rg validate`: check graphs without a GPU, for people and for CI systems."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from rendergraph.cli.options import SetOption


class ReportFormat(StrEnum):
    """How findings are printed."""

    TEXT = "text"
    JSON = "json"
    GITHUB = "github"
    SARIF = "sarif"
    JUNIT = "junit"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("validate")(validate)


def validate(
    graphs: Annotated[list[str], typer.Argument(metavar="GRAPH...", help="Graph files, or shipped graphs' names.")],
    overrides: SetOption = None,
    format: Annotated[
        ReportFormat, typer.Option("--format", help="How to print: for people, as data, or for a CI system.")
    ] = ReportFormat.TEXT,
) -> None:
    """Check graphs without a GPU; exit 1 when one has errors."""
    from rendergraph.cli.console import report, write_json, write_text
    from rendergraph.report.checked_graphs import check_graphs, finding_json, ranked

    checked = check_graphs(graphs, overrides or ())
    match format:
        case ReportFormat.TEXT:
            for graph in checked:
                report(graph.diagnostics)
                if graph.exit_code == 0:
                    write_text(f"{graph.name}: valid")
        case ReportFormat.JSON:
            write_json([finding_json(finding) for finding in ranked(checked)])
        case ReportFormat.GITHUB:
            from rendergraph.report.github import append_step_summary, github_lines

            write_text("\n".join(github_lines(checked)))
            append_step_summary(checked)
        case ReportFormat.SARIF:
            from rendergraph.report.sarif import sarif_log

            write_json(sarif_log(checked))
        case ReportFormat.JUNIT:
            from rendergraph.report.junit import junit_xml

            write_text(junit_xml(checked))
    raise typer.Exit(max(graph.exit_code for graph in checked))
