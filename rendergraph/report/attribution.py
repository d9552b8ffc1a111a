"""``attribution.json`` and its table; ``docs/attribution.schema.json`` is its JSON Schema."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

import rendergraph
from rendergraph.device.context import Device
from rendergraph.measure.attribute import Attribution, Contribution
from rendergraph.report.accuracy import number
from rendergraph.report.accuracy_table import shown
from rendergraph.report.tables import mebibytes
from rendergraph.report.timing import driver_version
from rendergraph.run.plan_document import PlannedDocument

SCHEMA = "rendergraph.attribution/1"


def attribution_record(
    found: Attribution,
    planned: PlannedDocument,
    device: Device,
    graph: str,
    *,
    title: str = "",
    overrides: Sequence[str] = (),
) -> dict[str, Any]:
    """The record as JSON-ready data; times in milliseconds."""
    frame, info = planned.plan.graph.frame, device.info
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": title,
        "size": [frame.width, frame.height],
        "graph": graph,
        "set": list(overrides),
        "device": {"renderer": info.renderer, "version": info.driver, "driver": driver_version(info.driver)},
        "output": found.output,
        "quantity": found.quantity.value,
        "metric": found.metric,
        "frame": found.frame,
        "error": number(found.error),
        "frame_ms": round(found.frame_ms, 6),
        "passes": [_contribution(entry) for entry in found.passes],
        "others": [{"name": name, "reason": reason} for name, reason in found.accurate.items()],
    }


def _contribution(entry: Contribution) -> dict[str, Any]:
    return {
        "name": entry.name,
        "node": entry.node,
        "how": entry.replacement.how,
        "by": list(entry.replacement.by),
        "removed": number(entry.removed),
        "left": number(entry.left),
        "share": entry.share,
        "ms": round(entry.ms, 6),
        "ms_share": entry.ms_share,
        "bytes": entry.bytes,
        "error_per_ms": number(entry.error_per_ms),
    }


def attribution_table(record: dict[str, Any]) -> RenderableType:
    """One row a pass, first where a millisecond buys most."""
    title = f"Error of '{record['output']}' ({record['metric']} of {record['quantity']}) by pass"
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for heading, justify in (
        ("pass", "left"),
        ("error removed alone", "right"),
        ("error left if it alone stays", "right"),
        ("share", "right"),
        ("ms", "right"),
        ("of frame", "right"),
        ("bytes", "right"),
        ("error per ms", "right"),
        ("replaced by", "left"),
    ):
        table.add_column(heading, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    for entry in record["passes"]:
        what = ", ".join(entry["by"])
        table.add_row(
            entry["name"],
            shown(entry["removed"]),
            shown(entry["left"]),
            f"{100 * entry['share']:.1f} %",
            f"{entry['ms']:.3f}",
            f"{100 * entry['ms_share']:.1f} %",
            mebibytes(entry["bytes"]),
            shown(entry["error_per_ms"]),
            f"its truth ({what})" if entry["how"] == "truth" else what,
        )
    lines = [f"error as it is: {shown(record['error'])} · frame {record['frame']}, {record['frame_ms']:.3f} ms"]
    lines += [f"{other['name']}: {other['reason']}" for other in record["others"]]
    return Group(table, Text("\n".join(lines), style="dim"))
