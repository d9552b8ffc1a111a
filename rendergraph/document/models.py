"""The graph file, as pydantic models: names, types, ranges, units, defaults and help of everything outside ``set:``.

Shapes only: what needs other passes, node ports or the disk is checked by ``node_checks.py`` and
``rendergraph.plan.expand``. Angles are degrees, lengths metres, colours linear Rec. 709.

Validators raise ``mistake(...)``, which names the key to point at, or a row of the message table by its code.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    JsonValue,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

from rendergraph.document.formats import FORMATS
from rendergraph.document.suggest import did_you_mean

MAX_SIZE = 16384
MAX_FRAMES = 10000

IMAGE_SUFFIXES = (".png", ".exr", ".npy")


def mistake(problem: str, hint: str, key: str = "") -> PydanticCustomError:
    """A validator's error with a help line of its own; ``key`` is the key of the model to point at."""
    return PydanticCustomError("mistake", "{problem}", {"problem": problem, "hint": hint, "key": key})


def _known_format(name: str) -> str:
    if name not in FORMATS:
        raise PydanticCustomError("RG303", "unknown format", {"format": name, "hint": did_you_mean(name, FORMATS)})
    return name


def _not_boolean(value: Any) -> Any:
    if isinstance(value, bool):
        raise PydanticCustomError("int_type", "not a number")
    return value


#: ``Literal[1]`` alone would take ``true``, which equals 1 in Python.
_NotBoolean = BeforeValidator(_not_boolean)

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=64)]
#: A resource, or a node's internal one: ``light.histogram``.
ResourceName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$", max_length=130)]
Extent = Annotated[int, Field(ge=1, le=MAX_SIZE)]
Vec3 = tuple[float, float, float]
Unit = Annotated[float, Field(ge=0, le=1)]
NonNegative = Annotated[float, Field(ge=0)]
Rgb = tuple[NonNegative, NonNegative, NonNegative]
FormatName = Annotated[str, AfterValidator(_known_format), Field(json_schema_extra={"enum": [*sorted(FORMATS)]})]


class Model(BaseModel):
    """Base of the file's models: no unknown keys, no infinities, frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


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


class OrbitModel(Model):
    """A circular path of the camera around its target."""

    turns: float = Field(1.0, description="Turns over all frames of the run.")
    axis: Literal["y"] = Field("y", description="Axis of the orbit.")


class CameraModel(Model):
    """A perspective camera: placed by position and target, or taken from the scene file by name."""

    name: str | None = Field(None, description="A camera of the scene file, by node or camera name.")
    position: Vec3 | None = Field(None, description="Where the eye is.", json_schema_extra={"unit": "m"})
    target: Vec3 | None = Field(None, description="Point looked at.", json_schema_extra={"unit": "m"})
    up: Vec3 = Field((0.0, 1.0, 0.0), description="Up direction.")
    fov: float = Field(60.0, gt=0, lt=180, description="Vertical field of view.", json_schema_extra={"unit": "degrees"})
    near: float = Field(0.05, gt=0, description="Near plane distance.", json_schema_extra={"unit": "m"})
    far: float | None = Field(
        None, gt=0, description="Far plane distance; none for infinity.", json_schema_extra={"unit": "m"}
    )
    orbit: OrbitModel | None = Field(None, description="Move on a circle around the target.")

    @model_validator(mode="after")
    def _consistent(self) -> CameraModel:
        if self.far is not None and self.far <= self.near:
            raise mistake(
                f"far ({self.far:g} m) is not beyond near ({self.near:g} m)", "raise far or lower near", "far"
            )
        if self.position is not None and self.position == self.target:
            raise mistake("position and target are the same point", "move one of them", "target")
        return self


def _not_zero(direction: Vec3) -> Vec3:
    if not any(direction):
        raise mistake("a direction cannot be the zero vector", "give it a length; it need not be 1")
    return direction


Direction = Annotated[Vec3, AfterValidator(_not_zero)]


class SunModel(Model):
    """A directional light."""

    direction: Direction = Field((-0.4, -1.0, -0.3), description="Direction the light travels; need not be normalised.")
    illuminance: NonNegative = Field(5.0, description="Irradiance on a facing surface, in scene-linear units.")
    color: Rgb = Field((1.0, 0.96, 0.9), description="Linear colour.")


class AmbientModel(Model):
    """A hemisphere of constant light: sky above, ground below."""

    sky: Rgb = Field((0.10, 0.13, 0.18), description="Radiance from above.")
    ground: Rgb = Field((0.06, 0.055, 0.05), description="Radiance from below.")


class PointsModel(Model):
    """Point lights scattered over the scene's bounds by the seed."""

    count: int = Field(..., ge=0, le=65536, description="Number of lights.")
    seed: int = Field(0, ge=0, le=2**32 - 1, description="Seed of positions and colours.")
    intensity: NonNegative = Field(1.0, description="Radiant intensity of each light.")
    radius: float | None = Field(
        None, gt=0, description="Reach; none: where the light falls below `cutoff`.", json_schema_extra={"unit": "m"}
    )
    cutoff: float = Field(0.02, gt=0, description="Irradiance below which a light without `radius` ends.")


