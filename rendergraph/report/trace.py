"""``trace.json``: the timed frames as Chrome trace events, for Perfetto (ui.perfetto.dev) and chrome://tracing.

The format is Google's "Trace Event Format": complete events (``X``) nest by time on their thread, counters (``C``)
belong to a process. Host and device stand on one clock.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import whole_file
from rendergraph.plan.graph import BufferDesc, Kind, Resource
from rendergraph.plan.lifetimes import live_bytes
from rendergraph.plan.plan import Plan
from rendergraph.run.result import FrameResult, StepTimes

_FRAME, _RESOURCES = 1, 2  # processes
# Threads of the frame, and the first of the resources: none numbered as its process, which makes a main thread of it
# that Perfetto marks and moves to the front.
_DEVICE, _HOST, _FIRST_RESOURCE = 11, 12, 101

#: Start and end of something, in nanoseconds since the trace began.
Span = tuple[int, int]


def trace_record(result: FrameResult, title: str = "") -> dict[str, Any]:
    """The trace as JSON-ready data: a frame a timed sample, times in microseconds since the first.

    :raises RenderGraphError: RG575 when the run timed no frame.
    """
    require_samples(len(result.times.frames))
    steps = {step.name: step for step in result.times.steps}
    steps_in_order = [steps[subpass.name] for subpass in result.plan.order]
    samples = len(result.times.frames)
    origin = min(min(step.starts[0], step.submit_starts[0]) for step in steps_in_order)
    events = list(_names(result.plan, title))
    for sample in range(samples):
        device = [_span(step.starts, step.device_ns, sample, origin) for step in steps_in_order]
        host = [_span(step.submit_starts, step.submit_ns, sample, origin) for step in steps_in_order]
        events += _track(result.plan, sample, _DEVICE, device, steps_in_order)
        events += _track(result.plan, sample, _HOST, host, steps_in_order)
        events += _lives(result.plan, device)
        events += _counter(result.plan, device)
    return {
        "traceEvents": events,
        "displayTimeUnit": "ms",
        "otherData": {
            "title": title,
            "clock": result.device.clock,
            "renderer": result.device.renderer,
            "driver": result.device.version,
            "size": f"{result.plan.graph.frame.width}x{result.plan.graph.frame.height}",
        },
    }


def require_samples(samples: int) -> None:
    """Raise RenderGraphError RG575 for a trace of no timed frame."""
    if samples < 1:
        raise RenderGraphError([diagnose("RG575")], exit_code=2)


def write_trace(path: Path, result: FrameResult, title: str = "") -> None:
    """Write :func:`trace_record` as compact JSON, whole or not at all."""
    record = trace_record(result, title)
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(record, separators=(",", ":"), ensure_ascii=False), encoding="utf-8")


def _span(starts: Sequence[int], durations: Sequence[int], sample: int, origin: int) -> Span:
    start = starts[sample] - origin
    return start, start + durations[sample]


def _complete(name: str, process: int, thread: int, span: Span, **arguments: Any) -> dict[str, Any]:
    start, end = span
    return {
        "ph": "X", "name": name, "pid": process, "tid": thread,
        "ts": start / 1e3, "dur": (end - start) / 1e3, "args": arguments,
    }  # fmt: skip


def _names(plan: Plan, title: str) -> Iterator[dict[str, Any]]:
    """Names of processes and threads, in the order to show them."""
    processes = {_FRAME: title or "frame", _RESOURCES: "resources"}
    threads = {(_FRAME, _DEVICE): "passes (device)", (_FRAME, _HOST): "submission (CPU)"}
    threads |= {(_RESOURCES, number): name for name, number in _threads(plan).items()}
    for process, name in processes.items():
        yield {"ph": "M", "name": "process_name", "pid": process, "args": {"name": name}}
        yield {"ph": "M", "name": "process_sort_index", "pid": process, "args": {"sort_index": process}}
    for (process, thread), name in threads.items():
        yield {"ph": "M", "name": "thread_name", "pid": process, "tid": thread, "args": {"name": name}}
        yield {"ph": "M", "name": "thread_sort_index", "pid": process, "tid": thread, "args": {"sort_index": thread}}


def _threads(plan: Plan) -> dict[str, int]:
    """A thread a resource, by first use."""
    by_use = sorted(plan.lifetimes, key=lambda name: (plan.lifetimes[name].first, plan.lifetimes[name].last, name))
    return {name: number for number, name in enumerate(by_use, _FIRST_RESOURCE)}


def _track(
    plan: Plan, sample: int, thread: int, spans: Sequence[Span], steps: Sequence[StepTimes]
) -> Iterator[dict[str, Any]]:
    """A frame, the passes in it and their sub-passes; a pass whose sub-passes others interrupt comes in pieces."""
    yield _complete(f"frame {sample}", _FRAME, thread, _hull(spans))
    positions = range(len(plan.order))
    for parent, run in groupby(positions, key=lambda index: plan.order[index].parent):
        inside = list(run)
        found = plan.graph.passes[parent]
        yield _complete(parent, _FRAME, thread, _hull(spans[i] for i in inside), node=found.node)
        for index in inside:
            step = steps[index]
            yield _complete(
                plan.order[index].name, _FRAME, thread, spans[index],
                work=type(plan.order[index].work).__name__, submit_us=step.submit_ns[sample] / 1e3,
                process_cpu_us=step.process_ns[sample] / 1e3,
            )  # fmt: skip


def _hull(spans: Iterable[Span]) -> Span:
    starts, ends = zip(*spans, strict=True)
    return min(starts), max(ends)


def _lives(plan: Plan, spans: Sequence[Span]) -> Iterator[dict[str, Any]]:
    """From first to last use; the whole frame for what outlives it."""
    frame = _hull(spans)
    for name, thread in _threads(plan).items():
        resource, life = plan.graph.resources[name], plan.lifetimes[name]
        transient = resource.kind is Kind.TRANSIENT
        span = (spans[life.first][0], spans[life.last][1]) if transient else frame
        yield _complete(name, _RESOURCES, thread, span, **_facts(plan, resource))


def _facts(plan: Plan, resource: Resource) -> dict[str, Any]:
    desc = resource.desc
    facts: dict[str, Any] = {"kind": resource.kind.value, "bytes": desc.bytes}
    if isinstance(desc, BufferDesc):
        return facts
    facts |= {"format": desc.format, "size": f"{desc.width}x{desc.height}", "layers": desc.layers}
    if resource.name in plan.slot_of:
        facts["slot"] = plan.slot_of[resource.name]
    return facts


def _counter(plan: Plan, spans: Sequence[Span]) -> Iterator[dict[str, Any]]:
    """Bytes of live transient resources, from each sub-pass's start on; none between frames. Viewers call the track by
    the counter's name and its argument's: "live transient bytes".
    """
    live = live_bytes(plan.graph, plan.lifetimes, len(plan.order))
    moments = [(start, count) for (start, _), count in zip(spans, live, strict=True)]
    for moment, count in [*moments, (_hull(spans)[1], 0)]:
        yield {
            "ph": "C", "name": "live transient", "pid": _FRAME, "ts": moment / 1e3, "args": {"bytes": count},
        }  # fmt: skip
