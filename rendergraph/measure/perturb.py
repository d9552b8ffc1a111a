"""Perturbed runs of a graph: what a frame takes once one kind of its work is taken away.

Frames are handed over back to back and waited for once a round, so that host and device overlap as they do in use: a
wait in the middle of a frame then shows, and a wait at its end, which only tells that the device is the slower one,
does not.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, Final

from rendergraph.device import enums
from rendergraph.device.context import Device, open_device
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.bench_job import BenchJob
from rendergraph.measure.bench_side import BenchSide, plan_sized, prepare
from rendergraph.measure.bound import classify
from rendergraph.measure.bound_evidence import RoundTimes
from rendergraph.measure.perturb_rounds import FRAMES, ROUNDS
from rendergraph.plan.graph import CopyBuffer, CopyTexture, SubPass
from rendergraph.plan.plan import Plan
from rendergraph.run.commands import Command
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.plan_document import PlannedDocument, plan_document
from rendergraph.run.render import Progress, RenderOptions
from rendergraph.run.result import StepCounters
from rendergraph.run.runner import Runner

_WORK: Final = (
    "glDrawArrays", "glDrawArraysInstanced", "glDrawArraysInstancedBaseInstance", "glMultiDrawArraysIndirect",
    "glDispatchCompute", "glDispatchComputeIndirect",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Subject:
    """What is perturbed: a prepared graph past its first frames, of which ``first`` is the next one to run. ``half`` is
    its plan at half resolution, None where it has none.
    """

    device: Device
    planned: PlannedDocument
    half: PlannedDocument | None
    runner: Runner
    counters: Sequence[StepCounters]
    first: int


class Variant:
    """One way to run the frame: a runner, whether drawing is scissored away, and whether work is skipped."""

    def __init__(self, subject: Subject, runner: Runner, *, scissor: bool = False, skip: bool = False) -> None:
        self._device, self._runner = subject.device, runner
        self._scissor, self._skip = scissor, skip
        self._next = subject.first
        self._skipped: dict[int, Command] = {}

    def round(self, frames: int) -> RoundTimes:
        """``frames`` frames back to back, and one wait: times a frame."""
        device = self._device
        device.finish()
        readback_wall = readback_cpu = 0
        with _nothing_rasterised(device) if self._scissor else _unchanged():
            process, thread, start = time.process_time_ns(), time.thread_time_ns(), time.perf_counter_ns()
            for _ in range(frames):
                for command in self._runner.commands_of(self._next):
                    if reads_back(command.subpass):
                        wall, cpu = time.perf_counter_ns(), time.thread_time_ns()
                        command.run()
                        readback_wall += time.perf_counter_ns() - wall
                        readback_cpu += time.thread_time_ns() - cpu
                    else:
                        (self._without_work(command) if self._skip else command).run()
                self._next += 1
            submitted, submit_thread = time.perf_counter_ns(), time.thread_time_ns()
            device.finish()
            end = time.perf_counter_ns()
        device.check()
        return RoundTimes(
            frame_ms=(end - start) / frames / 1e6,
            submit_ms=(submitted - start) / frames / 1e6,
            submit_cpu_ms=(submit_thread - thread) / frames / 1e6,
            process_cpu_ms=(time.process_time_ns() - process) / frames / 1e6,
            readback_ms=readback_wall / frames / 1e6,
            readback_cpu_ms=readback_cpu / frames / 1e6,
        )

    def _without_work(self, command: Command) -> Command:
        """The same command less its draws and dispatches: state, bindings, clears and copies stay."""
        if id(command) not in self._skipped:
            gl = self._device.gl
            work = [gl.repeated(getattr(gl, name))[0] for name in _WORK]
            calls = tuple(
                call
                for call in command.calls
                if not any(call[0] is function for function in work)
                and getattr(call[0], "__func__", None) is not SceneGeometry.draw
            )
            self._skipped[id(command)] = replace(command, calls=calls)
        return self._skipped[id(command)]


def perturb_side(side: BenchSide, job: BenchJob, step: Callable[[], None]) -> dict[str, Any]:
    """What a side of a bench is bound by."""
    half = _at_half_resolution(side.planned, lambda size: plan_sized(side, job, size))
    return perturbed_runs(Subject(side.device, side.planned, half, side.runner, side.counters, side.next), step)


def perturb_document(
    document: Document, options: RenderOptions, progress: Progress = lambda stage, done, total: None
) -> dict[str, Any]:
    """What a document's frame is bound by, as `rg render --bound` records it. It is run anew, so that nothing of a
    render's own times or images is disturbed.

    :raises RenderGraphError: for every mistake of the document, its files or its shaders, and where no GL is.
    """

    def planned_at(size: tuple[int, int] | None) -> PlannedDocument:
        return plan_document(
            document, options.plan, scene=options.scene, size=size, frames=options.frames, full=options.full
        )

    done = 0

    def step() -> None:
        nonlocal done
        progress("perturbed runs", done, ROUNDS)
        done += 1

    planned = planned_at(options.size)
    device = open_device(options.device)
    runner = prepare(device, planned)
    try:
        runner.run_frame(0)
        counters = runner.count_frame(1)
        half = _at_half_resolution(planned, planned_at)
        step()
        return perturbed_runs(Subject(device, planned, half, runner, counters, planned.plan.graph.frame.count), step)
    finally:
        runner.release()
        device.debug.take_warnings()  # the render has told them; of perturbed work they would mislead


def _at_half_resolution(
    planned: PlannedDocument, planned_at: Callable[[tuple[int, int]], PlannedDocument]
) -> PlannedDocument | None:
    frame = planned.plan.graph.frame
    try:
        return planned_at((max(1, frame.width // 2), max(1, frame.height // 2)))
    except RenderGraphError:  # sizes that are fixed, and fit this frame alone
        return None


def perturbed_runs(subject: Subject, step: Callable[[], None]) -> dict[str, Any]:
    """Rounds of every variant in turn, and what they say the frame is bound by."""
    made: list[Runner] = []

    def another(planned: PlannedDocument) -> Runner:
        made.append(prepare(subject.device, planned))
        return made[-1]

    variants = {
        "base": Variant(subject, subject.runner),
        "nothing_rasterised": Variant(subject, subject.runner, scissor=True),
        "no_draws": Variant(subject, subject.runner, skip=True),
    }
    if subject.half is not None:
        variants["half_resolution"] = Variant(subject, another(subject.half))
    plan = subject.planned.plan
    if any(reads_back(subpass) for subpass in plan.order):
        on_device = another(replace(subject.planned, plan=without_readback(plan)))
        variants["no_readback"] = Variant(subject, on_device)
    rounds: dict[str, list[RoundTimes]] = {name: [] for name in variants}
    for variant in variants.values():
        variant.round(2)  # compiles what this variant alone needs
    for index in range(ROUNDS):
        names = list(variants) if index % 2 == 0 else list(reversed(variants))
        for name in names:
            rounds[name].append(variants[name].round(FRAMES))
        step()
    for runner in made:
        runner.release()
    return classify(rounds, subject.counters)


def reads_back(subpass: SubPass) -> bool:
    """Whether a sub-pass takes its data through the host."""
    return isinstance(subpass.work, (CopyTexture, CopyBuffer)) and subpass.work.host


def without_readback(plan: Plan) -> Plan:
    """The plan with copies through the host made on the device."""
    order = []
    for subpass in plan.order:
        work = subpass.work
        if isinstance(work, (CopyTexture, CopyBuffer)) and work.host:
            order.append(replace(subpass, work=replace(work, host=False)))
        else:
            order.append(subpass)
    return replace(plan, order=tuple(order))


@contextmanager
def _nothing_rasterised(device: Device) -> Iterator[None]:
    """An empty scissor: every call is made, every vertex shaded, no fragment."""
    device.gl.glEnable(enums.SCISSOR_TEST)
    device.gl.glScissor(0, 0, 0, 0)
    try:
        yield
    finally:
        device.gl.glDisable(enums.SCISSOR_TEST)


@contextmanager
def _unchanged() -> Iterator[None]:
    yield
