"""A run of a shipped graph, made up without a device: round times, and targets whose texels are known."""

from __future__ import annotations

import numpy as np

from rendergraph.document.load import load_document
from rendergraph.measure.bound import classify
from rendergraph.measure.bound_evidence import RoundTimes
from rendergraph.plan.graph import TextureDesc
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.html import TargetGallery
from rendergraph.run.result import DeviceFacts, FrameResult, Pixels, RunTimes, SteadyState, StepCounters, StepTimes

MS = 1_000_000

#: What perturbed runs of a frame of heavy pixels say, a round of each.
BOUND = classify(
    {
        "base": [RoundTimes(10.0, 0.2, 0.2, 10.0)], "half_resolution": [RoundTimes(2.7, 0.2, 0.2, 2.7)],
        "nothing_rasterised": [RoundTimes(0.4, 0.2, 0.2, 0.4)], "no_draws": [RoundTimes(0.3, 0.2, 0.2, 0.3)],
    },
    [StepCounters("p.draw", draws=1, triangles=48000)],
)  # fmt: skip


def made_up_plan(name: str = "deferred_shading") -> Plan:
    """A shipped graph's plan."""
    return plan_without_scene(load_document(name), PlanOptions())[0]


def made_up_result(plan: Plan, samples: int = 3, device_lag: int = 0) -> FrameResult:
    """Frames start 1 s apart. Sub-pass i takes i + 1 ms, the next starts 1 ms later; the device starts ``device_lag``
    nanoseconds after the host, whose submission takes 0.5 ms.
    """
    starts = [MS * sum(range(1, i + 1)) + MS * i for i in range(len(plan.order))]
    steps = tuple(
        StepTimes(
            subpass.name,
            (MS * (i + 1),) * samples,
            (MS // 2,) * samples,
            (MS,) * samples,
            tuple(5 * MS + 1000 * MS * s + starts[i] + device_lag for s in range(samples)),
            tuple(5 * MS + 1000 * MS * s + starts[i] for s in range(samples)),
        )
        for i, subpass in enumerate(plan.order)
    )
    frames = tuple(MS * (40 + 10 * s) for s in range(samples))
    return FrameResult(
        plan=plan,
        images={},
        files={},
        captures={},
        times=RunTimes(1, 2, 3, 4, 5 * MS, frames, steps, 1),
        steady=SteadyState(0, 0, 0),
        device=DeviceFacts("renderer", "vendor", "version", "finish_wall", {"reason": "disagree"}),
        frames=1,
    )


def ramp(height: int, width: int, channels: int = 1) -> Pixels:
    """float32 texels: channel c of texel (x, y) holds 10 y + x + c / 4."""
    y, x, c = np.meshgrid(np.arange(height), np.arange(width), np.arange(channels), indexing="ij")
    return (10 * y + x + c / 4).astype(np.float32)


def made_up_gallery(plan: Plan) -> TargetGallery:
    """Every texture of the plan, 4 x 3 texels of a ramp (uint8 where it is displayed)."""
    gallery = TargetGallery()
    for name in plan.lifetimes:
        desc = plan.graph.resources[name].desc
        if isinstance(desc, TextureDesc):
            eight = desc.format in ("rgba8", "srgb8_a8")
            gallery.add(
                name, ramp(3, 4, 4).astype(np.uint8) if eight else ramp(3, 4, 1 if desc.format[0] == "d" else 3)
            )
    return gallery
