"""The figures a bound is told from: one round of perturbed frames, and their ratios."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rendergraph.run.result import StepCounters


@dataclass(frozen=True, slots=True)
class RoundTimes:
    """A round of frames handed over back to back, a frame. ``submit`` is until everything was handed over, waits for
    readbacks included; ``readback`` those waits. ``_cpu``: time the submitting thread ran; ``process_cpu`` all threads.
    """

    frame_ms: float
    submit_ms: float
    submit_cpu_ms: float
    process_cpu_ms: float
    readback_ms: float = 0.0
    readback_cpu_ms: float = 0.0


@dataclass(frozen=True, slots=True)
class Evidence:
    """Shares of the frame (0..1) and what is left of it (1: all) under each perturbation; ``half_resolution`` is None
    for a graph that cannot be planned at half its size, ``no_readback`` for one that reads nothing back.
    """

    submit_share: float
    readback_share: float
    half_resolution: float | None
    nothing_rasterised: float
    no_draws: float
    no_readback: float | None
    draws: int
    primitives_per_draw: float | None
    readback_bytes: int


def weigh(rounds: Mapping[str, RoundTimes], counters: Sequence[StepCounters]) -> Evidence:
    """The evidence of one round of every variant. Submitting counts without the waits for readbacks; primitives are the
    device's count, or else the plan's triangles.
    """
    base = rounds["base"]
    frame = max(base.frame_ms, 1e-9)
    draws = sum(step.draws for step in counters)
    primitives = [s.statistics["primitives"] if s.statistics is not None else s.triangles for s in counters]
    known = sum(count for count in primitives if count is not None)
    return Evidence(
        submit_share=max(0.0, base.submit_ms - base.readback_ms) / frame,
        readback_share=base.readback_ms / frame,
        half_resolution=rounds["half_resolution"].frame_ms / frame if "half_resolution" in rounds else None,
        nothing_rasterised=rounds["nothing_rasterised"].frame_ms / frame,
        no_draws=rounds["no_draws"].frame_ms / frame,
        no_readback=rounds["no_readback"].frame_ms / frame if "no_readback" in rounds else None,
        draws=draws,
        primitives_per_draw=known / draws if draws and None not in primitives else None,
        readback_bytes=sum(step.host_bytes for step in counters),
    )
