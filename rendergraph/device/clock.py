"""The clock of a renderer, chosen by proof: GPU timestamps where they agree with a fenced wall clock, else that one.

llvmpipe's GL timers measure binning, not rasterising, and a dispatch runs before its first timestamp is taken; its
timestamps are off by an order of magnitude for raster passes. So both kinds of load are timed both ways at start-up.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, Protocol

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.proof_loads import ProofLoads

#: How far two honest clocks may be apart: a share of the wall time, or a fixed time where that is larger.
RELATIVE_TOLERANCE: Final = 0.25
ABSOLUTE_TOLERANCE_NS: Final = 50_000
#: Frames whose timestamps may be in flight before the oldest is waited for.
RING: Final = 4
_REPEATS: Final = 3
_ENOUGH_BITS: Final = 36  # 68 s of nanoseconds


@dataclass(frozen=True, slots=True)
class ClockProof:
    """Median nanoseconds of one raster and one compute load by both clocks, and why the clock was chosen."""

    reason: str  # "agree" | "disagree" | "no_counter"
    counter_bits: int
    raster_wall_ns: int = 0
    raster_timestamp_ns: int = 0
    compute_wall_ns: int = 0
    compute_timestamp_ns: int = 0


class Clock(Protocol):
    """Times the passes of a frame. Call ``begin`` and ``end`` round each pass, in order.

    ``end_frame`` gives the frame's nanoseconds a pass once they are known, else ``None``; ``drain`` waits for and
    gives every frame not given out yet, oldest first. ``submit_ns`` and ``process_ns`` are the last frame's
    wall time spent submitting and CPU time of all the process's threads, a pass.
    """

    name: str
    proof: ClockProof
    submit_ns: list[int]
    process_ns: list[int]

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
    _times: list[int] = field(default_factory=list)
    _frames: list[list[int]] = field(default_factory=list)
    _start: int = 0
    _cpu: int = 0

    def begin_frame(self) -> None:
        """Start a frame: whatever was pending is waited for, and no pass pays for it."""
        self._times, self.submit_ns, self.process_ns = [], [], []
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
        self.submit_ns.append(submitted - self._start)
        self.process_ns.append(time.process_time_ns() - self._cpu)

    def end_frame(self) -> list[int] | None:
        """This frame's nanoseconds a pass."""
        self._frames.append(self._times)
        return self._times

    def drain(self) -> list[list[int]]:
        """Every frame since the last drain."""
        frames, self._frames = self._frames, []
        return frames


@dataclass(slots=True)
class TimestampClock:
    """GPU timestamps around each pass, read some frames later so that nothing waits."""

    device: Device
    proof: ClockProof
    name: str = "gpu_timestamp"
    submit_ns: list[int] = field(default_factory=list)
    process_ns: list[int] = field(default_factory=list)
    _ring: list[list[int]] = field(default_factory=lambda: [[] for _ in range(RING)])
    _pending: list[tuple[int, int]] = field(default_factory=list)  # (ring slot, passes), oldest first
    _frames: list[list[int]] = field(default_factory=list)
    _frame: int = 0
    _start: int = 0
    _cpu: int = 0

    def begin_frame(self) -> None:
        """Start a frame; waits for the frame whose queries are used again."""
        if len(self._pending) == RING:
            self._frames.append(self._collect())
        self.submit_ns, self.process_ns = [], []

    def begin(self, index: int) -> None:
        """Start pass ``index``."""
        queries = self._ring[self._frame % RING]
        while len(queries) < 2 * index + 2:
            queries.append(_query(self.device))
        self._cpu = time.process_time_ns()
        self._start = time.perf_counter_ns()
        self.device.gl.glQueryCounter(queries[2 * index], e.TIMESTAMP)

    def end(self, index: int) -> None:
        """End pass ``index``."""
        self.device.gl.glQueryCounter(self._ring[self._frame % RING][2 * index + 1], e.TIMESTAMP)
        self.submit_ns.append(time.perf_counter_ns() - self._start)
        self.process_ns.append(time.process_time_ns() - self._cpu)

    def end_frame(self) -> list[int] | None:
        """The oldest unread frame's nanoseconds a pass, if the device has finished it."""
        self._pending.append((self._frame % RING, len(self.submit_ns)))
        self._frame += 1
        self.device.gl.glFlush()
        slot, count = self._pending[0]
        if count and not read_available(self.device, self._ring[slot][2 * count - 1]):
            return None
        self._frames.append(self._collect())
        return self._frames[-1]

    def drain(self) -> list[list[int]]:
        """Wait for all frames, and give every one since the last drain."""
        while self._pending:
            self._frames.append(self._collect())
        frames, self._frames = self._frames, []
        return frames

    def _collect(self) -> list[int]:
        slot, count = self._pending.pop(0)
        stamps = [read_timestamp(self.device, query) for query in self._ring[slot][: 2 * count]]
        return [stamps[2 * i + 1] - stamps[2 * i] for i in range(count)]


