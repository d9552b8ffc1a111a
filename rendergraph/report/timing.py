"""``timing.json``: the times of a run, with their clock, renderer and raw samples."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

import rendergraph
from rendergraph.run.result import FrameResult

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


def timing_record(result: FrameResult, title: str = "") -> dict[str, Any]:
    """The record as JSON-ready data; times in milliseconds, a pass's the sum of its sub-passes', frame by frame."""
    graph, times = result.plan.graph, result.times
    steps = {step.name: step for step in times.steps}
    passes: list[dict[str, Any]] = []
    for name, parent in graph.passes.items():
        inside = [steps[s.name] for s in parent.subpasses if s.name in steps]
        if not inside:
            continue
        totals = [sum(values) for values in zip(*(s.device_ns for s in inside), strict=True)]
        passes.append({
            "name": name,
            "node": parent.node,
            "ms": spread(totals),
            "subpasses": [
                {
                    "name": s.name,
                    "ms": spread(s.device_ns),
                    "submit_ms": spread(s.submit_ns),
                    "process_ms": spread(s.process_ns),
                }
                for s in inside
            ],
        })  # fmt: skip
    first_use = {s.parent: index for index, s in reversed(list(enumerate(result.plan.order)))}
    passes.sort(key=lambda p: first_use[p["name"]])
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": title,
        "clock": {"name": result.device.clock, "proof": result.device.proof},
        "device": {
            "renderer": result.device.renderer,
            "vendor": result.device.vendor,
            "version": result.device.version,
            "cpu": _cpu_name(),
            "threads": os.cpu_count(),
            "python": platform.python_version(),
        },
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
        "passes": passes,
        "steady_state": {
            "objects_created": result.steady.objects_created,
            "programs_compiled": result.steady.programs_compiled,
            "bytes_uploaded": result.steady.bytes_uploaded,
        },
    }


def _cpu_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        return platform.processor()
