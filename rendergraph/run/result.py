"""What a run yields: pixels, times and counts, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy.typing as npt

from rendergraph.document.messages import Diagnostic
from rendergraph.plan.plan import Plan

Pixels = npt.NDArray[Any]


@dataclass(frozen=True, slots=True)
class StepTimes:
    """One sub-pass: a sample a timed frame, in nanoseconds. ``device_ns`` by the record's clock; ``submit_ns`` is the
    time to hand it to the driver; ``process_ns`` the CPU time of all threads meanwhile. ``starts`` and
    ``submit_starts`` are when the device and the host began, on ``time.perf_counter_ns``'s clock.
    """

    name: str
    device_ns: tuple[int, ...]
    submit_ns: tuple[int, ...]
    process_ns: tuple[int, ...]
    starts: tuple[int, ...] = ()
    submit_starts: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class StepCounters:
    """One sub-pass of one frame. ``draws`` counts each of a multi-draw, ``draw_calls`` the calls; ``groups`` are work
    groups; ``None`` where only the device knows and was not asked. Bytes are those of declared accesses
    (:mod:`rendergraph.plan.traffic`), ``host_bytes`` of them went through the host. ``statistics`` are the device's own
    counts (:mod:`rendergraph.device.statistics`), ``None`` where it does not count.
    """

    name: str
    draws: int = 0
    draw_calls: int = 0
    dispatches: int = 0
    groups: int | None = 0
    triangles: int | None = 0
    bytes_read: int = 0
    bytes_written: int = 0
    host_bytes: int = 0
    statistics: dict[str, int] | None = None


@dataclass(frozen=True, slots=True)
class RunTimes:
    """Times of a run, in nanoseconds. ``frames`` are whole frames with all passes in flight, not serialised by the
    per-pass clock, and ``frame_submits`` the part of each until everything was handed over; ``steps`` are from frames
    timed pass by pass.
    """

    plan_ns: int
    scene_ns: int
    compile_ns: int
    upload_ns: int
    first_frame_ns: int
    frames: tuple[int, ...]
    steps: tuple[StepTimes, ...]
    warm_up: int
    frame_submits: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class SteadyState:
    """What frames after the first created: all zero, or something is wrong."""

    objects_created: int
    programs_compiled: int
    bytes_uploaded: int


@dataclass(frozen=True, slots=True)
class Switch:
    """A frame before which the scene changed: the number of the plan that runs from it on (0 the first), whether it had
    run before, what the change made and sent, and which history content was handed on or starts from zeros.
    """

    frame: int
    plan: int
    revisited: bool
    objects_created: int
    programs_compiled: int
    bytes_uploaded: int
    history_kept: tuple[str, ...] = ()
    history_cleared: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DeviceFacts:
    """Who ran it: strings for the record, and the clock with its proof."""

    renderer: str
    vendor: str
    version: str
    clock: str
    proof: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class FrameResult:
    """A finished run. ``images`` are the outputs and ``captures`` the intermediate targets asked for, by resource name
    (``{frame}`` outputs by ``name@frame``), each ``[height, width, channels]`` with the first row at the bottom.
    ``files`` are the images' file names inside the output folder, those that ``RenderOptions.take_frame`` was handed
    too.
    """

    plan: Plan
    images: dict[str, Pixels]
    files: dict[str, str]
    captures: dict[str, Pixels]
    times: RunTimes
    steady: SteadyState
    device: DeviceFacts
    frames: int
    warnings: tuple[Diagnostic, ...] = ()
    counters: tuple[StepCounters, ...] = ()
    switches: tuple[Switch, ...] = ()

    def _repr_html_(self) -> str:
        from rendergraph.report.notebook import result_html

        return result_html(self)

    def _repr_png_(self) -> bytes | None:
        from rendergraph.report.notebook import result_png

        return result_png(self)
