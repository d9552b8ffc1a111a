"""One side of a bench inside a worker process: a prepared graph that is warmed up and timed block by block."""

from __future__ import annotations

import time
from dataclasses import asdict
from typing import Any

from rendergraph.device.clock import Clock
from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.measure.bench_job import BenchJob, Side
from rendergraph.measure.steady import steady_from
from rendergraph.plan.plan import PlanOptions
from rendergraph.report.counters import add_counters, add_statistics, statistics_source
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import device_record, milliseconds
from rendergraph.run.plan_document import PlannedDocument, plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.result import DeviceFacts, SteadyState, StepCounters
from rendergraph.run.runner import Runner


class BenchSide:
    """A graph on the device. Frames after the document's own last one repeat its last camera."""

    def __init__(self, device: Device, clock: Clock, side: Side, job: BenchJob) -> None:
        self.device, self.side = device, side
        self._clock = clock
        self.document = load_document(side.graph, side.overrides)
        self.planned = plan_sized(self, job, None)
        self.runner = prepare(device, self.planned)
        self.next = self.planned.plan.graph.frame.count
        start = time.perf_counter_ns()
        self.runner.run_frame(0)
        device.finish()
        self._first_ns = time.perf_counter_ns() - start
        self.counters = self.runner.count_frame(1)
        self._inside: dict[str, list[StepCounters]] = {}
        for subpass, counters in zip(self.planned.plan.order, self.counters, strict=True):
            self._inside.setdefault(subpass.parent, []).append(counters)
        self._made = SteadyState(0, 0, 0)
        self._timed = 0

    def warm_up(self, most: int) -> dict[str, Any]:
        """Run whole frames until they are steady, at most ``most``: their times, and the first steady one (or null)."""
        trace: list[float] = []
        found = None
        while found is None and len(trace) < most:
            start = time.perf_counter_ns()
            self.runner.run_frame(self._frame())
            self.device.finish()
            trace.append(milliseconds(time.perf_counter_ns() - start))
            found = steady_from(trace)
        return {"frames": len(trace), "steady_from": found, "frame_ms": trace}

    def block(self, frames: int) -> dict[str, Any]:
        """One untimed frame, since another side may just have run, then ``frames`` whole and as many pass by pass."""
        self.runner.run_frame(self._frame())
        first = self.next
        self.next += 2 * frames
        before = self.device.counters.snapshot()
        whole, handed, steps = self.runner.time_frames(first, frames, self._clock, lambda stage, done, total: None)
        made = self.device.counters - before
        self._made = SteadyState(
            self._made.objects_created + made.objects_created,
            self._made.programs_compiled + made.programs_compiled,
            self._made.bytes_uploaded + made.bytes_uploaded,
        )
        self._timed += 2 * frames
        timed = {step.name: [milliseconds(ns) for ns in step.device_ns] for step in steps}
        passes = {
            name: [round(sum(values), 6) for values in zip(*(timed[step.name] for step in inside), strict=True)]
            for name, inside in self._inside.items()
        }
        return {
            "frame_ms": [milliseconds(ns) for ns in whole],
            "frame_submit_ms": [milliseconds(ns) for ns in handed],
            "passes": passes,
            "subpasses": timed,
        }

    def steady_state(self) -> dict[str, int]:
        """What a timed frame made, compiled and uploaded, rounded up."""
        return {name: -(-count // max(1, self._timed)) for name, count in asdict(self._made).items()}

    def _frame(self) -> int:
        self.next += 1
        return self.next - 1

    def facts(self) -> dict[str, Any]:
        """What is exact or the same in every process, and what was done once."""
        plan, info, clock = self.planned.plan, self.device.info, self._clock
        facts = DeviceFacts(info.renderer, info.vendor, info.driver, clock.name, asdict(clock.proof))
        return {
            "graph": self.side.graph,
            "set": list(self.side.overrides),
            "full": self.side.full,
            "title": self.document.model.title,
            "clock": {"name": facts.clock, "proof": facts.proof},
            "device": device_record(facts),
            "size": [plan.graph.frame.width, plan.graph.frame.height],
            "statistics": statistics_source(self.counters, info.renderer),
            "passes": [
                {
                    "name": name,
                    "node": plan.graph.passes[name].node,
                    "counters": add_counters(steps),
                    "statistics": add_statistics(steps),
                    "subpasses": [{"name": step.name, "counters": add_counters([step])} for step in steps],
                }
                for name, steps in self._inside.items()
            ],
            "resources": resources_record(plan, self.document.model.title),
            "once_ms": {
                "plan": milliseconds(self.planned.plan_ns),
                "scene": milliseconds(self.planned.scene_ns),
                "compile": milliseconds(self.runner.compile_ns),
                "upload": milliseconds(self.runner.upload_ns),
                "first_frame": milliseconds(self._first_ns),
            },
        }


def plan_sized(side: BenchSide, job: BenchJob, size: tuple[int, int] | None) -> PlannedDocument:
    """The side's plan, at another size where one is given."""
    full = job.full or side.side.full
    return plan_document(side.document, PlanOptions(), scene=job.scene, size=size or job.size, full=full)


def prepare(device: Device, planned: PlannedDocument) -> Runner:
    """A runner with everything compiled and uploaded."""
    runner = Runner(device, planned.plan, planned.scene.scene if planned.scene else None, frame_cameras(planned))
    runner.prepare()
    return runner
