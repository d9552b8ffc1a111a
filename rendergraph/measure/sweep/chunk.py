"""A few settings held on the device at once, and their frames timed in turn with those of the document itself."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from random import Random

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.steady import steady_from
from rendergraph.measure.sweep.bench import Overrides, Workbench
from rendergraph.measure.sweep.errors import PointError, judged_frames, measure_error
from rendergraph.measure.sweep.store import CONTROL, ChunkResult, PointResult
from rendergraph.run.plan_document import PlannedDocument
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner

#: Called when a setting is ready, and after each round: by how much the work has advanced, in settings.
Step = Callable[[float], None]

#: Share of a setting's work that is done when it is warmed up and judged, for the progress bar.
_READY = 0.5


@dataclass
class Prepared:
    """A setting on the device, judged and steady. ``run_ms`` is the time of all frames run so far."""

    overrides: Overrides
    planned: PlannedDocument
    runner: Runner
    error: PointError
    frames: int
    steady: bool = False
    rounds: list[list[float]] = field(default_factory=list)
    run_ms: float = 0.0

    def frame(self, bench: Workbench) -> float:
        """Run the next frame and wait for it; its milliseconds."""
        bench.device.finish()
        start = time.perf_counter_ns()
        self.runner.run_frame(self.frames)
        bench.device.finish()
        self.frames += 1
        taken = (time.perf_counter_ns() - start) / 1e6
        self.run_ms += taken
        return taken

    def warm_up(self, bench: Workbench) -> None:
        """Run frames until they are steady, or as many as are allowed."""
        trace: list[float] = []
        while len(trace) < bench.job.most_warm_up and not self.steady:
            trace.append(self.frame(bench))
            self.steady = steady_from(trace) is not None


def measure_chunk(
    bench: Workbench, points: Sequence[tuple[int, Overrides]], number: int, step: Step = lambda share: None
) -> ChunkResult:
    """Measure these settings (number and overrides) beside the control. A setting that the graph refuses, or that does
    not run, is a result too.

    :raises RenderGraphError: where the document's own setting does not run.
    """
    refused: list[PointResult] = []
    plans: dict[int, PlannedDocument] = {CONTROL: bench.settings.planned(())}
    bench.store(())
    overrides = {CONTROL: (), **dict(points)}
    for index, chosen in points:
        try:
            plans[index] = bench.settings.planned(chosen)
            bench.store(chosen)
        except RenderGraphError as error:
            refused.append(PointResult(index, number, refused=reason_of(error)))
            step(1.0)
    with ExitStack() as held:
        prepared: dict[int, Prepared] = {}
        for index, planned in plans.items():
            try:
                prepared[index] = _prepare(bench, held, overrides[index], planned)
            except RenderGraphError as error:
                if index == CONTROL or error.exit_code == 3:
                    raise
                refused.append(PointResult(index, number, refused=reason_of(error)))
            if index != CONTROL:
                step(_READY if index in prepared else 1.0)
        random = Random(f"{bench.job.seed} {number}")
        order = list(prepared)
        for _ in range(bench.job.rounds):
            random.shuffle(order)  # nobody always runs behind the same neighbour
            for index in order:
                prepared[index].frame(bench)  # another ran before: caches fill again
                prepared[index].rounds.append([prepared[index].frame(bench) for _ in range(bench.job.frames)])
            step((1.0 - _READY) * (len(prepared) - 1) / bench.job.rounds)
        control = _result(CONTROL, number, prepared.pop(CONTROL))
        results = [_result(index, number, setting) for index, setting in prepared.items()]
    return ChunkResult(number, control, tuple(sorted([*results, *refused], key=lambda result: result.index)))


def _prepare(bench: Workbench, held: ExitStack, overrides: Overrides, planned: PlannedDocument) -> Prepared:
    scene = planned.scene.scene if planned.scene is not None else None
    cameras = frame_cameras(planned)
    # The camera stands still in the frames behind the file's last, but what is random goes on.
    cameras += [cameras[-1]] * (judged_frames(bench.settings.document(overrides)) - 1)
    runner = Runner(bench.device, planned.plan, scene, cameras, store=bench.store(overrides))
    # Last in, first out: a runner deletes what was made since it was.
    held.callback(runner.release)
    runner.prepare()
    start = time.perf_counter_ns()
    error, frames = measure_error(bench, runner, overrides, planned)
    found = Prepared(overrides, planned, runner, error, frames, run_ms=(time.perf_counter_ns() - start) / 1e6)
    found.warm_up(bench)
    return found


def _result(index: int, number: int, setting: Prepared) -> PointResult:
    return PointResult(
        index,
        number,
        bytes=setting.planned.plan.totals.used,
        error=setting.error,
        rounds=tuple(tuple(round(ms, 6) for ms in frames) for frames in setting.rounds),
        steady=setting.steady,
        run_ms=round(setting.run_ms, 3),
    )


def reason_of(error: RenderGraphError) -> str:
    """What an error says, in one line."""
    return "; ".join(f"{d.code} {d.text}" for d in error.diagnostics[:3])
