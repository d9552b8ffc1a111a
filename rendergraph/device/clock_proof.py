"""The start-up proof of a clock: a drawn and a dispatched load, each timed by timestamps and by a fenced wall clock.

llvmpipe's GL timers measure binning, not rasterising: its timestamps are off by an order of magnitude for draws.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.proof_loads import ProofLoads
from rendergraph.device.timestamps import create_timestamp, read_timestamp

#: How far two honest clocks may be apart: a share of the wall time, or a fixed time where that is larger.
RELATIVE_TOLERANCE: Final = 0.25
ABSOLUTE_TOLERANCE_NS: Final = 50_000
_REPEATS: Final = 5
_ENOUGH_BITS: Final = 36  # 68 s of nanoseconds


@dataclass(frozen=True, slots=True)
class ClockProof:
    """Least nanoseconds of one raster and one compute load by both clocks, and why the clock was chosen."""

    reason: str  # "agree" | "disagree" | "no_counter" | "software"
    counter_bits: int
    raster_wall_ns: int = 0
    raster_timestamp_ns: int = 0
    compute_wall_ns: int = 0
    compute_timestamp_ns: int = 0


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
    if reason == "agree" and device.info.is_software:
        # Its stamps miss the rasterising; that they agreed this once is the noise of a busy machine.
        reason = "software"
    return ClockProof(reason, bits.value, *raster, *compute)


def agree(wall_ns: int, timestamp_ns: int) -> bool:
    """Whether two clocks tell the same time."""
    return abs(wall_ns - timestamp_ns) <= max(RELATIVE_TOLERANCE * wall_ns, ABSOLUTE_TOLERANCE_NS)


def _time_load(device: Device, load: Callable[[], None]) -> tuple[int, int]:
    """Least wall and timestamp nanoseconds of a load: whatever else the machine does only ever adds."""
    queries = [create_timestamp(device) for _ in range(2)]
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
    return min(wall), min(stamps)