def _query(device: Device) -> int:
    """A timestamp query; not counted, since it belongs to the measurement and not to the graph."""
    name = device.gl.create("glCreateQueries", e.TIMESTAMP)
    device.owned["glDeleteQueries", name] = "pass time"
    return name


def read_timestamp(device: Device, query: int) -> int:
    """A timestamp in nanoseconds, waited for; 64 bits, since 32 wrap after 4.3 s."""
    value = ctypes.c_uint64()
    device.gl.glGetQueryObjectui64v(query, e.QUERY_RESULT, ctypes.byref(value))
    return value.value


def read_available(device: Device, query: int) -> bool:
    """Whether a query's result is there."""
    value = ctypes.c_int()
    device.gl.glGetQueryObjectiv(query, e.QUERY_RESULT_AVAILABLE, ctypes.byref(value))
    return bool(value.value)


def choose_clock(device: Device) -> Clock:
    """The clock this renderer deserves, with its proof; proven once a device."""
    proof = device.clock_proof
    if proof is None:
        proof = device.clock_proof = prove_clock(device)
    return TimestampClock(device, proof) if proof.reason == "agree" else FinishWallClock(device, proof)


def prove_clock(device: Device) -> ClockProof:
    """Time a raster and a compute load by both clocks. What that makes is not counted: no graph asked for it."""
    bits = ctypes.c_int()
    device.gl.glGetQueryiv(e.TIMESTAMP, e.QUERY_COUNTER_BITS, ctypes.byref(bits))
    if bits.value < _ENOUGH_BITS:
        return ClockProof("no_counter", bits.value)
    counted = device.counters.snapshot()
    loads = ProofLoads(device)
    try:
        raster = _time_load(device, loads.raster)
        compute = _time_load(device, loads.compute)
    finally:
        loads.release()
        device.counters = counted
    reason = "agree" if all(agree(*pair) for pair in (raster, compute)) else "disagree"
    return ClockProof(reason, bits.value, *raster, *compute)


def agree(wall_ns: int, timestamp_ns: int) -> bool:
    """Whether two clocks tell the same time."""
    return abs(wall_ns - timestamp_ns) <= max(RELATIVE_TOLERANCE * wall_ns, ABSOLUTE_TOLERANCE_NS)


def _time_load(device: Device, load: Callable[[], None]) -> tuple[int, int]:
    """Median wall and timestamp nanoseconds of a load, each measured with the other off."""
    queries = [_query(device) for _ in range(2)]
    load()
    device.finish()
    wall, stamps = [], []
    for _ in range(_REPEATS):
        start = time.perf_counter_ns()
        load()
        device.finish()
        wall.append(time.perf_counter_ns() - start)
        device.gl.glQueryCounter(queries[0], e.TIMESTAMP)
        load()
        device.gl.glQueryCounter(queries[1], e.TIMESTAMP)
        device.finish()
        first, last = (read_timestamp(device, query) for query in queries)
        stamps.append(last - first)
    for query in queries:
        device.delete_object("glDeleteQueries", query)
    return sorted(wall)[_REPEATS // 2], sorted(stamps)[_REPEATS // 2]
