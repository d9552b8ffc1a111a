"""Writes a sweep's record, page and plot into its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rendergraph.report.html import write_page
from rendergraph.report.write import write_json


def write_sweep(folder: Path, record: dict[str, Any], *, html: bool = False, png: bool = False) -> tuple[Path, ...]:
    """``sweep.json``, with ``html`` ``sweep.html`` and with ``png`` ``sweep.png``; each whole or absent."""
    files = [folder / "sweep.json"]
    write_json(files[0], record)
    if html:
        from rendergraph.report.sweep_page import sweep_page

        files.append(folder / "sweep.html")
        write_page(files[-1], sweep_page(record))
    if png:
        from rendergraph.report.sweep_png import write_sweep_png

        files.append(folder / "sweep.png")
        write_sweep_png(files[-1], record)
    return tuple(files)
