"""A scene in its states: what is drawn, its lights and its camera, as changes between frames leave them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.scene_models import CameraModel, ChangeModel, LightsModel, SunModel
from rendergraph.document.suggest import did_you_mean
from rendergraph.plan.graph import Position
from rendergraph.scene.load import LoadedScene, apply_lights, make_sun, place_camera
from rendergraph.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class SceneState:
    """What changes have asked for so far; ``None`` where nothing did. A ``sun`` stands over that of ``lights``."""

    lights: LightsModel | None = None
    sun: SunModel | Literal["none"] | None = None
    hide: tuple[str, ...] = field(default=())
    camera: CameraModel | None = None

    def after(self, change: ChangeModel) -> SceneState:
        """The state once a change has come. New lights bring their own sun, or none."""
        sun = change.sun if change.sun is not None else None if change.lights is not None else self.sun
        return SceneState(
            change.lights or self.lights,
            sun,
            self.hide if change.hide is None else change.hide,
            change.camera or self.camera,
        )


def scene_in_state(
    loaded: LoadedScene, state: SceneState, frame_seed: int, position: Position | None = None
) -> LoadedScene:
    """The scene as a state has it; ``loaded`` is the file's, whole, and is not changed. Vertices are shared.

    Scattered lights and cameras are placed as in the whole scene, whatever is hidden.

    :raises RenderGraphError: RG790 for a name to hide that the scene does not have; RG652, RG653 from the camera.
    """
    scene = replace(loaded.scene, lights=list(loaded.scene.lights))
    notes = list(loaded.notes)
    if state.lights is not None:
        assert loaded.own is not None, "a loaded scene knows its own lights"
        scene.lights, scene.sun, scene.ambient = list(loaded.own.lights), loaded.own.sun, loaded.own.ambient
        notes += [note for note in apply_lights(scene, state.lights, frame_seed, position) if note not in notes]
    if state.sun is not None:
        scene.sun = None if state.sun == "none" else make_sun(state.sun)
    camera, turns = loaded.camera, loaded.orbit_turns
    if state.camera is not None:
        camera = place_camera(scene, state.camera, position)
        turns = state.camera.orbit.turns if state.camera.orbit is not None else 0.0
    if state.hide:
        _hide(scene, state.hide, position)
    return LoadedScene(scene, camera, turns, tuple(notes), frozenset(state.hide), loaded.own, loaded)


def _hide(scene: Scene, names: Sequence[str], position: Position | None) -> None:
    materials = {scene.meshes[i.mesh].material: scene.materials[scene.meshes[i.mesh].material] for i in scene.instances}
    known = {i.name for i in scene.instances} | {material.name for material in materials.values()}
    unknown = [
        diagnose("RG790", position, scene=scene.name, name=name, hint=did_you_mean(name, sorted(known - {""})))
        for name in names
        if name not in known or not name
    ]
    if unknown:
        raise RenderGraphError(unknown)
    scene.instances = [
        i
        for i in scene.instances
        if i.name not in names and scene.materials[scene.meshes[i.mesh].material].name not in names
    ]
