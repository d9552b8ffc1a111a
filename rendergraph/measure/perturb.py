"""Perturbed runs of a graph: what a frame takes once one kind of its work is taken away.

Frames are handed over back to back and waited for once a round, so that host and device overlap as they do in use: a
wait in the middle of a frame then shows, and a wait at its end, which only tells that the device is the slower one,
does not.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, Final

from rendergraph.device import enums
from rendergraph.device.context import Device
from rendergraph.measure.bench_job import BenchJob
from rendergraph.measure.bench_side import BenchSide, plan_sized, prepare
from rendergraph.measure.bound import classify
from rendergraph.measure.bound_evidence import RoundTimes
from rendergraph.measure.perturb_rounds import FRAMES, ROUNDS
from rendergraph.plan.graph import CopyBuffer, CopyTexture, SubPass
from rendergraph.plan.plan import Plan
from rendergraph.run.commands import Command
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.runner import Runner

_WORK: Final = (
    "glDrawArrays", "glDrawArraysInstanced", "glDrawArraysInstancedBaseInstance", "glMultiDrawArraysIndirect",
    "glDispatchCompute", "glDispatchComputeIndirect",
)  # fmt: skip


class Variant:
    """One way to run the frame: a runner, whether drawing is scissored away, and whether work is skipped."""

    def __init__(self, side: BenchSide, runner: Runner, *, scissor: bool = False, skip: bool = False) -> None:
        self._device, self._runner = side.device, runner
        self._scissor, self._skip = scissor, skip
        self._next = side.next
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


def perturbed_runs(side: BenchSide, job: BenchJob, step: Callable[[], None]) -> dict[str, Any]:
    """Rounds of every variant in turn, and what they say the side is bound by."""
    width, height = side.planned.plan.graph.frame.width, side.planned.plan.graph.frame.height
    half = plan_sized(side, job, (max(1, width // 2), max(1, height // 2)))
    made = [prepare(side.device, half)]
    variants = {
        "base": Variant(side, side.runner),
        "half_resolution": Variant(side, made[0]),
        "nothing_rasterised": Variant(side, side.runner, scissor=True),
        "no_draws": Variant(side, side.runner, skip=True),
    }
    if any(reads_back(subpass) for subpass in side.planned.plan.order):
        made.append(prepare(side.device, replace(side.planned, plan=without_readback(side.planned.plan))))
        variants["no_readback"] = Variant(side, made[1])
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
    return classify(rounds, side.counters)


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
