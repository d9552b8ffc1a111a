"""Writes a run's images and records into a folder."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.whole_files import whole_file
from rendergraph.measure.truth.accuracy import PassAccuracy
from rendergraph.report.accuracy import accuracy_record, write_variances
from rendergraph.report.html import ErrorGallery, TargetGallery, html_page, write_page
from rendergraph.report.html.accuracy import accuracy_entries
from rendergraph.report.memory_advice import advise
from rendergraph.report.resources import resources_record
from rendergraph.report.tables import lifetime_table, timing_table
from rendergraph.report.timing import timing_record
from rendergraph.report.trace import write_trace
from rendergraph.run.image_files import write_capture, write_image
from rendergraph.run.result import FrameResult


@dataclass(frozen=True, slots=True)
class WrittenResult:
    """The records as data, and every file written."""

    timing: dict[str, Any]
    resources: dict[str, Any]
    files: tuple[Path, ...]
    accuracy: dict[str, Any] | None = None

    def _repr_html_(self) -> str:
        from rendergraph.report.notebook import tables_html

        return tables_html(timing_table(self.timing), lifetime_table(self.resources))


def write_result(
    result: FrameResult,
    document: Document,
    folder: Path,
    *,
    page: TargetGallery | None = None,
    trace: bool = False,
    full: bool = False,
    judged: Sequence[PassAccuracy] | None = None,
    errors: ErrorGallery | None = None,
    bound: dict[str, Any] | None = None,
) -> WrittenResult:
    """Write outputs, captures, ``timing.json`` and ``resources.json``, with ``judged`` (passes held against their
    references) ``accuracy.json``, with ``page`` (the targets it shows; ``errors`` the error maps) ``report.html``, and
    with ``trace`` ``trace.json``. Each file is whole or absent. ``full``: the graph was not specialised on its scene.
    ``bound``: what perturbed runs found, for the timing record.
    """
    files = []
    for name, file in result.files.items():
        if name in result.images:
            write_image(folder / file, result.images[name])
        files.append(folder / file)
    for name, pixels in result.captures.items():
        files += write_capture(folder, result.plan.graph.resources[name], pixels)
    timing = timing_record(result, document.model.title, bound)
    watched = result.frames - 1 + result.times.warm_up
    resources = resources_record(
        result.plan,
        document.model.title,
        advice=advise(document, result.plan, full=full),
        created=(watched, result.steady.objects_created),
    )
    records = {"timing": timing, "resources": resources}
    accuracy = None
    if judged is not None:
        accuracy = records["accuracy"] = accuracy_record(judged, result.plan.graph.frame, timing, resources)
        files += write_variances(folder, judged)
    for stem, record in records.items():
        path = folder / f"{stem}.json"
        write_json(path, record)
        files.append(path)
    title = document.model.title or document.path.stem
    if page is not None:
        files.append(folder / "report.html")
        entries = accuracy_entries(accuracy, errors or ErrorGallery()) if accuracy is not None else None
        text = html_page(
            result.plan, title=title, timing=timing, targets=page, warnings=result.warnings, accuracy=entries
        )
        write_page(files[-1], text)
    if trace:
        files.append(folder / "trace.json")
        write_trace(files[-1], result, title)
    return WrittenResult(timing, resources, tuple(files), accuracy)


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write a record as indented JSON, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
