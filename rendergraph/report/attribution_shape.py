"""The shape of ``attribution.json``; :mod:`rendergraph.report.attribution` makes one."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rendergraph.report.accuracy_shape import Amount, JudgedDeviceRecord, Number
from rendergraph.report.record_shape import Bytes, Count, Head, Milliseconds, Part, Share


class ContributionRecord(Part):
    """An approximate pass: the error that comes from it, and what it takes."""

    name: str
    node: str
    how: Literal["truth", "setting"] = Field(description="What it was replaced by.")
    by: list[str] = Field(description="Measures whose truth stood in, or settings as --set takes them.")
    removed: Number = Field(description="By how much the error falls when it alone is replaced; may be negative.")
    left: Amount = Field(description="The error when it alone is not replaced.")
    share: Share = Field(description="Of the errors left, over all passes.")
    ms: Milliseconds = Field(description="Median of a frame.")
    ms_share: Share
    bytes: Bytes = Field(description="Of the resources that it is the first to use.")
    error_per_ms: Amount


class OtherPassRecord(Part):
    """A pass that nothing is attributed to."""

    name: str
    reason: str


class AttributionRecord(Head):
    """Which pass the final image's error comes from, beside what each costs."""

    version: Literal["rendergraph.attribution/1"] = Field(alias="schema")
    graph: str
    set: list[str] = Field(description="The settings it ran under, as --set takes them.")
    device: JudgedDeviceRecord
    output: str
    quantity: Literal["display", "radiance", "normal", "depth", "share", "identity", "scalar"]
    metric: str
    frame: Count
    error: Amount = Field(description="Of the image as it is, against the one with all these passes replaced.")
    frame_ms: Milliseconds
    passes: list[ContributionRecord] = Field(description="First where a millisecond buys most.")
    others: list[OtherPassRecord] = Field(description="To which nothing is attributed.")
