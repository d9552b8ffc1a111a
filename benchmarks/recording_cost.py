"""What recording a frame costs: frames under each clock against the same frames without, in turn, in one run.

    python -m benchmarks.recording_cost [GRAPH] [WIDTHxHEIGHT]

Without a graph, the chain of sixteen full-screen passes of ``benchmarks.frame_overhead``. A frame under
``gpu_timestamp`` stays pipelined, so its cost is a share of the frame; ``finish_wall`` waits after every pass, so its
cost is milliseconds a pass. Both are measured on every renderer: a clock's cost does not depend on whether its figures
can be believed. Targets: 2 % of the frame, 0.15 ms a pass.

Every frame ends with a flush: llvmpipe drops full-screen work that the next frame draws over before it was handed over,
which no clock is to blame for.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.frame_overhead.__main__ import graph as chain
from rendergraph.device.clock import Clock, FinishWallClock, TimestampClock, choose_clock
from rendergraph.device.context import Device, open_device
from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner

FRAMES = 8  # back to back, so that a wait between them would show
ROUNDS = 25


def bare(runner: Runner, index: int) -> None:
    """A frame without a record."""
    for command in runner.commands_of(index):
        command.run()


def recorded(clock: Clock) -> Callable[[Runner, int], None]:
    """A frame whose passes are timed by the clock."""

    def frame(runner: Runner, index: int) -> None:
        clock.begin_frame()
        for position, command in enumerate(runner.commands_of(index)):
            clock.begin(position)
            command.run()
            clock.end(position)
        clock.end_frame()

    return frame


def measure(device: Device, graph: str | Path, size: tuple[int, int]) -> None:
    """Measure one graph, and print."""
    proof = choose_clock(device).proof
    clocks = {"gpu_timestamp": TimestampClock(device, proof), "finish_wall": FinishWallClock(device, proof)}
    planned = plan_document(load_document(graph), PlanOptions(), size=size)
    scene = planned.scene.scene if planned.scene else None
    runner = Runner(device, planned.plan, scene, frame_cameras(planned))
    runner.prepare()
    ways = {"bare": bare, **{name: recorded(clock) for name, clock in clocks.items()}}
    times: dict[str, list[float]] = {name: [] for name in ways}
    index = 0
    for round_ in range(ROUNDS + 1):
        for name, frame in ways.items():
            device.finish()
            start = time.perf_counter()
            for _ in range(FRAMES):
                frame(runner, index)
                device.gl.glFlush()
                index += 1
            device.finish()
            if round_:  # the first compiles
                times[name].append(1000 * (time.perf_counter() - start) / FRAMES)
            for clock in clocks.values():
                clock.drain()
    runner.release()
    passes = len(planned.plan.order)
    print(f"{device.info.renderer}: {size[0]}x{size[1]}, {passes} sub-passes, {ROUNDS} rounds of {FRAMES} frames")
    for name, samples in times.items():
        # Rounds are compared with the bare frames beside them: the machine's own wander cancels.
        extra = median(b - a for a, b in zip(times["bare"], samples, strict=True))
        share = 100 * extra / median(times["bare"])
        each = f"{extra:+.3f} ms, {share:+.1f} %, {extra / passes:+.4f} ms a pass"
        print(f"  {name:14} {median(samples):8.3f} ms a frame: {each}")


def main() -> None:
    """The graph named, or the chain at two sizes."""
    device = open_device()
    if len(sys.argv) > 1:
        width, _, height = (sys.argv[2] if len(sys.argv) > 2 else "640x360").partition("x")
        measure(device, sys.argv[1], (int(width), int(height)))
        return
    for size in ((160, 90), (640, 360), (1280, 720)):
        with TemporaryDirectory() as folder:
            measure(device, chain(Path(folder), size), size)


if __name__ == "__main__":
    main()
