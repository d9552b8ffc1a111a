"""Where the commands write: data to stdout, everything about the work to stderr."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.console import RenderableType

    from rendergraph.document.messages import Diagnostic, RenderGraphError
    from rendergraph.run.render import Progress


def write_text(text: str) -> None:
    """Text and a newline on stdout. A reader that left (`rg plan g.yaml | head`) is no error: the rest is dropped."""
    try:
        typer.echo(text)
    except BrokenPipeError:
        discard_stdout()


def discard_stdout() -> None:
    """Send what is still buffered, and all that follows, nowhere: Python would fail on it again when it exits."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)


def write_json(data: Any) -> None:
    """Data on stdout as indented JSON."""
    write_text(json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False))


def write_table(*tables: RenderableType) -> None:
    """Tables on stdout; plain text, and as wide as needed, when it is not a terminal."""
    from rich.console import Console

    terminal = sys.stdout is not None and sys.stdout.isatty()
    console = Console() if terminal else Console(width=200, no_color=True, highlight=False)
    with console.capture() as captured:
        for table in tables:
            console.print(table)
            console.print()
    write_text(captured.get().removesuffix("\n"))


def report(diagnostics: Iterable[Diagnostic]) -> None:
    """Diagnostics on stderr, each with its source frame."""
    from rendergraph.document.render_text import format_diagnostics

    text = format_diagnostics(tuple(diagnostics))
    if text:
        typer.echo(text, err=True)


def report_errors(error: RenderGraphError) -> None:
    """A failed command's diagnostics on stderr, with a count."""
    report(error.diagnostics)
    count = sum(d.severity == "error" for d in error.diagnostics)
    if count > 1:
        typer.echo(f"{count} errors", err=True)


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """A callback ``(stage, done, total)`` that draws a bar on stderr when it is a terminal, else nothing."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda stage, done, total: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=None)
        yield lambda stage, done, total: bar.update(task, description=stage, completed=done, total=total)
