"""The command line, `rg`: each command is a few lines over a public function of the library.

Only typer is imported here; a command imports what it needs when it runs, so that `rg --help` stays quick.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import NoReturn

import typer

from rendergraph.cli import catalogue, environment, inspect, render, scaffold

app = typer.Typer(
    name="rg",
    help="Author render graphs in YAML, run them headless on OpenGL, and measure time, bytes and error per pass.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(show: bool) -> None:
    if show:
        import rendergraph

        typer.echo(f"rendergraph {rendergraph.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: bool = typer.Option(
        False, "--version", callback=_version, is_eager=True, help="Print the version and exit."
    ),
) -> None:
    """Options before the command."""


for group in (render, inspect, catalogue, environment, scaffold):
    group.register(app)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit: 0 fine, 1 findings, 2 usage or unreadable input, 3 environment, 130 Ctrl-C."""
    try:
        app(args=None if arguments is None else list(arguments), prog_name="rg", standalone_mode=True)
    except KeyboardInterrupt:
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except BrokenPipeError:  # the reader of stdout left: `rg plan g.yaml | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except Exception as error:
        from rendergraph.cli.console import report_errors
        from rendergraph.document.messages import RenderGraphError

        if not isinstance(error, RenderGraphError):
            raise
        report_errors(error)
        sys.exit(error.exit_code)
    sys.exit(0)
