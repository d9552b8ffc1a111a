"""The terminal tables: pass times and target lifetimes, drawn from the records so that both say the same."""

from __future__ import annotations

from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.report.bound_text import bound_text

_BAR = 24
_CHART = 40


def mebibytes(count: float) -> str:
    """Bytes for people."""
    if count < 2**10:
        return f"{count:.0f} B"
    return f"{count / 2**20:.2f} MiB" if count >= 2**20 else f"{count / 2**10:.1f} KiB"


def timing_table(record: dict[str, Any]) -> RenderableType:
    """One row a pass: median, range, share of the sum."""
    device, frame, once = record["device"], record["frame_ms"], record["once_ms"]
    notes = [
        f"once: plan {once['plan']:.1f}, scene {once['scene']:.0f}, compile {once['compile']:.0f}, "
        f"upload {once['upload']:.0f}, first frame {once['first_frame']:.0f} ms",
        f"{device['renderer']}, {record['size'][0]}x{record['size'][1]}, {record['timed_frames']} timed frames",
    ]
    if record["bound"] is not None:
        notes.append(bound_text("the frame", record["bound"]))
    if frame["median"] is None:
        return Text("\n".join(notes), style="dim")
    medians = [p["ms"]["median"] or 0.0 for p in record["passes"]]
    total, longest = sum(medians) or 1.0, max(medians) or 1.0
    table = Table(title=f"Pass times · {record['clock']['name']}", title_justify="left", box=None, pad_edge=False)
    for heading, justify in (
        ("pass", "left"),
        ("node", "left"),
        ("median ms", "right"),
        ("range", "right"),
        ("", "left"),
    ):
        table.add_column(heading, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    for entry, value in zip(record["passes"], medians, strict=True):
        low, high = entry["ms"]["min"], entry["ms"]["max"]
        span = f"{low:.3f} .. {high:.3f}"
        bar = "█" * max(1, round(_BAR * value / longest))
        table.add_row(
            entry["name"], entry["node"], f"{value:.3f}", span, Text(f"{bar} {100 * value / total:.0f} %", "cyan")
        )
    lines = [f"sum of passes {total:.3f} ms, whole frame {frame['median']:.3f} ms", *notes]
    return Group(table, Text("\n".join(lines), style="dim"))


def lifetime_table(record: dict[str, Any]) -> RenderableType:
    """One row a resource: format, size, where it lives, and a bar over the sub-passes it is alive in."""
    count = max(1, len(record["order"]))
    table = Table(title="Target lifetimes", title_justify="left", box=None, pad_edge=False)
    for heading, justify in (
        ("resource", "left"),
        ("format", "left"),
        ("size", "right"),
        ("bytes", "right"),
        ("slot", "right"),
    ):
        table.add_column(heading, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    table.add_column(f"passes 1..{count}", no_wrap=True)
    for entry in sorted(record["resources"], key=lambda e: (e["first_index"], e["last_index"], e["name"])):
        table.add_row(
            entry["name"], *_shape(entry["desc"]), mebibytes(entry["bytes"]), _place(entry), _life(entry, count)
        )
    totals = record["totals"]
    ratio = f" = {totals['used_over_load']:.2f} x load" if totals["used_over_load"] else ""
    text = (
        f"transient memory: used {mebibytes(totals['used'])}{ratio}\n"
        f"unshared {mebibytes(totals['unshared'])} · exact-format pool {mebibytes(totals['exact_pool'])} · "
        f"view-class pool {mebibytes(totals['view_pool'])} · placed {mebibytes(totals['placed'])} · "
        f"load {mebibytes(totals['load'])}\n"
        f"at the peak: {', '.join(totals['peak']) or 'nothing'} · {len(record['barriers'])} barriers · "
        f"{len(record['culled'])} sub-passes culled"
    )
    if record["advice"]:
        text += f"\nto lower it: {record['advice'][0]['why']}"
    return Group(table, Text(text, style="dim"))


def _shape(desc: dict[str, Any]) -> tuple[str, str]:
    if "buffer" in desc:
        return "buffer", ""
    size = f"{desc['size'][0]}x{desc['size'][1]}"
    for key, prefix in (("layers", "x"), ("mips", " m"), ("samples", " s")):
        size += f"{prefix}{desc[key]}" if desc[key] > 1 else ""
    return desc["format"], size


def _place(entry: dict[str, Any]) -> str:
    if "slot" in entry:
        return f"{entry['slot']}" + ("*" if entry["shares_with"] else "")
    if "offset" in entry:
        return f"+{entry['offset']}"
    return str(entry["kind"])


def _life(entry: dict[str, Any], count: int) -> Text:
    width = min(_CHART, count)
    first = entry["first_index"] * width // count
    last = max(first + 1, -(-(entry["last_index"] + 1) * width // count))
    return Text("·" * first + "━" * (last - first) + "·" * (width - last), style="green")
