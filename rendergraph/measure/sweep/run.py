"""A sweep: which settings are measured, in which chunks and processes, and what of it is known by now."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.axes import parse_axes
from rendergraph.measure.sweep.bench import Overrides, Settings, Workbench
from rendergraph.measure.sweep.chunk import Step, measure_chunk
from rendergraph.measure.sweep.error_choice import ErrorChoice, choose_error
from rendergraph.measure.sweep.header import sweep_header
from rendergraph.measure.sweep.job import SweepJob
from rendergraph.measure.sweep.own_setting import held_at, own_indices
from rendergraph.measure.sweep.points import Point, all_points, hypercube
from rendergraph.measure.sweep.process import device_facts, run_workers
from rendergraph.measure.sweep.store import CONTROL, ChunkResult, Store, Stored, locked
from rendergraph.plan.plan import Plan

Progress = Callable[[str, int, int], None]
Chunk = tuple[int, tuple[tuple[int, Overrides], ...]]

#: Settings held on the device at once beside the document's own, and the bytes that all together may take.
HELD: Final = 7
HELD_BYTES: Final = 2 << 30
_TICKS: Final = 100  # of the progress bar, a setting


class Sweep:
    """Settings to measure and, after :meth:`run` (also an interrupted one), ``stored``: what was measured."""

    def __init__(self, job: SweepJob, *, over: Sequence[str], samples: int | None = None, error: str = "") -> None:
        """Read the graph under ``job``, whose axes and error are chosen here.

        :raises RenderGraphError: for the document's mistakes, RG750 to RG753 of the axes, RG758 and RG759 of the error.
        """
        settings = Settings(job)
        document = settings.document(())
        axes = parse_axes(document, over)
        self.plan: Plan = settings.planned(()).plan
        self.job = replace(job, axes=axes, error=choose_error(document, self.plan, axes, error))
        self.settings = replace(settings, job=self.job)
        self.points = all_points(axes) if samples is None else hypercube(axes, samples, job.seed)
        self.own = own_indices(self.settings, axes)
        self.held = held_at(self.settings, axes, self.own)
        self.title = document.model.title
        self.stored = Stored()

    @property
    def complete(self) -> bool:
        """Whether every setting is measured."""
        return bool(self.stored.chunks) and not self._missing()

    def result_of(self, point: Point) -> int:
        """The index that a setting is measured under: that of the control where it is the document's own."""
        return CONTROL if point.choice == self.own else point.index

    def run(
        self,
        folder: Path,
        *,
        jobs: int = 1,
        devices: Sequence[int] = (),
        fresh: bool = False,
        progress: Progress = lambda stage, done, total: None,
    ) -> None:
        """Measure what the folder does not hold yet, ``jobs`` processes at a time on these ``devices`` in turn (none:
        the default one).

        :raises RenderGraphError: RG754, RG755 (see :mod:`rendergraph.measure.sweep.store`), RG761, and those of runs.
        """
        with locked(folder):
            header = sweep_header(self.job, self.settings.document(()), self.plan, self.points)
            store = Store(folder, header, fresh=fresh)
            self.stored = store.stored
            missing = self._missing()
            total = len(self.points) * _TICKS
            done = float(total - len(missing) * _TICKS)

            def step(share: float) -> None:
                nonlocal done
                done = min(done + share * _TICKS, total)
                progress("measuring", int(done), total)

            progress("measuring", int(done), total)
            chunks = list(self._chunks(missing, store.next_number(), jobs))
            for facts, chunk in self._measured(chunks, jobs, devices, step):
                store.take_device(facts)
                store.add(chunk)

    def _measured(
        self, chunks: list[Chunk], jobs: int, devices: Sequence[int], step: Step
    ) -> Iterator[tuple[dict[str, Any], ChunkResult]]:
        if not chunks:
            return
        if jobs > 1:
            yield from run_workers(self.job, chunks, jobs, devices, step)
            return
        from rendergraph.device.context import open_device

        device = open_device(devices[0] if devices else None)
        with closing(Workbench(self.settings, device)) as bench:
            for number, points in chunks:
                yield device_facts(device), measure_chunk(bench, points, number, step)

    def _missing(self) -> list[Point]:
        known = {point.index for chunk in self.stored.chunks.values() for point in chunk.points}
        missing = [point for point in self.points if self.result_of(point) not in {*known, CONTROL}]
        if not missing and not self.stored.chunks:
            return [point for point in self.points if self.result_of(point) == CONTROL]
        return missing

    def _chunks(self, points: Sequence[Point], first: int, jobs: int) -> Iterator[Chunk]:
        """As even as possible, no larger than may be held."""
        if not points:
            return
        wanted = max(-(-len(points) // self._most()), min(jobs, len(points)))
        for number in range(wanted):
            part = points[number * len(points) // wanted : (number + 1) * len(points) // wanted]
            own = [p for p in part if self.result_of(p) == CONTROL]
            yield first + number, tuple((p.index, p.overrides(self.job.axes)) for p in part if p not in own)

    def _most(self) -> int:
        """How many settings fit: by the memory of the largest of the extremes, as far as they can be planned."""
        largest = self.plan.totals.unshared
        for axis in self.job.axes:
            for value in (axis.values[0], axis.values[-1]):
                try:
                    planned = self.settings.planned((f"{axis.path}={value}",))
                except RenderGraphError:
                    continue
                largest = max(largest, planned.plan.totals.unshared)
        return max(1, min(HELD, HELD_BYTES // max(largest, 1) - 1))


def new_job(graph: str, **options: Any) -> SweepJob:
    """A job without axes yet: see :class:`Sweep`."""
    return SweepJob(graph, (), ErrorChoice("image", "", "", "asked"), **options)
