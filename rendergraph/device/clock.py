"""The clock of a renderer, chosen by proof: GPU timestamps where they agree with a fenced wall clock, else that one."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Final, Protocol

from rendergraph.device import enums as e
from rendergraph.device.clock_proof import ClockProof, prove_clock
from rendergraph.device.context import Device
from rendergraph.device.timestamps import create_timestamp, read_available, read_device_time, read_timestamps

#: Frames whose timestamps wait to be read: reading costs a call a pass, and a frame that is timed should not pay it.
RING: Final = 32


class Clock(Protocol):
    """Times the passes of a frame. Call ``begin`` and ``end`` round each pass, in order.

    ``end_frame`` gives the frame's nanoseconds a pass once they are known, else ``None``; ``drain`` waits for and
    gives every frame not given out yet, oldest first. ``submit_ns`` and ``process_ns`` are the last ended frame's
    wall time spent submitting and CPU time of all the process's threads, a pass; ``submit_starts`` when submitting
    began. ``starts`` are the drained frames' moments at which the device began each pass. Moments are nanoseconds of
    ``time.perf_counter_ns``, whichever counter measured them.
    """

    name: str
    proof: ClockProof
    submit_ns: list[int]
    process_ns: list[int]
    submit_starts: list[int]
    starts: list[list[int]]

    def begin_frame(self) -> None: ...
    def begin(self, index: int) -> None: ...
    def end(self, index: int) -> None: ...
    def end_frame(self) -> list[int] | None: ...
    def drain(self) -> list[list[int]]: ...


@dataclass(slots=True)
class FinishWallClock:
    """Wall time between two waits for the device: honest anywhere, but passes no longer overlap (about 0.1 ms each)."""

    device: Device
    proof: ClockProof
    name: str = "finish_wall"
    submit_ns: list[int] = field(default_factory=list)
    process_ns: list[int] = field(default_factory=list)
    submit_starts: list[int] = field(default_factory=list)
    starts: list[list[int]] = field(default_factory=list)
    _times: list[int] = field(default_factory=list)
    _frames: list[list[int]] = field(default_factory=list)
    _begun: list[list[int]] = field(default_factory=list)
    _start: int = 0
    _cpu: int = 0

    def begin_frame(self) -> None:
        """Start a frame: whatever was pending is waited for, and no pass pays for it."""
        self._times, self.submit_ns, self.process_ns, self.submit_starts = [], [], [], []
        self.device.finish()

    def begin(self, index: int) -> None:
        """Start pass ``index``."""
        self._cpu = time.process_time_ns()
        self._start = time.perf_counter_ns()

    def end(self, index: int) -> None:
        """End pass ``index``: wait for it."""
        submitted = time.perf_counter_ns()
        self.device.finish()
        self._times.append(time.perf_counter_ns() - self._start)
        self.submit_starts.append(self._start)
        self.submit_ns.append(submitted - self._start)
        self.process_ns.append(time.process_time_ns() - self._cpu)

    def end_frame(self) -> list[int] | None:
        """This frame's nanoseconds a pass."""
        self._frames.append(self._times)
        self._begun.append(self.submit_starts)
        return self._times

    def drain(self) -> list[list[int]]:
        """Every frame since the last drain."""
        frames, self._frames = self._frames, []
        self.starts, self._begun = self._begun, []
        return frames


@dataclass(slots=True)
class TimestampClock:
    """GPU timestamps between passes, read some frames later so that nothing waits.

    A timestamp is taken when all work before it is done, so the end of a pass is the beginning of the next: one query
    for both, which halves what recording costs. Nothing but passes may be submitted between ``begin`` of a frame's
    first pass and ``end_frame``.
    """

    device: Device
    proof: ClockProof
    name: str = "gpu_timestamp"
    submit_ns: list[int] = field(default_factory=list)
    process_ns: list[int] = field(default_factory=list)
    submit_starts: list[int] = field(default_factory=list)
    starts: list[list[int]] = field(default_factory=list)
    _free: list[list[int]] = field(default_factory=list)
    _queries: list[int] = field(default_factory=list)
    # (queries, passes, host time less device time), oldest first
    _pending: list[tuple[list[int], int, int]] = field(default_factory=list)
    _frames: list[list[int]] = field(default_factory=list)
    _begun: list[list[int]] = field(default_factory=list)
    _ahead: int = 0
    _cpu: list[int] = field(default_factory=list)  # of the process, at each mark
    _stamp: Callable[..., Any] = field(init=False)

    def __post_init__(self) -> None:
        self._stamp, _ = self.device.gl.repeated(self.device.gl.glQueryCounter)

    def begin_frame(self) -> None:
        """Start a frame. Where the device is behind by more frames than the ring holds, it grows: nothing waits."""
        self._queries = self._free.pop() if self._free else []
        self.submit_ns, self.process_ns, self.submit_starts, self._cpu = [], [], [], []
        self._ahead = time.perf_counter_ns() - read_device_time(self.device)

    def begin(self, index: int) -> None:
        """Start pass ``index``, and end the one before."""
        self._mark()

    def end(self, index: int) -> None:
        """End pass ``index``: the next mark does."""

    def _mark(self) -> None:
        index = len(self._cpu)
        if index == len(self._queries):
            self._queries.append(create_timestamp(self.device))
        self._cpu.append(time.process_time_ns())
        self.submit_starts.append(time.perf_counter_ns())
        self._stamp(self._queries[index], e.TIMESTAMP)

    def end_frame(self) -> list[int] | None:
        """The oldest unread frame's nanoseconds a pass, if the ring is full and the device has finished it."""
        self._mark()
        self.submit_ns = [b - a for a, b in pairwise(self.submit_starts)]
        self.process_ns = [b - a for a, b in pairwise(self._cpu)]
        self.submit_starts.pop()
        self._pending.append((self._queries, len(self.submit_ns), self._ahead))
        self.device.gl.glFlush()
        queries, count, _ = self._pending[0]
        if len(self._pending) <= RING or not read_available(self.device, queries[count]):
            return None
        self._frames.append(self._collect())
        return self._frames[-1]

    def drain(self) -> list[list[int]]:
        """Wait for all frames, and give every one since the last drain."""
        while self._pending:
            self._frames.append(self._collect())
        frames, self._frames = self._frames, []
        self.starts, self._begun = self._begun, []
        return frames

    def _collect(self) -> list[int]:
        queries, count, ahead = self._pending.pop(0)
        stamps = read_timestamps(self.device, queries[: count + 1])
        self._free.append(queries)
        self._begun.append([stamp + ahead for stamp in stamps[:-1]])
        mask = (1 << self.proof.counter_bits) - 1  # a counter of fewer than 64 bits may have wrapped in between
        return [(b - a) & mask for a, b in pairwise(stamps)]


def choose_clock(device: Device) -> Clock:
    """The clock this renderer deserves, with its proof; proven once a device."""
    proof = device.clock_proof
    if proof is None:
        proof = device.clock_proof = prove_clock(device)
    return TimestampClock(device, proof) if proof.reason == "agree" else FinishWallClock(device, proof)
