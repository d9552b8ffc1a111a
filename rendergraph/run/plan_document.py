"""Plans a document for its own scene: loads the scene, specialises on its features, compiles and verifies."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from rendergraph.document.collector import collector_paused
from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.overrides import SET_PREFIX
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import DrawScene
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.gpu_layout import place_textures
from rendergraph.scene.load import LoadedScene, load_scene


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
    loaded = _load(document, scene)
    features: SceneFeatures | None = None
    if loaded is not None:
        features = replace(loaded.scene.features(), texture_arrays=len(place_textures(loaded.scene).arrays))
    middle = time.perf_counter_ns()
    with collector_paused():
        graph, warnings = expand(document, features=features, full=full, size=size, frames=frames)
        plan, more = compile_plan(graph, options)
    end = time.perf_counter_ns()
    if loaded is None:
        for subpass in plan.order:
            if isinstance(subpass.work, DrawScene):
                raise RenderGraphError([diagnose("RG567", subpass.position, subpass=subpass.name)])
    notes = loaded.notes if loaded is not None else ()
    return PlannedDocument(plan, loaded, (*document.warnings, *notes, *warnings, *more), middle - start, end - middle)


def _load(document: Document, source: str | None) -> LoadedScene | None:
    from rendergraph.document.scene_models import SceneModel

    model = document.model.scene
    if model is None:
        if source is None:
            return None
        model = SceneModel(source=source)
    return load_scene(
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
