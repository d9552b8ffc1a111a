"""The shape of ``timing.json``; :mod:`rendergraph.report.timing` makes one."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from rendergraph.report.record_shape import Bytes, Count, Head, Milliseconds, Part, Share

Ratio = Annotated[float, Field(ge=0)]


class SpreadRecord(Part):
    """Raw samples in order of time, and their median and extremes: null where nothing was timed."""

    median: Milliseconds | None
    min: Milliseconds | None
    max: Milliseconds | None
    samples: list[Milliseconds]


class ClockRecord(Part):
    """The clock the times are from, and the proof it was chosen by."""

    name: Literal["gpu_timestamp", "finish_wall"]
    proof: dict[str, Any]


class DeviceRecord(Part):
    """Who ran it: what must be equal for times to be compared."""

    renderer: str
    vendor: str
    version: str = Field(description="The GL_VERSION string.")
    driver: str = Field(description="The driver's own part of it.")
    cpu: str
    threads: Annotated[int, Field(ge=1)]
    python: str


class OnceRecord(Part):
    """What happens once, before the steady state."""

    plan: Milliseconds
    scene: Milliseconds
    compile: Milliseconds
    upload: Milliseconds
    first_frame: Milliseconds


class CountersRecord(Part):
    """What was asked of the device in a frame: exact. null where only the device knows and was not asked."""

    draws: Count | None = Field(description="Each of a multi-draw.")
    draw_calls: Count | None
    dispatches: Count | None
    groups: Count | None = Field(description="Work groups.")
    triangles: Count | None
    bytes_read: Bytes | None = Field(description="By declared accesses, each part once.")
    bytes_written: Bytes | None
    host_bytes: Bytes | None = Field(description="Of them, those copied through the host.")


class _Measured(Part):
    name: str
    ms: SpreadRecord = Field(description="By the record's clock.")
    submit_ms: SpreadRecord = Field(description="To hand it to the driver.")
    process_ms: SpreadRecord = Field(description="CPU time of all threads meanwhile.")
    counters: CountersRecord
    statistics: dict[str, Count] | None = Field(description="What the device counted; null where it does not.")
    gb_per_s: float | None = Field(ge=0, description="Declared bytes over the median time, in 10^9 bytes a second.")


class StepRecord(_Measured):
    """A sub-pass."""


class PassRecord(_Measured):
    """A pass: the sum of its sub-passes, frame by frame."""

    node: str
    subpasses: Annotated[list[StepRecord], Field(min_length=1)]


class StatisticsRecord(Part):
    """Where the passes' statistics come from, and what to beware of."""

    source: str | None
    note: str


class SteadyRecord(Part):
    """What the frames after the first created: all zero, or something is wrong."""

    objects_created: Count
    programs_compiled: Count
    bytes_uploaded: Bytes


class SwitchRecord(Part):
    """A frame before which the scene changed, and what that took."""

    frame: Count
    plan: Count = Field(description="Number of the plan that runs from here on; 0 is the first frame's.")
    revisited: bool = Field(description="It ran before.")
    objects_created: Count
    programs_compiled: Count
    bytes_uploaded: Bytes
    history_kept: list[str] = Field(description="Histories handed on from the plan before.")
    history_cleared: list[str] = Field(description="Histories that it did not have: they start from zeros.")


class RoundRecord(Part):
    """A round of perturbed frames handed over back to back, a frame."""

    frame_ms: Milliseconds
    submit_ms: Milliseconds = Field(description="Until everything was handed over, waits for readbacks included.")
    submit_cpu_ms: Milliseconds = Field(description="Of the submitting thread.")
    process_cpu_ms: Milliseconds = Field(description="Of all threads.")
    readback_ms: Milliseconds
    readback_cpu_ms: Milliseconds


class EvidenceRecord(Part):
    """What a bound is told from: shares of the frame, and what is left of it under each perturbation (1: all)."""

    submit_share: Ratio
    readback_share: Ratio
    half_resolution: Ratio | None = Field(description="null where the graph has no plan at half its size.")
    nothing_rasterised: Ratio
    no_draws: Ratio
    no_readback: Ratio | None = Field(description="null where nothing is read back.")
    draws: Count
    primitives_per_draw: Ratio | None
    readback_bytes: Bytes


class ThresholdsRecord(Part):
    """Where the classes part: shares of the frame, and primitives a draw."""

    waiting: Ratio
    recovered: Ratio
    calling: Ratio
    submitting: Ratio
    small_draw: Ratio
    drawing: Ratio
    pixels: Ratio


Rounds = Annotated[list[RoundRecord], Field(min_length=1)]


class RunsRecord(Part):
    """Every round, by what was left out; absent where that cannot be."""

    base: Rounds
    nothing_rasterised: Rounds
    no_draws: Rounds
    half_resolution: Rounds = Field(default=[], description="Absent where the graph has no plan at half its size.")
    no_readback: Rounds = Field(default=[], description="Absent where nothing is read back.")


class BoundRecord(Part):
    """What the frame is bound by: the class by the rounds' medians, what it was told from, and every round."""

    bound_by: Literal["sync", "draw_calls", "gpu", "cpu"] = Field(alias="class")
    agreement: Share = Field(description="Of the rounds that alone say the same.")
    advice: str
    evidence: EvidenceRecord
    thresholds: ThresholdsRecord
    runs: RunsRecord


class DriverWarningRecord(Part):
    """Undefined behaviour that the driver noticed."""

    text: str
    subpass: str = Field(description="Empty where it came outside of one.")
    resource: str = Field(description="Empty where it is not known.")


class TimingRecord(Head):
    """The times of a run, with their clock, renderer and raw samples."""

    version: Literal["rendergraph.timing/1"] = Field(alias="schema")
    clock: ClockRecord
    device: DeviceRecord
    frames: Count = Field(description="Frames rendered.")
    warm_up_frames: Count
    timed_frames: Count
    once_ms: OnceRecord
    frame_ms: SpreadRecord = Field(description="Whole frames, passes overlapping as they can.")
    frame_submit_ms: SpreadRecord = Field(description="The part of each until everything was handed over.")
    statistics: StatisticsRecord
    passes: list[PassRecord] = Field(description="In execution order.")
    steady_state: SteadyRecord
    bound: BoundRecord | None = Field(description="null unless perturbed runs were asked for.")
    driver_warnings: list[DriverWarningRecord] = Field(description="Each once.")
    switches: list[SwitchRecord] = Field(default=[], description="Where the scene changed; absent where it did not.")
