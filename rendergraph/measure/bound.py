"""What a frame is bound by: handing over draw calls, the device, a wait for the device in mid-frame, or the host.

After Gareth Morgan, "Profiling and Optimizing WebGL Applications Using Google Chrome" (GPU Zen, 2017): tell the walls
apart by where each side idles, and confirm by taking the suspected work away. Submitting alone does not tell: a
software renderer shades vertices and runs dispatches inside the call.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import median
from typing import Any, Final

from rendergraph.measure.bound_evidence import Evidence, RoundTimes, weigh
from rendergraph.run.result import StepCounters


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Where the classes part; shares of the frame. Recorded with every verdict."""

    waiting: float = 0.3  # of the frame spent waiting for readbacks
    recovered: float = 0.85  # of the frame left at most without them
    calling: float = 0.5  # of the frame left at least when nothing is rasterised, when calls are to count
    submitting: float = 0.5  # of the frame spent handing over
    small_draw: float = 100.0  # primitives a draw
    drawing: float = 0.6  # of the frame left at most without draws, when drawing is to count as what takes the time
    pixels: float = 0.75  # of the frame left at most at half resolution, when pixels are to count


THRESHOLDS: Final = Thresholds()

ADVICE: Final = {
    "sync": "the host waits for the device in mid-frame: leave the data on the device, or read it some frames later",
    "draw_calls": "handing over small draws takes the time: instance or merge them",
    "gpu": "the device takes the time: fewer pixels or cheaper shaders (half resolution), fewer vertices",
    "cpu": "neither draws nor the device take the time: fewer passes and state changes, or less work on the host",
}


def bound_of(evidence: Evidence, limits: Thresholds = THRESHOLDS) -> str:
    """``sync``, ``draw_calls``, ``gpu`` or ``cpu``."""
    e = evidence
    waits = e.readback_bytes > 0 and e.readback_share >= limits.waiting
    if waits and e.no_readback is not None and e.no_readback <= limits.recovered:
        return "sync"
    pixels = e.half_resolution is not None and e.half_resolution <= limits.pixels
    if e.no_draws > limits.drawing:
        return "gpu" if pixels else "cpu"
    small = e.primitives_per_draw is not None and e.primitives_per_draw < limits.small_draw
    calls = e.nothing_rasterised >= limits.calling and not pixels
    return "draw_calls" if small and calls and e.submit_share >= limits.submitting else "gpu"


def classify(rounds: Mapping[str, Sequence[RoundTimes]], counters: Sequence[StepCounters]) -> dict[str, Any]:
    """The record of a side's perturbed runs: the class by the medians, the share of single rounds that agree with it,
    the evidence, thresholds, and every round.
    """
    count = min(len(runs) for runs in rounds.values())
    single = [weigh({name: runs[i] for name, runs in rounds.items()}, counters) for i in range(count)]
    evidence = weigh({name: _middle(runs) for name, runs in rounds.items()}, counters)
    verdict = bound_of(evidence)
    return {
        "class": verdict,
        "agreement": round(sum(bound_of(e) == verdict for e in single) / count, 3),
        "advice": ADVICE[verdict],
        "evidence": {k: round(v, 6) if isinstance(v, float) else v for k, v in asdict(evidence).items()},
        "thresholds": asdict(THRESHOLDS),
        "runs": {name: [_rounded(run) for run in runs] for name, runs in rounds.items()},
    }


def _middle(runs: Sequence[RoundTimes]) -> RoundTimes:
    rows = [asdict(run) for run in runs]
    return RoundTimes(**{name: median(row[name] for row in rows) for name in rows[0]})


def _rounded(run: RoundTimes) -> dict[str, float]:
    return {name: round(value, 6) for name, value in asdict(run).items()}
