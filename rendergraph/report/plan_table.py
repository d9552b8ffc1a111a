"""The terminal table of a plan's order: what runs, what it touches, the barrier before it, and what was left out."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.plan.explain import explain_decision
from rendergraph.plan.graph import SubPass
from rendergraph.plan.plan import Plan


def order_table(plan: Plan) -> RenderableType:
    """One row a sub-pass, then the culled and specialised-away steps with their reasons."""
    table = Table(title="Order", title_justify="left", box=None, pad_edge=False)
    for heading in ("#", "sub-pass", "work", "reads", "writes", "barrier before"):
        table.add_column(heading, justify="right" if heading == "#" else "left")
    before = {barrier.index: barrier for barrier in plan.barriers}
    for index, subpass in enumerate(plan.order):
        barrier = before.get(index)
        kinds = sorted({h.kind for h in barrier.hazards}) if barrier else []
        table.add_row(
            str(index + 1), subpass.name, type(subpass.work).__name__,
            _touched(subpass, False), _touched(subpass, True),
            Text(", ".join(kinds), style="yellow"),
        )  # fmt: skip
    left_out = [explain_decision(d) for d in plan.decisions if d.kind in ("cull", "specialise")]
    return Group(table, Text("\n".join(left_out) if left_out else "nothing is left out", style="dim"))


def _touched(subpass: SubPass, writes: bool) -> str:
    return ", ".join(dict.fromkeys(a.resource for a in subpass.accesses if a.usage.writes == writes))
