"""What a sub-pass asks of the device: draws, dispatches, triangles, bytes; and what the device itself counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rendergraph.device import enums
from rendergraph.device.buffers import read_buffer
from rendergraph.device.context import Device
from rendergraph.device.statistics import count_statistics
from rendergraph.plan.graph import (
    CopyBuffer,
    CopyTexture,
    Dispatch,
    DispatchIndirect,
    DrawArrays,
    DrawIndirect,
    DrawScene,
    Fullscreen,
    SubPass,
)
from rendergraph.plan.plan import Plan
from rendergraph.plan.traffic import DRAW_ARGUMENTS, declared_bytes
from rendergraph.run.allocation import Allocation
from rendergraph.run.commands import Command
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.result import StepCounters


def count_step(plan: Plan, subpass: SubPass, geometry: SceneGeometry | None) -> StepCounters:
    """What the plan says of a sub-pass. What the arguments of indirect work add up to, only a run tells."""
    read, written = declared_bytes(plan, subpass)
    none = StepCounters(subpass.name, bytes_read=read, bytes_written=written)
    match subpass.work:
        case Fullscreen():
            return replace(none, draws=1, draw_calls=1, triangles=1)
        case DrawArrays(vertices, instances, topology, separate):
            calls = instances if separate else 1
            triangles = instances * triangles_of(topology, vertices)
            return replace(none, draws=calls, draw_calls=calls, triangles=triangles)
        case DrawIndirect(_, _, count, _):
            return replace(none, draws=count, draw_calls=1, triangles=None)
        case DrawScene(queues, instances):
            assert geometry is not None
            batches = [batch for queue in queues for batch in geometry.batches(queue, instances)]
            draws, triangles = sum(b.count for b in batches), sum(b.triangles for b in batches)
            return replace(none, draws=draws, draw_calls=len(batches), triangles=triangles)
        case Dispatch(x, y, z):
            return replace(none, dispatches=1, groups=x * y * z)
        case DispatchIndirect():
            return replace(none, dispatches=1, groups=None)
        case CopyTexture(host=True) | CopyBuffer(host=True):
            return replace(none, host_bytes=written)
    return none


def count_command(
    device: Device, plan: Plan, command: Command, storage: Allocation, geometry: SceneGeometry | None, frame: int
) -> StepCounters:
    """Run a command with the device counting; arguments of indirect work are read back before it. Waits: never in a
    timed frame.
    """
    counters = count_step(plan, command.subpass, geometry)
    match command.subpass.work:
        case DrawIndirect(name, offset, count, topology):
            words = _arguments(device, storage, name, frame, offset, DRAW_ARGUMENTS * count).reshape(count, 4)
            triangles = sum(int(instances) * triangles_of(topology, int(v)) for v, instances, *_ in words)
            counters = replace(counters, triangles=triangles)
        case DispatchIndirect(name, offset):
            x, y, z = (int(word) for word in _arguments(device, storage, name, frame, offset, 12))
            counters = replace(counters, groups=x * y * z)
    return replace(counters, statistics=count_statistics(device, command.run))


def _arguments(
    device: Device, storage: Allocation, name: str, frame: int, offset: int, bytes: int
) -> np.ndarray[tuple[int, ...], np.dtype[np.uint32]]:
    # The command brings its own barrier for the arguments, but for its own way of reading them.
    device.gl.glMemoryBarrier(enums.BUFFER_UPDATE_BARRIER_BIT)
    return np.frombuffer(read_buffer(device, storage.buffer(name, frame), offset, bytes), dtype=np.uint32)


def triangles_of(topology: str, vertices: int) -> int:
    """Triangles (or patches of three vertices) that a number of vertices makes; none of points and lines."""
    if topology in ("triangles", "patches"):
        return vertices // 3
    return max(0, vertices - 2) if topology == "triangle_strip" else 0
