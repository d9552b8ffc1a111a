"""Writes a run's images and records into a folder."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.whole_files import whole_file
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import timing_record
from rendergraph.run.image_files import write_capture, write_image
from rendergraph.run.result import FrameResult


@dataclass(frozen=True, slots=True)
class WrittenResult:
    """The records as data, and every file written."""

    timing: dict[str, Any]
    resources: dict[str, Any]
    files: tuple[Path, ...]


def write_result(result: FrameResult, document: Document, folder: Path) -> WrittenResult:
    """Write outputs, captures, ``timing.json`` and ``resources.json``. Each file is whole or absent."""
    files = []
    for name, pixels in result.images.items():
        path = folder / result.files[name]
        write_image(path, pixels)
        files.append(path)
    for name, pixels in result.captures.items():
        files += write_capture(folder, result.plan.graph.resources[name], pixels)
    timing = timing_record(result, document.model.title)
    resources = resources_record(result.plan, document.model.title)
    for stem, record in (("timing", timing), ("resources", resources)):
        path = folder / f"{stem}.json"
        write_json(path, record)
        files.append(path)
    return WrittenResult(timing, resources, tuple(files))


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write a record as indented JSON, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
