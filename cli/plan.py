"""`rg plan`: what a run would do, and whether that is still what was committed."""

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
    app.command("plan")(plan)


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
    lock: Annotated[
        Path | None, typer.Option("--lock", metavar="FILE", help="Write order, barriers and bytes to this file.")
    ] = None,
    check: Annotated[
        Path | None, typer.Option("--check", metavar="FILE", help="Exit 1 if the plan is not as this file says.")
    ] = None,
    format: FormatOption = Format.TEXT,
) -> None:
    """Show what a run would do: order, barriers, lifetimes, memory, and what is left out; exit 1 above the budget."""
    from rendergraph.cli.console import report, write_json, write_table, write_text
    from rendergraph.document.load import load_document
    from rendergraph.measure.budget import check_memory
    from rendergraph.plan.plan import PlanOptions
    from rendergraph.report.lock_changes import change_diagnostics, lock_changes
    from rendergraph.report.memory_advice import advise
    from rendergraph.report.plan_lock import plan_lock, read_lock, write_lock
    from rendergraph.report.plan_table import order_table
    from rendergraph.report.resources import resources_record
    from rendergraph.report.tables import lifetime_table
    from rendergraph.run.plan_document import plan_document

    if lock is not None and check is not None:
        raise typer.BadParameter("it writes what --check would read: give one of them", param_hint="--lock")
    locked = None if check is None else read_lock(check)
    document = load_document(graph, overrides or ())
    options = PlanOptions(alias=not no_alias, cull=not no_cull, order=order.value, seed=order_seed)
    planned = plan_document(document, options, scene=scene, size=parse_size(size), frames=frames, full=full)
    report(planned.warnings)
    record = resources_record(planned.plan, document.model.title, advice=advise(document, planned.plan, full=full))
    findings = check_memory(document, record)
    if locked is not None:
        changes = lock_changes(locked, plan_lock(record))
        findings += change_diagnostics(changes, document, str(check))
        if format is Format.JSON:
            write_json([{"code": c.code, "subject": c.subject, **c.values} for c in changes])
        elif not changes:
            write_text(f"{check}: the plan is as locked")
    elif lock is not None:
        write_lock(lock, plan_lock(record))
        write_text(f"wrote {lock}")
    elif format is Format.JSON:
        write_json(record)
    else:
        write_table(order_table(planned.plan), lifetime_table(record))
    report(sorted(findings, key=lambda finding: finding.severity != "error"))
    raise typer.Exit(int(any(finding.severity == "error" for finding in findings)))
