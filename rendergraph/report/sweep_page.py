"""The page of a sweep: the plot, the error along each axis, and every setting; one file that asks for no other."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Any

from rendergraph.report.accuracy_table import shown
from rendergraph.report.sweep_plot import scale, setting_label, sweep_plot
from rendergraph.report.tables import mebibytes

_SMALL = (300.0, 170.0)
_SHAPES = {
    "falls": "The error falls along it.",
    "flat": "The error does not fall: it stays as it is.",
    "rises": "The error does not fall: it rises.",
    "bumpy": "The error falls, but not all along.",
    "unknown": "The error is not known at every value.",
}


def sweep_page(record: dict[str, Any]) -> str:
    """The page's text, of a sweep record."""
    order = sorted(range(len(record["points"])), key=lambda at: _front_first(record["points"][at]))
    rows = [{**record["points"][at], "index": at} for at in order]
    if not any(point["own"] for point in record["points"]):
        rows.append({**record["control"], "index": -1})
    text: str = (
        _environment()
        .get_template("sweep_page.html.jinja")
        .render(
            record=record,
            plot=sweep_plot(record),
            small=[_small(axis) for axis in record["axes"] if any(isinstance(e, int | float) for e in axis["errors"])],
            rows=rows,
            css=files("rendergraph.report.html").joinpath("page.css").read_text(encoding="utf-8"),
            label=setting_label,
            mebibytes=mebibytes,
            shown=shown,
            chosen=record["recommended"]["point"] if record["recommended"] else None,
        )
    )
    return text


def _front_first(point: dict[str, Any]) -> tuple[bool, float]:
    return not point["front"], point["ms"]["estimate"] if point["ms"] else float("inf")


def _small(axis: dict[str, Any]) -> dict[str, Any]:
    """A small plot of the error along one axis: values evenly spaced, cheap to accurate."""
    width, height = _SMALL
    known = [float(error) for error in axis["errors"] if isinstance(error, int | float)]
    up = scale([0.0, *known], height - 30.0, 12.0)
    gap = (width - 76.0) / max(1, len(axis["values"]) - 1)
    last = len(axis["values"]) - 1
    # Where names would run into each other, only the ends are named.
    named = max(len(value) for value in axis["values"]) * 7.0 < gap
    marks = [
        {
            "x": round(56.0 + gap * at, 2),
            "y": up.at(float(error)),
            "value": value,
            "error": shown(error),
            "named": named or at in (0, last),
            "anchor": "start" if at == 0 else "end" if at == last else "middle",
        }
        for at, (value, error) in enumerate(zip(axis["values"], axis["errors"], strict=True))
        if isinstance(error, int | float)
    ]
    return {**axis, "width": width, "height": height, "up": up, "marks": marks, "says": _SHAPES[axis["shape"]]}


@cache
def _environment() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("rendergraph.report.html", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
