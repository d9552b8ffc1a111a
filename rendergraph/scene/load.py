"""The scene a document asks for: geometry by name or file, then its camera and lights."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.scene_models import CameraModel, LightsModel, PointsModel, SceneModel, SpotModel, SunModel
from rendergraph.document.suggest import did_you_mean
from rendergraph.plan.graph import Position
from rendergraph.scene import procedural
from rendergraph.scene.cameras import frame_scene
from rendergraph.scene.scatter import scatter_lights
from rendergraph.scene.scene import F64, Ambient, Camera, Light, Scene, Sun
from rendergraph.scene.source import source_problem

#: Lights of a scene that has none, so that its picture is not black.
_DEFAULT_SUN = Sun((-0.36, -0.89, -0.28), (4.5, 4.3, 4.0))
_DEFAULT_AMBIENT = Ambient((0.28, 0.33, 0.40), (0.16, 0.15, 0.14))
#: Where scattered lights of shipped scenes go, metres: inside the walls.
_LIGHT_VOLUMES = {
    "atrium": ((-12.6, 0.4, -6.6), (12.6, 8.2, 6.6)),
    "cornell": ((-2.5, 0.3, -2.5), (2.5, 5.2, 2.5)),
}


@dataclass(frozen=True, slots=True)
class LoadedScene:
    """A scene ready to render: its lights are final; ``camera`` is the one to use, not one of ``scene.cameras``.

    ``orbit_turns``: turns of the camera around its target over the run's frames; ``notes`` tell what was filled in
    (severity ``note``). ``hidden`` are the nodes and materials left out of it, by name; ``own`` the lights it came
    with. ``whole`` is the scene before any change (``None``: this one).
    """

    scene: Scene
    camera: Camera
    orbit_turns: float = 0.0
    notes: tuple[Diagnostic, ...] = ()
    hidden: frozenset[str] = frozenset()
    own: OwnLights | None = None
    whole: LoadedScene | None = None


@dataclass(frozen=True, slots=True)
class OwnLights:
    """The lights of a scene's file, before the graph's."""

    lights: tuple[Light, ...]
    sun: Sun | None
    ambient: Ambient | None


def load_scene(
    model: SceneModel,
    folder: Path,
    *,
    frame_seed: int,
    source_override: str | None = None,
    position: Position | None = None,
    camera_position: Position | None = None,
    keep_camera: bool = False,
) -> LoadedScene:
    """Load ``model.source``: a shipped scene's name, or a glTF file relative to ``folder``.

    ``source_override`` replaces it and is relative to the working directory; where it names another scene, the model's
    camera placement, which was made for the first one, is left out unless ``keep_camera``. ``frame_seed`` seeds what
    the model does not seed itself. ``position`` is where the source is written, ``camera_position`` the camera.
    ``RenderGraphError`` RG650 for an unknown source, RG651 for an unreadable path, RG652 for an unknown camera, RG653
    for a camera that looks nowhere, and what ``load_gltf`` raises.
    """
    source = source_override if source_override is not None else model.source
    notes: list[Diagnostic] = []
    camera_model = model.camera
    moved = source != model.source and not keep_camera
    if moved and {"name", "position", "target", "up", "near", "far"} & camera_model.model_fields_set:
        camera_model = CameraModel(**camera_model.model_dump(include={"fov", "orbit"}, exclude_unset=True))
        notes.append(diagnose("RG655", camera_position, source=model.source, override=source))
    scene_seed = model.seed if "seed" in model.model_fields_set else frame_seed
    root, base = (folder, "the graph file") if source_override is None else (Path(), "the working directory")
    problem = source_problem(source, root, position, base=base)
    if problem is not None:
        raise RenderGraphError([problem], exit_code=1 if source_override is None else 2)
    scene = _geometry(source, root, detail=model.detail, seed=scene_seed)
    if not scene.instances:
        notes.append(diagnose("RG656", position, source=source))
    own = OwnLights(tuple(scene.lights), scene.sun, scene.ambient)
    notes += apply_lights(scene, model.lights, frame_seed, position)
    camera = place_camera(scene, camera_model, camera_position or position)
    orbit_turns = camera_model.orbit.turns if camera_model.orbit is not None else 0.0
    return LoadedScene(scene, camera, orbit_turns, tuple(notes), own=own)


def _geometry(source: str, root: Path, *, detail: float, seed: int) -> Scene:
    if source in procedural.SHIPPED:
        return procedural.build(source, detail=detail, seed=seed)
    from rendergraph.scene.gltf import load_gltf

    return load_gltf(root / source)


# ---------------------------------------------------------------- camera


def place_camera(scene: Scene, model: CameraModel, position: Position | None) -> Camera:
    """The model's camera: placed, by name, the scene's first, or one that frames the bounds; in this order."""
    if model.name is not None:
        base = next((c for c in scene.cameras if model.name in (c.name, c.node)), None)
        if base is None:
            hint = did_you_mean(model.name, [c.name for c in scene.cameras if c.name])
            raise RenderGraphError([diagnose("RG652", position, name=model.name, scene=scene.name, hint=hint)])
    elif scene.cameras:
        base = scene.cameras[0]
    else:
        base = frame_scene(scene, math.radians(model.fov))
    given = model.model_fields_set
    eye = model.position or base.position
    camera = replace(base, position=eye, target=_target(scene, model, base))
    if math.dist(camera.position, camera.target) < 1e-6:
        raise RenderGraphError([diagnose("RG653", position, point=camera.position)])
    # A camera placed by hand is the model's own, defaults and all; one of the scene keeps what the model leaves open.
    whole = model.position is not None
    if whole or "up" in given:
        camera = replace(camera, up=model.up)
    if whole or "fov" in given:
        camera = replace(camera, fov=math.radians(model.fov))
    if whole or {"near", "far"} & given:
        near = model.near if whole or "near" in given else camera.near
        far = model.far if whole or "far" in given else camera.far
        camera = replace(camera, near=near, far=far if far is None or far > near else None)
    return camera


def _target(scene: Scene, model: CameraModel, base: Camera) -> tuple[float, float, float]:
    if model.target is not None:
        return model.target
    if model.position is None:
        return base.target
    low, high = scene.bounds()
    x, y, z = ((low + high) / 2.0).tolist()
    return x, y, z


# ---------------------------------------------------------------- lights


def apply_lights(scene: Scene, model: LightsModel, frame_seed: int, position: Position | None) -> list[Diagnostic]:
    """Replace the scene's lights by the model's, joined with its own where ``from_scene``.

    A scene left without any light gets a default sun and sky; one with a sun alone a default sky.
    """
    if not model.from_scene:
        scene.lights, scene.sun, scene.ambient = [], None, None
    if model.sun is not None:
        scene.sun = make_sun(model.sun)
    if model.ambient is not None:
        scene.ambient = Ambient(model.ambient.sky, model.ambient.ground)
    if model.points is not None:
        seed = model.points.seed if "seed" in model.points.model_fields_set else frame_seed
        scene.lights += _scattered(scene, model.points, seed)
    for light in model.list:
        color = _scaled(light.color, light.intensity)
        if isinstance(light, SpotModel):
            x, y, z = _unit(light.direction)
            inner, outer = math.radians(light.inner), math.radians(light.outer)
            scene.lights.append(Light(light.position, color, light.radius, (x, y, z), inner, outer))
        else:
            scene.lights.append(Light(light.position, color, light.radius))
    if scene.sun is not None and scene.ambient is None:
        scene.ambient = _DEFAULT_AMBIENT
        return [diagnose("RG657", position, scene=scene.name)]
    asked = model.model_fields_set - {"from_scene"}
    if asked or scene.lights or scene.sun is not None or scene.ambient is not None:
        return []
    scene.sun, scene.ambient = _DEFAULT_SUN, _DEFAULT_AMBIENT
    return [diagnose("RG654", position, scene=scene.name)]


def make_sun(model: SunModel) -> Sun:
    """The model's sun."""
    x, y, z = _unit(model.direction)
    return Sun((x, y, z), _scaled(model.color, model.illuminance))


def _scattered(scene: Scene, points: PointsModel, seed: int) -> list[Light]:
    low, high = light_volume(scene)
    return scatter_lights(
        points.count,
        low,
        high,
        seed=seed,
        intensity=points.intensity,
        radius=points.radius,
        cutoff=points.cutoff,
        circle=points.circle,
    )


def light_volume(scene: Scene) -> tuple[F64, F64]:
    """The box scattered lights fill, metres: within the walls of shipped rooms, else the bounds less 5 % a side."""
    if scene.name in _LIGHT_VOLUMES:
        low, high = (np.array(corner) for corner in _LIGHT_VOLUMES[scene.name])
        return low, high
    low, high = scene.bounds()
    margin = (high - low) * 0.05
    return low + margin, high - margin


def _scaled(color: tuple[float, float, float], factor: float) -> tuple[float, float, float]:
    red, green, blue = color
    return red * factor, green * factor, blue * factor


def _unit(direction: tuple[float, float, float]) -> list[float]:
    """Scaled by the largest component first, so that no square over- or underflows."""
    vector = np.asarray(direction, float)
    vector = vector / np.abs(vector).max()
    return [float(c) for c in vector / np.linalg.norm(vector)]
