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
    time to hand it to the driver; ``process_ns`` the CPU time of all threads meanwhile.
    """

    name: str
    device_ns: tuple[int, ...]
    submit_ns: tuple[int, ...]
    process_ns: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RunTimes:
    """Times of a run, in nanoseconds. ``frames`` are whole frames with all passes in flight, not serialised by the
    per-pass clock; ``steps`` are from frames timed pass by pass.
    """

    plan_ns: int
    scene_ns: int
    compile_ns: int
    upload_ns: int
    first_frame_ns: int
    frames: tuple[int, ...]
    steps: tuple[StepTimes, ...]
    warm_up: int


@dataclass(frozen=True, slots=True)
class SteadyState:
    """What frames after the first created: all zero, or something is wrong."""

    objects_created: int
    programs_compiled: int
    bytes_uploaded: int


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
    ``files`` are the images' file names inside the output folder.
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
