"""The shape of ``resources.json``; :mod:`rendergraph.report.resources` makes one."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from rendergraph.report.record_shape import Bytes, Count, Head, Part, Share, Size


class TotalsRecord(Part):
    """Bytes of the transient resources under five rules, and what the plan really uses."""

    unshared: Bytes = Field(description="Each resource has memory of its own.")
    exact_pool: Bytes = Field(description="Shared between resources of equal description.")
    view_pool: Bytes = Field(description="Shared within view classes.")
    placed: Bytes = Field(description="The best packing found for one heap.")
    load: Bytes = Field(description="The most bytes live at once: no sharing gets below.")
    used: Bytes = Field(description="What the plan allocates.")
    used_over_load: float | None = Field(ge=1, description="used / load; null without transient resources.")
    peak: list[str] = Field(description="The resources live where load is reached.")


class HolderRecord(Part):
    """A resource that is live at the peak."""

    name: str
    bytes: Bytes
    share: Share = Field(description="Of the peak's bytes.")


class PeakRecord(Part):
    """The first sub-pass with the most live bytes, and who holds them, largest first."""

    bytes: Bytes
    index: Count = Field(description="Into order.")
    subpass: str
    resources: list[HolderRecord]


class AdviceRecord(Part):
    """A single change that lowers the memory used; tried by planning the graph with it."""

    change: Literal["format", "scale", "fixed", "samples", "order", "alias"]
    resource: str | None = Field(description="null for a change of the plan as a whole.")
    before: str
    after: str
    used: Bytes = Field(description="What the plan would allocate.")
    load: Bytes
    saves: Annotated[int, Field(gt=0)] = Field(description="Bytes of used saved.")
    loses: str = Field(description="What it costs.")
    option: str = Field(description="What to add to the command line to try it.")
    why: str = Field(description="All of it in a sentence.")


class TextureRecord(Part):
    """An immutable texture."""

    format: str
    size: Size
    layers: Annotated[int, Field(ge=1)]
    mips: Annotated[int, Field(ge=1)]
    samples: Annotated[int, Field(ge=1)]
    target: Literal["2d", "2d_array", "cube", "cube_array", "3d"]


class BufferRecord(Part):
    """A range of buffer memory."""

    buffer: Bytes


class SharingRecord(Part):
    """Why a resource shares memory, or does not: a stable reason and a sentence."""

    reason: str
    why: str


class ResourceRecord(Part):
    """A resource: what it is, when it lives, where, and beside whom."""

    name: str
    kind: Literal["transient", "persistent", "history", "imported"]
    declared: bool = Field(description="False for a node's internal target.")
    bytes: Bytes
    desc: TextureRecord | BufferRecord
    first: str = Field(description="The sub-pass that uses it first.")
    last: str = Field(description="The sub-pass that uses it last.")
    first_index: Count
    last_index: Count
    shares_with: list[str] = Field(description="Who uses the same memory at other times.")
    sharing: SharingRecord | None
    slot: Count = Field(default=0, description="Index into slots; only transient textures have one.")
    offset: Bytes = Field(default=0, description="Into the buffer heap; only transient buffers have one.")
    view_class: str = Field(default="", description="Only textures have one.")


class SlotRecord(Part):
    """Texture storage that its tenants use one after another."""

    index: Count
    desc: TextureRecord
    bytes: Bytes
    tenants: Annotated[list[str], Field(min_length=1)]


class HazardRecord(Part):
    """Two accesses that a barrier stands between."""

    resource: str = Field(description="What the later sub-pass uses.")
    previous_resource: str = Field(description="What the earlier one used: another where they share memory.")
    earlier: str
    later: str
    kind: str


class BarrierReasonRecord(Part):
    """Why one kind of barrier is there."""

    kind: str
    reason: Literal["incoherent_access", "shared_storage", "feedback_loop"]
    why: str


class BarrierRecord(Part):
    """A call of glMemoryBarrier and/or glTextureBarrier before a sub-pass."""

    before: str
    index: Count = Field(description="Into order.")
    bits: Count
    names: list[str] = Field(description="The bits by their OpenGL names.")
    texture_barrier: bool
    reasons: Annotated[list[BarrierReasonRecord], Field(min_length=1)]
    hazards: Annotated[list[HazardRecord], Field(min_length=1)]


class CreatedRecord(Part):
    """GL objects created in the frames after the first: none, in a steady state."""

    frames: Count = Field(description="Frames that were watched; 0 for a plan that was not run.")
    objects: Count
    per_frame: float | None = Field(ge=0, description="null when no frame was watched.")


class DecisionRecord(Part):
    """Something the planner decided, and the evidence."""

    kind: str
    reason: str
    subject: str
    evidence: dict[str, Any]


class ResourcesRecord(Head):
    """Where every resource of a plan lives, when, beside whom and why; and the barriers. Exact."""

    version: Literal["rendergraph.resources/1"] = Field(alias="schema")
    order: list[str] = Field(description="The sub-passes, as they run.")
    culled: list[str] = Field(description="Sub-passes that do not run.")
    totals: TotalsRecord
    live_bytes: list[Bytes] = Field(description="Transient bytes live in each sub-pass of order.")
    peak: PeakRecord | None
    advice: list[AdviceRecord] = Field(description="What would lower the memory used, what saves most first.")
    resources: list[ResourceRecord]
    slots: list[SlotRecord]
    heap_bytes: Bytes = Field(description="Size of the heap that transient buffers share.")
    barriers: list[BarrierRecord]
    objects_created: CreatedRecord
    decisions: list[DecisionRecord]
