"""Reads records to compare: a folder of ``rg render``, one of its records, or a side of a bench file.

A bench file is JSON with ``schema: rendergraph.bench/1``::

    {
      "schema": "rendergraph.bench/1",
      "graphs": ["a.yaml", "b.yaml"],
      "sides": {                      # one side, "A", or two
        "A": {"clock": {"name": ..}, "device": {..}, "size": [w, h],
              "passes": [{"name": .., "node": .., "counters": {..}}, ..], "steady_state": {..},
              "resources": {..}},     # optional: the whole resources record
        "B": {..}
      },
      "blocks": [                     # in order of time, process after process
        {"process": 0, "order": "AB",
         "A": {"frame_ms": [..], "passes": {"light": [..], ..}},
         "B": {"frame_ms": [..], "passes": {..}}},
        ..
      ]
    }

A side is a timing record whose samples stand in the blocks. The samples of a block are consecutive frames after the
warm-up, milliseconds. Blocks of two sides are pairs: both were measured next to each other in one process.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import BaseModel

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.output_files import IMAGE_SUFFIXES
from rendergraph.measure.run_shift import Runs
from rendergraph.report.record_files import RENDER_HINT, read_record_file, unreadable
from rendergraph.report.record_models import AccuracyRecord, BenchRecord, BoundModel, ResourcesRecord, TimingRecord

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True, slots=True)
class PassTimes:
    """A pass: its node, exact counts, and its runs."""

    node: str
    counters: dict[str, int]
    runs: Runs


@dataclass(frozen=True, slots=True)
class Times:
    """Times of one side. ``setup`` is what must be equal to compare them: clock, renderer, driver, cpu, threads, size.

    ``passes`` are in execution order, and so are ``steps``, their sub-passes (``pass.step``); runs of all are
    parallel. ``bound`` is what the frame is bound by, where that was asked.
    """

    setup: dict[str, str]
    frame: Runs
    passes: dict[str, PassTimes]
    steady: dict[str, int]
    steps: dict[str, PassTimes] = field(default_factory=dict)
    bound: BoundModel | None = None


@dataclass(frozen=True, slots=True)
class Record:
    """One side of a comparison. ``images`` are paths by their name in the folder."""

    name: str
    times: Times | None = None
    resources: ResourcesRecord | None = None
    images: dict[str, Path] = field(default_factory=dict)
    accuracy: AccuracyRecord | None = None


def read_record(place: str) -> Record:
    """A record by its path; ``FILE@A`` and ``FILE@B`` are the sides of a bench file.

    :raises RenderGraphError: RG730 (nothing to read), RG731 (not JSON), RG732 (no record of ours), RG733 (newer),
        RG734 (not as its schema says), RG735 (a sample that is no time), RG737 (a side must be chosen).
    """
    path, wanted = _side_of(place)
    if path.is_dir():
        return _read_folder(path)
    kind, model = read_record_file(path)
    if isinstance(model, TimingRecord):
        return Record(place, _stored_times(model), model.resources)
    if isinstance(model, ResourcesRecord):
        return Record(place, resources=model)
    if isinstance(model, AccuracyRecord):
        return Record(place, accuracy=model)
    assert isinstance(model, BenchRecord), kind
    if wanted is None and len(model.sides) > 1:
        raise _cannot_compare(place, "it has two sides", f"give it alone, or a side of it: {place}@A or {place}@B")
    return _bench_side(place, model, wanted or "A")


def read_pair(place: str) -> tuple[Record, Record]:
    """The two sides of one bench file, block by block in pairs.

    :raises RenderGraphError: as :func:`read_record`; RG737 where the file has no second side.
    """
    path, wanted = _side_of(place)
    kind, model = (None, None) if path.is_dir() else read_record_file(path)
    if wanted is not None or not isinstance(model, BenchRecord) or len(model.sides) < 2:
        what = f"it is a {kind} record" if kind and kind != "bench" else "it has one side"
        raise _cannot_compare(place, f"{what} and nothing to compare with was given", "name a second record")
    return _bench_side(f"{place}@A", model, "A"), _bench_side(f"{place}@B", model, "B")


def _side_of(place: str) -> tuple[Path, str | None]:
    if place[-2:] in ("@A", "@B") and not Path(place).exists():
        return Path(place[:-2]), place[-1]
    return Path(place), None


def _cannot_compare(place: str, reason: str, hint: str) -> RenderGraphError:
    return RenderGraphError([diagnose("RG737", name=place, reason=reason, hint=hint)], exit_code=2)


# ---- folders


def _read_folder(folder: Path) -> Record:
    timing, resources = folder / "timing.json", folder / "resources.json"
    if not timing.exists() and not resources.exists():
        raise unreadable(folder, "the folder has neither timing.json nor resources.json", RENDER_HINT)
    times = kept = judged = None
    if timing.exists():
        times = _stored_times(_expect(timing, TimingRecord))
    if resources.exists():
        kept = _expect(resources, ResourcesRecord)
    if (folder / "accuracy.json").exists():
        judged = _expect(folder / "accuracy.json", AccuracyRecord)
    return Record(str(folder), times, kept, dict(_images(folder)), judged)


def _images(folder: Path) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in IMAGE_SUFFIXES and path.is_file():
            yield path.relative_to(folder).as_posix(), path


def _expect(path: Path, model: type[Model]) -> Model:
    kind, found = read_record_file(path)
    if not isinstance(found, model):
        raise RenderGraphError([diagnose("RG732", path=str(path), reason=f"it holds a {kind} record")], exit_code=2)
    return found


# ---- times


def _setup(record: TimingRecord) -> dict[str, str]:
    device = record.device
    return {
        "clock": record.clock.name,
        "renderer": device.renderer,
        "driver": device.driver or device.version,
        "cpu": device.cpu,
        "threads": "unknown" if device.threads is None else str(device.threads),
        "size": f"{record.size[0]}x{record.size[1]}",
    }


def _counters(values: dict[str, int | None]) -> dict[str, int]:
    return {name: value for name, value in values.items() if value is not None}


def _stored_times(record: TimingRecord) -> Times:
    """The times of a timing record: one run in one process."""
    passes = {
        entry.name: PassTimes(entry.node, _counters(entry.counters), _runs([(0, entry.ms.samples)]))
        for entry in record.passes
    }
    steps = {
        step.name: PassTimes(entry.node, _counters(step.counters), _runs([(0, step.ms.samples)]))
        for entry in record.passes
        for step in entry.subpasses
    }
    frame = _runs([(0, record.frame_ms.samples)])
    return Times(_setup(record), frame, passes, record.steady_state, steps, record.bound)


def _bench_side(place: str, bench: BenchRecord, name: str) -> Record:
    """One side: a run a block."""
    if name not in bench.sides:
        raise _cannot_compare(place, f"it has no side {name}", "measure two graphs, or name the side it has")
    side = bench.sides[name]
    blocks = [(block.process, block.B if name == "B" else block.A) for block in bench.blocks]
    kept = [(process, block) for process, block in blocks if block is not None]
    passes = {
        entry.name: PassTimes(
            entry.node,
            _counters(entry.counters),
            _runs([(process, block.passes.get(entry.name, [])) for process, block in kept]),
        )
        for entry in side.passes
    }
    steps = {
        step.name: PassTimes(
            entry.node,
            _counters(step.counters),
            _runs([(process, block.subpasses.get(step.name, [])) for process, block in kept]),
        )
        for entry in side.passes
        for step in entry.subpasses
    }
    frame = _runs([(process, block.frame_ms) for process, block in kept])
    times = Times(_setup(side), frame, passes, side.steady_state, steps, bench.bound.get(name))
    return Record(place, times, side.resources)


def _runs(runs: list[tuple[int, list[float]]]) -> Runs:
    samples = tuple(np.array(values, np.float64) for _, values in runs)
    return Runs(samples, tuple(process for process, _ in runs))
