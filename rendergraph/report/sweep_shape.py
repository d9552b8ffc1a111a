"""The shape of ``sweep.json``; :mod:`rendergraph.report.sweep` makes one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rendergraph.report.accuracy_shape import Amount
from rendergraph.report.record_shape import Bytes, Count, Head, Milliseconds, Part, Share

Rounds = list[list[Milliseconds]]
Error = Amount | None


class IntervalRecord(Part):
    """An estimate and its limits at a confidence of 95 %."""

    estimate: Annotated[float, Field(ge=0)]
    low: Annotated[float, Field(ge=0)]
    high: Amount = Field(description="inf: too few rounds to tell.")


class SweepErrorRecord(Part):
    """By what settings are judged."""

    name: str = Field(description="As --error takes it.")
    kind: Literal["pass", "image"]
    passed: str = Field(alias="pass", description="Empty for images.")
    measure: str
    output: str = Field(description="The output compared; empty for passes.")
    quantity: Literal["display", "radiance", "normal", "depth", "share", "identity", "scalar"]
    metric: str
    why: Literal["asked", "one_pass", "several_passes", "no_ideal_reference"]
    twin: list[str] = Field(description="Of images: the settings whose image is taken for true, as --set takes them.")


class SweepAxisRecord(Part):
    """What is varied, and how the error runs along it."""

    name: str
    path: str
    values: list[str] = Field(description="From cheap to accurate where quality is given.")
    quality: Literal["up", "down", "order", ""]
    passed: str = Field(alias="pass")
    errors: list[Error] = Field(description="At each value; empty for an axis that claims nothing about accuracy.")
    shape: Literal["falls", "flat", "rises", "bumpy", "unknown", ""]
    method: Literal["slice", "mean", ""] = Field(description="At fixed values of the others, or over all settings.")
    at: list[str] = Field(description="The values that the others are held at.")


class SweepPointRecord(Part):
    """One setting."""

    set: list[str] = Field(description="As --set takes them.")
    own: bool = Field(description="Whether it is the document's own setting.")
    ms: IntervalRecord | None = Field(description="A frame, by the control of its rounds; null where it was refused.")
    relative: IntervalRecord | None = Field(description="To the document's own setting.")
    rounds: Rounds = Field(description="Raw frame times, by round.")
    chunk: Count = Field(description="The settings of a chunk were timed in turn with its control.")
    bytes: Bytes = Field(description="Transient memory used.")
    error: Error
    standard_error: Amount = Field(description="Of the error over frames, where the graph is random; else 0.")
    tolerance: Annotated[float, Field(ge=0)] | None = Field(description="That the node states for this setting.")
    verdict: Literal["within", "above", "measured", "cannot_judge", "no_truth", "refused"]
    reason: str
    steady: bool
    contended: bool = Field(description="Another process measured on the same device meanwhile.")
    front: bool = Field(description="No other is as good in time, bytes and error, and better in one.")


class SweepChunkRecord(Part):
    """Settings measured together: the frame times of the document's own setting beside them."""

    number: Count
    contended: bool
    control: Rounds


class RecommendedRecord(Part):
    """The setting to take."""

    point: Count = Field(description="Index into points.")
    set: str = Field(description="The options to paste.")
    ms: Milliseconds
    bytes: Bytes
    error: Error


class SweepDeviceRecord(Part):
    """Who ran it."""

    renderer: str
    driver: str
    threads: Count


class SweepDesignRecord(Part):
    """How it was measured."""

    frames: Count = Field(description="Timed frames a round.")
    rounds: Count
    seed: Count
    confidence: Share
    sampled: bool = Field(description="Whether the settings are a Latin hypercube, not all combinations.")


class SweepLimitsRecord(Part):
    """What was asked of the setting to take."""

    budget_ms: Milliseconds | None
    max_error: Annotated[float, Field(ge=0)] | None


class SweepRecord(Head):
    """Time, bytes and error of a graph's settings, and which of them are worth having."""

    version: Literal["rendergraph.sweep/1"] = Field(alias="schema")
    graph: str
    complete: bool
    device: SweepDeviceRecord
    design: SweepDesignRecord
    limits: SweepLimitsRecord
    error: SweepErrorRecord
    axes: list[SweepAxisRecord]
    control: SweepPointRecord = Field(description="The document's own setting.")
    control_ms: IntervalRecord
    points: list[SweepPointRecord]
    chunks: list[SweepChunkRecord]
    recommended: RecommendedRecord | None
