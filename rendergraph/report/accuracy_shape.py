"""The shape of ``accuracy.json``; :mod:`rendergraph.report.accuracy` makes one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rendergraph.report.record_shape import Bytes, Count, Head, Milliseconds, Part, Share

#: A number, or the name of one that JSON has not; null where there is none.
Number = float | Literal["inf", "-inf", "nan"]
#: The same for what is never negative.
Amount = Annotated[float, Field(ge=0)] | Literal["inf", "nan"]


class WorstTexelRecord(Part):
    """Where a measure is furthest off."""

    x: Count = Field(description="From the left.")
    y: Count = Field(description="From the bottom; the layers of an array stand above each other.")
    error: Amount = Field(description="Of the metric's kind.")
    judged: list[Number]
    true: list[Number]
    inputs: dict[str, list[Number]] = Field(description="What the pass's inputs of that size hold there, by port.")


class ZTestRecord(Part):
    """A random pass's test over texels."""

    frames: Count
    accepted: Share = Field(description="Values whose mean over the frames chance explains.")
    required: Share
    alpha_texel: float = Field(ge=0, le=1, description="Significance of one value, after Sidak's correction.")
    largest: Amount = Field(description="The largest deviation in standard errors.")


class MeasureRecord(Part):
    """One measure, judged."""

    name: str
    port: str = Field(description="The output judged; empty for what the reference derives.")
    help: str
    quantity: Literal["display", "radiance", "normal", "depth", "share", "identity", "scalar"]
    ideal: bool = Field(
        description="Whether the truth is what the technique approximates, not what its algorithm gives."
    )
    metrics: dict[str, Number | None] = Field(
        description="All of the quantity's; null: nothing to compare, or PSNR of equals."
    )
    metric: str
    unit: str
    value: Number | None
    tolerance: float = Field(ge=0)
    verdict: Literal["within", "above", "cannot_judge"]
    reason: Literal["", "not_finite", "standard_error", "all_masked", "z_test"]
    masked: Share = Field(description="Texels whose truth is not known.")
    standard_error: Amount = Field(description="The truth's own error at 3 sigma, in terms of the metric.")
    worst_texel: WorstTexelRecord | None
    z_test: ZTestRecord | None


class PassAccuracyRecord(Part):
    """A pass: what it takes, and how far off it is."""

    name: str
    node: str
    ms: Milliseconds | None = Field(description="Median, as in timing.json.")
    bytes: Bytes = Field(description="Of the resources that it is the first to use.")
    method: Literal["", "analytic", "float64", "rays", "brute_force"]
    source: str
    reason: str = Field(description="Why it was not judged; empty where it was.")
    reference_ms: Milliseconds = Field(description="What its reference took when it ran.")
    cached: bool = Field(description="Whether that was spared now.")
    broken: list[str] = Field(description="Invariants that do not hold.")
    measures: list[MeasureRecord]


class JudgedDeviceRecord(Part):
    """Who ran it."""

    renderer: str
    version: str
    driver: str


class VerdictsRecord(Part):
    """How many measures have each verdict."""

    within: Count
    above: Count
    cannot_judge: Count


class AccuracyRecord(Head):
    """How far each pass is from its truth, beside its time and bytes."""

    version: Literal["rendergraph.accuracy/1"] = Field(alias="schema")
    device: JudgedDeviceRecord
    frame: Count = Field(description="Index of the frame judged.")
    seed: Count
    verdicts: VerdictsRecord
    passes: list[PassAccuracyRecord] = Field(description="In execution order; then those that did not run.")
