"""The command line, `rg`: each command is a few lines over a public function of the library.

Only typer is imported here; a command imports what it needs when it runs, so that `rg --help` stays quick.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

import typer

from rendergraph.cli import (
    attribute,
    bench,
    catalogue,
    conform,
    diff,
    environment,
    fuzz,
    inspect,
    plan,
    render,
    scaffold,
    stress,
    sweep,
    validate,
)

if TYPE_CHECKING:
    from rendergraph.document.messages import RenderGraphError

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


for group in (
    render, bench, diff, validate, plan, inspect, catalogue,
    environment, scaffold, fuzz, stress, sweep, attribute, conform,
):  # fmt: skip
    group.register(app)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit: 0 fine, 1 findings, 2 usage or unreadable input, 3 environment, 130 Ctrl-C."""
    _settle_streams()
    try:
        app(args=None if arguments is None else list(arguments), prog_name="rg", standalone_mode=True)
    except SystemExit as ended:
        if ended.code == 130:
            typer.echo("interrupted", err=True)
        raise
    except KeyboardInterrupt:
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except Exception as error:
        from rendergraph.cli.console import report_errors

        failure = _failure(error)
        if failure is None:
            raise
        report_errors(failure)
        sys.exit(failure.exit_code)
    sys.exit(0)


def _settle_streams() -> None:
    """Make names that are not UTF-8 printable, and keep files from being opened in place of a stream that is closed."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _failure(error: Exception) -> RenderGraphError | None:
    """What the user is told; ``None`` for a defect of the tool, whose traceback is worth seeing."""
    from rendergraph.cli.console import discard_stdout
    from rendergraph.document.messages import RenderGraphError, diagnose
    from rendergraph.document.whole_files import reason_of

    if isinstance(error, RenderGraphError):
        return error
    if isinstance(error, MemoryError):
        return RenderGraphError([diagnose("RG526", detail=str(error) or "the system gives no more")])
    if isinstance(error, OSError) and error.filename is None:  # a stream: failed files come with their names
        discard_stdout()
        return RenderGraphError([diagnose("RG573", reason=reason_of(error))], exit_code=2)
    return None
