"""`rg doctor`: is everything here that a run needs?"""

from __future__ import annotations

import typer

from rendergraph.cli.options import Format, FormatOption


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("doctor")(doctor)


def doctor(format: FormatOption = Format.TEXT) -> None:
    """Check Python, EGL, each device, extensions, the clock and the extras; exit 3 when a graph cannot run."""
    from dataclasses import asdict

    from rendergraph.cli.console import write_json, write_text
    from rendergraph.device.doctor import diagnose_environment

    checks = diagnose_environment()
    if format is Format.JSON:
        write_json([asdict(check) for check in checks])
    else:
        for check in checks:
            write_text(f"{'ok  ' if check.ok else 'FAIL'} {check.name}: {check.detail}")
            if check.fix and not check.ok:
                write_text(f"     help: {check.fix}")
    raise typer.Exit(0 if all(check.ok for check in checks) else 3)
