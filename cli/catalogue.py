"""`rg nodes` and `rg schema`: what graphs are made of."""

from __future__ import annotations

from typing import Annotated

import typer

from rendergraph.cli.options import Format, FormatOption


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command("nodes")(nodes)
    app.command("schema")(schema)


def nodes(
    name: Annotated[str | None, typer.Argument(help="Show one node in full.")] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """List the nodes, or show one with its ports and parameters."""
    from rendergraph.cli.console import report, write_json, write_table
    from rendergraph.node.catalogue import describe_node, describe_nodes
    from rendergraph.report.node_tables import node_page, node_table

    described, broken = ([describe_node(name)], []) if name else describe_nodes()
    report(broken)
    if format is Format.JSON:
        write_json(described)
    else:
        write_table(node_page(described[0]) if name else node_table(described))


def schema() -> None:
    """Print the JSON Schema of the graph language, node parameters included."""
    from rendergraph.cli.console import write_json
    from rendergraph.document.schema import json_schema

    write_json(json_schema())
