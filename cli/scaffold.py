"""`rg new graph` and `rg new node`: a working start."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command group."""
    new = typer.Typer(help="Start a graph or a node from a working template.", no_args_is_help=True)
    new.command("graph")(new_graph)
    new.command("node")(new_node)
    app.add_typer(new, name="new")


def new_graph(
    path: Annotated[Path, typer.Argument(help="The file to make, as frame.yaml.")],
) -> None:
    """Write a small graph that renders."""
    from rendergraph.cli.console import write_text
    from rendergraph.document.templates import write_graph

    for written in write_graph(path):
        write_text(f"wrote {written}")
        write_text(f"now try: rg render {shlex.quote(str(written))}")


def new_node(
    name: Annotated[str, typer.Argument(help="The node's name, as my_blur.")],
    folder: Annotated[Path, typer.Option("--folder", help="Where to make the package.")] = Path(),
) -> None:
    """Write a Python package with one working node, its shader, test and entry point."""
    from rendergraph.cli.console import write_text
    from rendergraph.document.templates import write_node

    for written in write_node(name, folder):
        write_text(f"wrote {written}")
    write_text(f"now try: pip install -e {shlex.quote(str(folder / name))} && rg nodes {name}")
