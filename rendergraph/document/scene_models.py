"""The ``scene:`` section of a graph file, as pydantic models: what is drawn, the camera and the lights.

Angles are degrees, lengths metres, colours linear Rec. 709.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from rendergraph.document.field_types import Model, NonNegative, Rgb, Unit, Vec3, mistake


def _not_zero(direction: Vec3) -> Vec3:
    if not any(direction):
        raise mistake("a direction cannot be the zero vector", "give it a length; it need not be 1")
    return direction


Direction = Annotated[Vec3, AfterValidator(_not_zero)]


class OrbitModel(Model):
    """A circular path of the camera around its target."""

    turns: float = Field(1.0, description="Turns over all frames of the run.")
    axis: Literal["y"] = Field("y", description="Axis of the orbit.")


class CameraModel(Model):
    """A perspective camera: placed by position and target, or taken from the scene file by name."""

    name: str | None = Field(None, description="A camera of the scene file, by node or camera name.")
    position: Vec3 | None = Field(None, description="Where the eye is.", json_schema_extra={"unit": "m"})
    target: Vec3 | None = Field(None, description="Point looked at.", json_schema_extra={"unit": "m"})
    up: Direction = Field((0.0, 1.0, 0.0), description="Up direction.")
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
    circle: NonNegative = Field(
        0.0,
        description="Radius of the level circle that each light runs once over the frames of the run.",
        json_schema_extra={"unit": "m"},
    )


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


class ChangeModel(Model):
    """What of the scene is another from a frame on. What a change does not name stays as it was before."""

    frame: int = Field(..., ge=0, description="First frame with it.")
    lights: LightsModel | None = Field(None, description="All lights, in place of those before.")
    sun: SunModel | Literal["none"] | None = Field(None, description="The sun alone: another, or `none`.")
    hide: tuple[str, ...] | None = Field(
        None, description="Nodes and materials of the scene that are not drawn, by name; `[]` shows everything again."
    )
    camera: CameraModel | None = Field(None, description="Another camera.")

    @model_validator(mode="after")
    def _something(self) -> ChangeModel:
        if all(value is None for value in (self.lights, self.sun, self.hide, self.camera)):
            raise mistake("nothing changes", "give it lights, sun, hide or camera", "frame")
        return self


class SceneModel(Model):
    """What is drawn: a shipped procedural scene or a glTF file, a camera and lights."""

    source: str = Field(
        ..., min_length=1, description="`atrium`, `cornell`, `spheres`, or a .gltf/.glb relative to this file."
    )
    detail: Unit = Field(1.0, description="Geometric detail of a procedural scene, 0 to 1.")
    seed: int = Field(0, ge=0, le=2**32 - 1, description="Seed of a procedural scene.")
    camera: CameraModel = Field(default_factory=lambda: CameraModel(), description="The camera.")
    lights: LightsModel = Field(default_factory=lambda: LightsModel(), description="The lights.")
    changes: tuple[ChangeModel, ...] = Field((), description="What changes between frames, in order of time.")

    @model_validator(mode="after")
    def _rising(self) -> SceneModel:
        for index, (one, other) in enumerate(pairwise(self.changes)):
            if other.frame <= one.frame:
                problem = f"a change at frame {other.frame} comes after one at frame {one.frame}"
                raise mistake(problem, "list changes by frame, one a frame", f"changes/{index + 1}/frame")
        return self
