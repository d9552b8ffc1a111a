"""Plans a document for its own scene: loads the scene, specialises on its features, compiles and verifies."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, replace

from rendergraph.document.collector import collector_paused
from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.overrides import SET_PREFIX
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import DrawScene
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.scene.cameras import orbit
from rendergraph.scene.changes import SceneState, scene_in_state
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.load import LoadedScene, load_scene
from rendergraph.scene.scene import Camera
from rendergraph.scene.view_features import view_features


@dataclass(frozen=True, slots=True)
class PlannedDocument:
    """A plan, the scene it was specialised on (``None`` for graphs without one), warnings, and what it took."""

    plan: Plan
    scene: LoadedScene | None
    warnings: tuple[Diagnostic, ...]
    scene_ns: int
    plan_ns: int


def plan_document(
    document: Document,
    options: PlanOptions,
    *,
    scene: str | None = None,
    size: tuple[int, int] | None = None,
    frames: int | None = None,
    full: bool = False,
) -> PlannedDocument:
    """Load the scene (or ``scene`` in its place) and plan the document for it. No OpenGL."""
    start = time.perf_counter_ns()
    loaded = load_document_scene(document, scene)
    scene_ns = time.perf_counter_ns() - start
    return plan_for_scene(document, loaded, options, size=size, frames=frames, full=full, scene_ns=scene_ns)


def plan_for_scene(
    document: Document,
    loaded: LoadedScene | None,
    options: PlanOptions,
    *,
    size: tuple[int, int] | None = None,
    frames: int | None = None,
    full: bool = False,
    scene_ns: int = 0,
) -> PlannedDocument:
    """Plan the document for a scene that is loaded already (``None``: the graph has none). No OpenGL."""
    start = time.perf_counter_ns()
    features = scene_features(document, loaded, size, frames)
    with collector_paused():
        graph, warnings = expand(document, features=features, full=full, size=size, frames=frames)
        plan, more = compile_plan(graph, options)
    end = time.perf_counter_ns()
    if loaded is None:
        for subpass in plan.order:
            if isinstance(subpass.work, DrawScene):
                raise RenderGraphError([diagnose("RG567", subpass.position, subpass=subpass.name)])
    notes = (*(loaded.notes if loaded is not None else ()), *_late_changes(document, plan.graph.frame.count))
    return PlannedDocument(plan, loaded, (*document.warnings, *notes, *warnings, *more), scene_ns, end - start)


def _late_changes(document: Document, count: int) -> Iterable[Diagnostic]:
    model = document.model.scene
    for index, change in enumerate(model.changes if model is not None else ()):
        if change.frame >= count:
            position = document.position("scene", "changes", index, "frame")
            yield diagnose("RG791", position, frame=change.frame, count=count)


def scene_cameras(loaded: LoadedScene | None, count: int) -> list[Camera]:
    """One camera a frame: the scene's, moved along its orbit; a default one for graphs without a scene."""
    if loaded is None:
        return [Camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))] * count
    if not loaded.orbit_turns:
        return [loaded.camera] * count
    return [orbit(loaded.camera, loaded.orbit_turns * index / count) for index in range(count)]


def scene_features(
    document: Document, loaded: LoadedScene | None, size: tuple[int, int] | None, frames: int | None
) -> SceneFeatures | None:
    """What plans of the document specialise on: the scene's features, and what of them its cameras can see."""
    if loaded is None:
        return None
    model = document.model.frame
    width, height = size or model.size
    view = view_features(loaded.scene, scene_cameras(loaded, frames or model.count), width / height)
    return replace(loaded.scene.features(), view=view)


def load_document_scene(document: Document, source: str | None) -> LoadedScene | None:
    """The document's scene, or ``source`` in its place, as the first frame has it; ``None`` where there is neither."""
    from rendergraph.document.scene_models import SceneModel

    model = document.model.scene
    if model is None:
        if source is None:
            return None
        model = SceneModel(source=source)
    loaded = load_scene(
        model,
        document.path.parent,
        frame_seed=document.model.frame.seed,
        source_override=source,
        position=document.position("scene", "source") if source is None else None,
        camera_position=document.position("scene", "camera"),
        keep_camera=any(
            document.position("scene", "camera", key).file.startswith(SET_PREFIX)
            for key in ("position", "target", "name")
        ),
    )
    if model.changes and model.changes[0].frame == 0:
        state = SceneState().after(model.changes[0])
        return scene_in_state(loaded, state, document.model.frame.seed, document.position("scene", "changes", 0))
    return loaded
