"""What ``rg diff`` needs of the records, as pydantic models; what else they hold is passed over.

A record may come from anywhere: everything is checked here, once, and nothing is guessed.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from rendergraph.document.field_types import mistake


class _Part(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


#: Text without control characters: what is printed cannot move the cursor or pass for a command of CI.
Label = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*$", max_length=500)]
Milliseconds = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Samples = list[Milliseconds]
Count = Annotated[int, Field(ge=0)]
Size = Annotated[list[Count], Field(min_length=2, max_length=2)]


class SampledModel(_Part):
    """Raw samples, in milliseconds, in order of time."""

    samples: Samples = []


class ClockModel(_Part):
    """The clock the times were read from."""

    name: Label


class DeviceModel(_Part):
    """Who ran it."""

    renderer: Label
    version: Label = ""
    driver: Label = ""
    cpu: Label = ""
    threads: int | None = None


class StepModel(_Part):
    """A sub-pass with its times and exact counts; ``None`` for a count that only the device knows."""

    name: Label
    ms: SampledModel = SampledModel()
    counters: dict[Label, Count | None] = {}


class PassModel(StepModel):
    """A pass, the same of all its sub-passes together."""

    node: Label = ""
    subpasses: list[StepModel] = []


class BoundModel(_Part):
    """What a frame is bound by, and the share of rounds that alone say so."""

    bound_by: Label = Field(alias="class")
    agreement: Annotated[float, Field(ge=0, le=1)]


class DescModel(_Part):
    """A resource's shape: of a texture, or a buffer's bytes."""

    format: Label = ""
    size: list[Count] = []
    layers: Count = 1
    mips: Count = 1
    samples: Count = 1
    target: Label = ""
    buffer: Count | None = None


class ResourceModel(_Part):
    """A resource, its shape and where it lives."""

    name: Label
    kind: Label
    bytes: Count
    desc: DescModel
    first: Label
    last: Label
    slot: int | None = None


class SlotModel(_Part):
    """Memory that resources share."""

    bytes: Count


class HazardModel(_Part):
    """Why a barrier is there."""

    resource: Label


class BarrierModel(_Part):
    """A barrier: ``glMemoryBarrier`` bits before a sub-pass."""

    before: Label
    bits: Count
    texture_barrier: bool
    names: list[Label] = []
    hazards: list[HazardModel] = []


class ResourcesRecord(_Part):
    """``resources.json``, schema ``rendergraph.resources/1``."""

    size: Size
    order: list[Label]
    culled: list[Label]
    totals: dict[str, Any]
    resources: list[ResourceModel]
    slots: list[SlotModel]
    heap_bytes: Count = 0
    barriers: list[BarrierModel]

    @model_validator(mode="after")
    def _whole(self) -> ResourcesRecord:
        for name in TOTALS:
            total = self.totals.get(name)
            if isinstance(total, bool) or not isinstance(total, int) or total < 0:
                raise mistake(f"totals.{name} is {total!r}, not a number of bytes", "write the record again")
        _refuse_twins([resource.name for resource in self.resources])
        _refuse_twins(self.order)
        return self


#: The totals of a resources record that are compared, most important first.
TOTALS = ("used", "load", "placed", "view_pool", "exact_pool", "unshared")


class TimingRecord(_Part):
    """``timing.json``, schema ``rendergraph.timing/1``, and a side of a bench file."""

    clock: ClockModel
    device: DeviceModel
    size: Size
    frame_ms: SampledModel = SampledModel()
    passes: list[PassModel]
    steady_state: dict[Label, Count] = {}
    resources: ResourcesRecord | None = None
    bound: BoundModel | None = None

    @model_validator(mode="after")
    def _no_twins(self) -> TimingRecord:
        _refuse_twins([entry.name for entry in self.passes])
        _refuse_twins([step.name for entry in self.passes for step in entry.subpasses])
        return self


#: An error: a number, one that JSON has not by name, or nothing where there was nothing to compare.
Error = Annotated[float, Field(allow_inf_nan=False)] | Literal["inf", "-inf", "nan"] | None


class MeasureModel(_Part):
    """What a reference judged, by its metric."""

    name: Label
    metric: Label
    value: Error
    tolerance: Annotated[float, Field(allow_inf_nan=False)]
    verdict: Literal["within", "above", "cannot_judge"]
    z_test: dict[str, Any] | None = None


class PassErrorsModel(_Part):
    """A pass, held against its reference."""

    name: Label
    node: Label = ""
    broken: list[str] = []
    measures: list[MeasureModel]

    @model_validator(mode="after")
    def _no_twins(self) -> PassErrorsModel:
        _refuse_twins([measure.name for measure in self.measures])
        return self


class JudgedDeviceModel(_Part):
    """Who ran what was judged."""

    renderer: Label
    driver: Label


class AccuracyRecord(_Part):
    """``accuracy.json``, schema ``rendergraph.accuracy/1``."""

    size: Size
    device: JudgedDeviceModel
    passes: list[PassErrorsModel]

    @model_validator(mode="after")
    def _no_twins(self) -> AccuracyRecord:
        _refuse_twins([entry.name for entry in self.passes])
        return self


class BlockSideModel(_Part):
    """Consecutive frames of one side: whole frames, each pass and each sub-pass."""

    frame_ms: Samples = []
    passes: dict[Label, Samples] = {}
    subpasses: dict[Label, Samples] = {}


class BlockModel(_Part):
    """One block: both sides measured next to each other in one process."""

    process: int
    A: BlockSideModel
    B: BlockSideModel | None = None


class BenchRecord(_Part):
    """A bench file, schema ``rendergraph.bench/1``."""

    sides: dict[str, TimingRecord]
    blocks: list[BlockModel]
    bound: dict[str, BoundModel] = {}

    @model_validator(mode="after")
    def _sides_fit(self) -> BenchRecord:
        if set(self.sides) not in ({"A"}, {"A", "B"}):
            raise mistake(f"sides are {sorted(self.sides)}, not A, or A and B", "write the record again")
        for number, block in enumerate(self.blocks):
            if (block.B is not None) != ("B" in self.sides):
                raise mistake(f"block {number} does not have the sides of the file", "write the record again")
            for name in self.sides:
                side: BlockSideModel = getattr(block, name)
                passes = self.sides[name].passes
                strangers = set(side.passes) - {entry.name for entry in passes}
                strangers |= set(side.subpasses) - {step.name for entry in passes for step in entry.subpasses}
                if strangers:
                    raise mistake(f"block {number} times '{min(strangers)}', no pass of side {name}", "measure again")
        return self


def _refuse_twins(names: list[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise mistake(f"'{name}' is there twice", "write the record again")
        seen.add(name)