class PointModel(Model):
    """One point light."""

    position: Vec3 = Field(..., description="Position.", json_schema_extra={"unit": "m"})
    color: Rgb = Field((1.0, 1.0, 1.0), description="Linear colour.")
    intensity: NonNegative = Field(1.0, description="Radiant intensity.")
    radius: float = Field(5.0, gt=0, description="Reach: exactly dark beyond.", json_schema_extra={"unit": "m"})


class SpotModel(PointModel):
    """One spot light."""

    direction: Direction = Field((0.0, -1.0, 0.0), description="Axis of the cone.")
    inner: float = Field(
        20.0, ge=0, lt=90, description="Half angle of full brightness.", json_schema_extra={"unit": "degrees"}
    )
    outer: float = Field(
        30.0,
        gt=0,
        lt=90,
        description="Half angle beyond which it is exactly dark.",
        json_schema_extra={"unit": "degrees"},
    )

    @model_validator(mode="after")
    def _cone(self) -> SpotModel:
        if self.inner > self.outer:
            problem = f"inner ({self.inner:g} degrees) exceeds outer ({self.outer:g})"
            raise mistake(problem, "inner is the half angle of full brightness, outer the one of darkness", "inner")
        return self


def _light_kind(light: Any) -> str:
    keys = light if isinstance(light, dict) else ()
    return "spot" if isinstance(light, SpotModel) or {"direction", "inner", "outer"} & {*keys} else "point"


LightModel = Annotated[
    Annotated[PointModel, Tag("point")] | Annotated[SpotModel, Tag("spot")], Discriminator(_light_kind)
]


class LightsModel(Model):
    """All lights beside those in the scene file."""

    sun: SunModel | None = Field(None, description="A directional light.")
    ambient: AmbientModel | None = Field(None, description="A constant hemisphere.")
    points: PointsModel | None = Field(None, description="Scattered point lights.")
    list: tuple[LightModel, ...] = Field(
        (), description="Point and spot lights one by one; one with a direction, inner or outer angle is a spot."
    )
    from_scene: bool = Field(True, description="Use the lights of the scene file or procedural scene too.")


class SceneModel(Model):
    """What is drawn: a shipped procedural scene or a glTF file, a camera and lights."""

    source: str = Field(
        ..., min_length=1, description="`atrium`, `cornell`, `spheres`, or a .gltf/.glb relative to this file."
    )
    detail: Unit = Field(1.0, description="Geometric detail of a procedural scene, 0 to 1.")
    seed: int = Field(0, ge=0, le=2**32 - 1, description="Seed of a procedural scene.")
    camera: CameraModel = Field(default_factory=lambda: CameraModel(), description="The camera.")
    lights: LightsModel = Field(default_factory=lambda: LightsModel(), description="The lights.")


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
    samples: Annotated[Literal[1, 2, 4, 8], _NotBoolean] = Field(1, description="Samples a texel.")
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


def _output_file(name: str) -> str:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or "\\" in name or "\0" in name:
        raise mistake(f"'{name}' does not stay inside the output folder", "give a relative path without `..`")
    if path.suffix.lower() not in IMAGE_SUFFIXES:
        raise mistake(f"'{name}' has no known image suffix", f"end the name in {', '.join(IMAGE_SUFFIXES)}")
    return name


class OutputModel(Model):
    """A file written from a resource after the last frame (or every frame, when the name holds `{frame}`)."""

    file: Annotated[str, AfterValidator(_output_file)] = Field(
        ..., min_length=1, max_length=200, description="File name inside the output folder; .png, .exr or .npy."
    )
    format: FormatName | None = Field(None, description="Format, when the resource is not declared.")


class BudgetModel(Model):
    """Limits that fail the run."""

    frame_ms: float | None = Field(None, gt=0, description="Time of a frame.", json_schema_extra={"unit": "ms"})
    transient_mib: float | None = Field(
        None, gt=0, description="Memory of transient resources.", json_schema_extra={"unit": "MiB"}
    )
    draws: int | None = Field(None, ge=0, description="Draw calls a frame.")
    flip: float | None = Field(None, ge=0, le=1, description="Mean FLIP error of the image against its reference.")


class DocumentModel(Model):
    """A graph file: which passes run, on which resources, and what is written out."""

    rendergraph: Annotated[Literal[1], _NotBoolean] = Field(..., description="Version of the language.")
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
        writers: dict[str, str] = {}
        for name, output in self.outputs.items():
            first = writers.setdefault(output.file, name)
            if first != name:
                problem = f"outputs '{first}' and '{name}' both write {output.file}"
                raise mistake(problem, "give each output a file of its own", f"outputs/{name}/file")
        return self
