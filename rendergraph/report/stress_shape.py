"""The shape of the stress record; :mod:`rendergraph.report.stress` makes one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rendergraph.report.accuracy_shape import Number
from rendergraph.report.record_shape import Count, Head, Part, Size

Check = Literal["finite", "bounded", "energy", "invariants", "error"]
Seconds = Annotated[float, Field(ge=0, json_schema_extra={"unit": "s"})]


class BadTexelRecord(Part):
    """The first texel that fails, or the one that is furthest off."""

    port: str
    x: Count = Field(description="From the left.")
    y: Count = Field(description="From the bottom.")
    layer: Count
    value: list[Number]
    inputs: dict[str, list[Number]] = Field(
        description="What the inputs hold there, by port; `PORT before` of outputs that are modified; `truth`."
    )


class StressFailureRecord(Part):
    """A check that a pass fails."""

    check: Check
    text: str
    texel: BadTexelRecord | None


class SkippedCheckRecord(Part):
    """A check that was left out."""

    check: Check
    reason: str


class StressedPassRecord(Part):
    """A pass at an extreme."""

    name: str
    node: str
    status: Literal["pass", "fail", "inherited", "not_run"] = Field(
        description="inherited: it fails on inputs that were not finite before it ran."
    )
    failures: list[StressFailureRecord]
    skipped: list[SkippedCheckRecord]
    reason: str = Field(description="Why it was not checked; empty where it was.")


class ExtremeRecord(Part):
    """One extreme."""

    name: str
    help: str
    common: bool = Field(description="Tried on every graph; else a node's own.")
    state: Literal["ran", "refused", "not_refused", "not_applicable", "failed", "crashed", "timed_out"]
    failed: bool
    size: Size
    seconds: Seconds
    code: str = Field(description="Of the refusal or error that ended it.")
    text: str = Field(description="What ended it, or why it does not apply.")
    passes: list[StressedPassRecord]


class StressDeviceRecord(Part):
    """Who ran it."""

    renderer: str
    driver: str


class StressCountsRecord(Part):
    """How many extremes there are, and of them those that failed, were refused as declared, or do not apply."""

    extremes: Count
    failed: Count
    refused: Count
    not_applicable: Count


class StressRecord(Head):
    """What a graph, or a node on its own graph, does at the numerical extremes."""

    version: Literal["rendergraph.stress/1"] = Field(alias="schema")
    graph: str = Field(description="The graph file's name.")
    node: str = Field(description="The node that alone was looked at; empty for all passes.")
    device: StressDeviceRecord
    counts: StressCountsRecord
    extremes: list[ExtremeRecord]
