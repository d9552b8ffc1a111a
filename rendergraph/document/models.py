"""The graph file, as pydantic models: names, types, ranges, units, defaults and help of everything outside ``set:``.

Shapes only: what needs other passes, node ports or the disk is checked by ``node_checks.py`` and
``rendergraph.plan.expand``. Validators raise ``mistake(...)``, which names the key to point at, or a row of the message
table by its code.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, JsonValue, model_validator
from pydantic_core import PydanticCustomError

from rendergraph.document.field_types import Extent, FormatName, Model, Name, NotBoolean, ResourceName, mistake
from rendergraph.document.output_files import OutputFile, find_clash
from rendergraph.document.scene_models import SceneModel

MAX_FRAMES = 10000


class FrameModel(Model):
    """The frame: size, how many, seed, depth convention."""

    size: tuple[Extent, Extent] = Field(
        (1280, 720), description="Width and height of the frame.", json_schema_extra={"unit": "pixels"}
    )
    count: int = Field(1, ge=1, le=MAX_FRAMES, description="Frames to render.")
    seed: int = Field(0, ge=0, le=2**32 - 1, description="Seed of everything random in the graph.")
    depth: Literal["reversed", "standard"] = Field(
        "reversed", description="Depth convention: reversed (1 near, 0 far; more precise) or standard (0 near, 1 far)."
    )


def _required(*keys: str) -> dict[str, JsonValue]:
    return {"required": [*keys]}


#: ``ResourceModel._one_kind`` as far as a JSON Schema can say it.
_KINDS: dict[str, JsonValue] = {
    "oneOf": [
        _required("bytes"),
        _required("previous"),
        _required("file"),
        {"anyOf": [_required("format"), _required("like")], "not": _required("file")},
    ]
}


class ResourceModel(Model):
    """A resource: a texture (format and size), a buffer (bytes), last frame's content (previous), or a file's."""

    model_config = ConfigDict(json_schema_extra=_KINDS)

    format: FormatName | None = Field(None, description="Texture format.")
    scale: float | None = Field(None, gt=0, le=16, description="Size as a multiple of the frame's, or of `like`'s.")
    like: Name | None = Field(None, description="Another texture whose size (and format, unless given) this one has.")
    fixed: tuple[Extent, Extent] | None = Field(
        None, description="Size, whatever the frame's.", json_schema_extra={"unit": "texels"}
    )
    layers: int = Field(1, ge=1, le=2048, description="Array layers.")
    mips: int = Field(1, ge=0, le=15, description="Mip levels; 0 for the whole chain.")
    samples: Annotated[Literal[1, 2, 4, 8], NotBoolean] = Field(1, description="Samples a texel.")
    bytes: int | None = Field(
        None, ge=4, le=2**31 - 1, multiple_of=4, description="Size of a buffer.", json_schema_extra={"unit": "bytes"}
    )
    previous: Name | None = Field(None, description="The resource whose last frame's content this is.")
    file: str | None = Field(None, min_length=1, description="An image file (.png, .jpg, .hdr) relative to this file.")

    @model_validator(mode="after")
    def _one_kind(self) -> ResourceModel:
        given = {key for key in self.model_fields_set if getattr(self, key) is not None}
        kind = next((key for key in ("previous", "file", "bytes") if key in given), None)
        if kind is not None:
            _exclusive(
                kind, sorted(given - {"previous": set(), "file": {"format", "mips"}, "bytes": set()}[kind] - {kind})
            )
        elif "fixed" in given:
            _exclusive("fixed", sorted(given & {"like", "scale"}))
        if kind is None and not given & {"format", "like"}:
            raise PydanticCustomError("RG302", "no format", {"key": ""})
        if self.samples > 1 and self.mips != 1:
            raise PydanticCustomError("RG309", "multisampled with mips", {"key": "mips"})
        return self


def _exclusive(first: str, others: list[str]) -> None:
    if others:
        raise PydanticCustomError("RG301", "exclusive", {"first": first, "second": others[0], "key": others[0]})


class PassModel(Model):
    """One use of a node."""

    node: str = Field(..., min_length=1, description="The node's name; `rg nodes` lists them.")
    read: dict[str, ResourceName] = Field(default_factory=dict, description="Input port to resource.")
    write: dict[str, ResourceName] = Field(default_factory=dict, description="Output port to resource.")
    set: dict[str, Any] = Field(default_factory=dict, description="The node's parameters.")
    after: tuple[Name, ...] = Field((), description="Passes that must run before this one.")
    keep: bool = Field(False, description="Run even if nothing reads what it writes.")


BarrierKind = Literal[
    "shader_storage", "shader_image", "texture_fetch", "uniform", "command", "vertex_attrib", "element_array",
    "buffer_update", "texture_update", "framebuffer", "texture_barrier",
]  # fmt: skip


class BarrierModel(Model):
    """A memory barrier the author says is needed; compared with what the planner derives."""

    resource: ResourceName = Field(..., description="The resource protected.")
    after: ResourceName = Field(..., description="The pass or sub-pass (`pass.step`) that wrote it.")
    before: ResourceName = Field(..., description="The pass or sub-pass that uses it next.")
    kind: BarrierKind = Field(..., description="How it is used next: a bit of glMemoryBarrier, or texture_barrier.")


class OutputModel(Model):
    """A file written from a resource after the last frame (or every frame, when the name holds `{frame}`)."""

    file: OutputFile = Field(
        ..., min_length=1, max_length=200, description="File name inside the output folder; .png, .exr or .npy."
    )
    format: FormatName | None = Field(None, description="Format, when the resource is not declared.")


PassMilliseconds = Annotated[float, Field(gt=0)]
PassError = Annotated[float, Field(ge=0)]


class BudgetModel(Model):
    """Limits that fail the run."""

    frame_ms: float | None = Field(None, gt=0, description="Time of a frame.", json_schema_extra={"unit": "ms"})
    transient_mib: float | None = Field(
        None, gt=0, description="Memory of transient resources.", json_schema_extra={"unit": "MiB"}
    )
    passes: dict[Name, PassMilliseconds] = Field(
        default_factory=dict,
        description="Time of single passes, by name; each above 0.",
        json_schema_extra={"unit": "ms"},
    )
    draws: int | None = Field(None, ge=0, description="Draws a frame; each draw of a multi-draw counts.")
    error: dict[Name, PassError] = Field(
        default_factory=dict,
        description="Error of single passes, by name, in the metric that the node states; checked by `rg render "
        "--reference` and `rg bench`.",
    )
    flip: float | None = Field(
        None,
        ge=0,
        le=1,
        description="Mean FLIP error of output images against their truth; checked by `rg render "
        "--reference` and `rg bench`.",
    )


class DocumentModel(Model):
    """A graph file: which passes run, on which resources, and what is written out."""

    rendergraph: Annotated[Literal[1], NotBoolean] = Field(..., description="Version of the language.")
    title: str = Field("", max_length=200, description="What the graph shows.")
    frame: FrameModel = Field(default_factory=lambda: FrameModel(), description="The frame.")
    scene: SceneModel | None = Field(None, description="What is drawn.")
    resources: dict[Name, ResourceModel] = Field(default_factory=dict, description="Named textures and buffers.")
    passes: dict[Name, PassModel] = Field(..., min_length=1, description="The passes, in any order.")
    barriers: tuple[BarrierModel, ...] | None = Field(
        None, description="Barriers by the author, checked against the derived ones; without this key all are derived."
    )
    outputs: dict[ResourceName, OutputModel] = Field(..., min_length=1, description="Resources written to files.")
    budget: BudgetModel = Field(
        default_factory=lambda: BudgetModel(), description="Limits; a run that exceeds one fails."
    )

    @model_validator(mode="after")
    def _distinct_files(self) -> DocumentModel:
        clash = find_clash({name: output.file for name, output in self.outputs.items()})
        if clash is not None:
            _, name, problem = clash
            raise mistake(problem, "give each output a file of its own", f"outputs/{name}/file")
        return self
