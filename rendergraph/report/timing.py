"""``timing.json``: the times of a run, with their clock, renderer and raw samples."""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import median
from typing import Any

import rendergraph
from rendergraph.plan.graph import SubPass
from rendergraph.plan.plan import Plan
from rendergraph.report.counters import (
    add_counters,
    add_statistics,
    driver_warnings,
    gigabytes_per_second,
    statistics_source,
)
from rendergraph.run.result import DeviceFacts, FrameResult, StepCounters, StepTimes

SCHEMA = "rendergraph.timing/1"


def milliseconds(nanoseconds: float) -> float:
    """Nanoseconds as milliseconds, to the microsecond."""
    return round(nanoseconds / 1e6, 6)


def spread(samples: Sequence[int]) -> dict[str, Any]:
    """Median, extremes and raw samples, in milliseconds; ``null`` figures when there are none."""
    values = [milliseconds(s) for s in samples]
    if not values:
        return {"median": None, "min": None, "max": None, "samples": []}
    return {"median": round(median(values), 6), "min": min(values), "max": max(values), "samples": values}


def timing_record(result: FrameResult, title: str = "", bound: dict[str, Any] | None = None) -> dict[str, Any]:
    """The record as JSON-ready data; times in milliseconds, a pass's the sum of its sub-passes', frame by frame.
    ``bound`` is what :func:`rendergraph.measure.perturb.perturb_document` found.
    """
    graph, times = result.plan.graph, result.times
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": title,
        "clock": {"name": result.device.clock, "proof": result.device.proof},
        "device": device_record(result.device),
        "size": [graph.frame.width, graph.frame.height],
        "frames": result.frames,
        "warm_up_frames": times.warm_up,
        "timed_frames": len(times.frames),
        "once_ms": {
            "plan": milliseconds(times.plan_ns),
            "scene": milliseconds(times.scene_ns),
            "compile": milliseconds(times.compile_ns),
            "upload": milliseconds(times.upload_ns),
            "first_frame": milliseconds(times.first_frame_ns),
        },
        "frame_ms": spread(times.frames),
        "frame_submit_ms": spread(times.frame_submits),
        "statistics": statistics_source(result.counters, result.device.renderer),
        "passes": pass_records(result.plan, times.steps, result.counters),
        "steady_state": {
            "objects_created": result.steady.objects_created,
            "programs_compiled": result.steady.programs_compiled,
            "bytes_uploaded": result.steady.bytes_uploaded,
        },
        "bound": bound,
        "driver_warnings": driver_warnings(result.warnings),
        **switches_record(result),
    }


def switches_record(result: FrameResult) -> dict[str, Any]:
    """Which plan ran from which frame on; nothing for a scene that does not change."""
    if not result.switches:
        return {}
    return {
        "switches": [
            {**asdict(s), "history_kept": list(s.history_kept), "history_cleared": list(s.history_cleared)}
            for s in result.switches
        ]
    }


def pass_records(
    plan: Plan, step_times: Sequence[StepTimes], step_counters: Sequence[StepCounters]
) -> list[dict[str, Any]]:
    """The passes that ran, in execution order, each with its sub-passes."""
    times = {step.name: step for step in step_times}
    counters = {step.name: step for step in step_counters}
    by_pass: dict[str, list[SubPass]] = {}
    for subpass in plan.order:
        by_pass.setdefault(subpass.parent, []).append(subpass)
    records = []
    for name, inside in by_pass.items():
        inside = [s for s in plan.graph.passes[name].subpasses if s in inside]
        timed = [times[s.name] for s in inside if s.name in times]
        counted = [counters[s.name] for s in inside if s.name in counters]
        records.append({
            "name": name,
            "node": plan.graph.passes[name].node,
            **_measured(timed, counted),
            "subpasses": [
                {
                    "name": s.name,
                    **_measured(
                        [times[s.name]] if s.name in times else [], [counters[s.name]] if s.name in counters else []
                    ),
                }
                for s in inside
            ],
        })  # fmt: skip
    return records


def _measured(times: Sequence[StepTimes], counters: Sequence[StepCounters]) -> dict[str, Any]:
    device = spread(_sums([step.device_ns for step in times]))
    return {
        "ms": device,
        "submit_ms": spread(_sums([step.submit_ns for step in times])),
        "process_ms": spread(_sums([step.process_ns for step in times])),
        "counters": add_counters(counters),
        "statistics": add_statistics(counters),
        "gb_per_s": gigabytes_per_second(counters, device["median"]),
    }


def _sums(columns: Sequence[Sequence[int]]) -> list[int]:
    """The sum of the sub-passes' samples, frame by frame."""
    return [sum(values) for values in zip(*columns, strict=True)]


def device_record(facts: DeviceFacts) -> dict[str, Any]:
    """Who ran it: what must be equal for times to be compared."""
    return {
        "renderer": facts.renderer,
        "vendor": facts.vendor,
        "version": facts.version,
        "driver": driver_version(facts.version),
        "cpu": _cpu_name(),
        "threads": thread_count(facts.renderer),
        "python": platform.python_version(),
    }


def driver_version(version: str) -> str:
    """The driver's own part of a GL_VERSION string: ``4.5 (Core Profile) Mesa 22.3.6`` is driven by ``Mesa 22.3.6``.

    GL 4.5, 22.2: version number, a space, vendor-specific information.
    """
    _, _, own = version.partition(" ")
    return re.sub(r"^\((?:Core|Compatibility) Profile\) ", "", own) or version


def thread_count(renderer: str) -> int:
    """CPU threads the work may use: those this process is allowed, or what LP_NUM_THREADS tells llvmpipe to rasterise
    with (0: in the calling thread).
    """
    asked = os.environ.get("LP_NUM_THREADS", "")
    if renderer.lower().startswith("llvmpipe") and asked.isdecimal():
        return max(1, int(asked))
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _cpu_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        return platform.processor()
