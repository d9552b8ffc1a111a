"""What the settings of a sweep share in one process: documents, plans, scenes on the device, rays, twins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from rendergraph.device.context import Device
from rendergraph.document.load import Document, load_document
from rendergraph.measure.sweep.job import SweepJob
from rendergraph.measure.truth.cache import TruthCache, open_cache
from rendergraph.measure.truth.surfaces import cached_trace
from rendergraph.node.reference import PassRun
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, load_document_scene, plan_for_scene
from rendergraph.run.scene_store import SceneStore
from rendergraph.scene.load import LoadedScene

Overrides = tuple[str, ...]

#: Paths that change the scene: everything else leaves it, and what is on the device of it, shared.
_SCENE = ("scene", "frame.seed")


@dataclass(slots=True)
class Settings:
    """Documents, plans and scenes by overrides, each made once. No OpenGL."""

    job: SweepJob
    _documents: dict[Overrides, Document] = field(default_factory=dict)
    _scenes: dict[Overrides, LoadedScene | None] = field(default_factory=dict)

    def document(self, overrides: Overrides) -> Document:
        """The document under the job's overrides and these. Raises RenderGraphError for its mistakes."""
        if overrides not in self._documents:
            self._documents[overrides] = load_document(self.job.graph, (*self.job.overrides, *overrides))
        return self._documents[overrides]

    def scene(self, overrides: Overrides) -> LoadedScene | None:
        """Its scene, one for all settings that differ in nothing of it."""
        key = scene_part(overrides)
        if key not in self._scenes:
            self._scenes[key] = load_document_scene(self.document(overrides), self.job.scene)
        return self._scenes[key]

    def planned(self, overrides: Overrides) -> PlannedDocument:
        """Its plan. Raises RenderGraphError where it has none."""
        return plan_for_scene(self.document(overrides), self.scene(overrides), PlanOptions(), size=self.job.size)


def scene_part(overrides: Overrides) -> Overrides:
    """The overrides that change the scene."""
    return tuple(o for o in overrides if any(o.startswith((f"{path}.", f"{path}=")) for path in _SCENE))


@dataclass
class Workbench:
    """The settings on a device. ``kept`` is what other modules keep here for all settings, by what they choose."""

    settings: Settings
    device: Device
    kept: dict[Any, Any] = field(default_factory=dict)
    _stores: dict[Overrides, SceneStore | None] = field(default_factory=dict)
    _traces: dict[Any, tuple[Any, Callable[[], Any]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._owned_before = set(self.device.owned)

    @property
    def job(self) -> SweepJob:
        """What is asked."""
        return self.settings.job

    @cached_property
    def cache(self) -> TruthCache | None:
        """The user's cache of truths."""
        return open_cache()

    def store(self, overrides: Overrides) -> SceneStore | None:
        """The scene on the device. Ask before runners are made: what is made after one is deleted with it."""
        key = scene_part(overrides)
        if key not in self._stores:
            loaded = self.settings.scene(overrides)
            self._stores[key] = SceneStore(self.device, loaded.scene) if loaded is not None else None
        return self._stores[key]

    def traced_once(self, run: PassRun) -> Callable[[], Any] | None:
        """What rays hit, traced once for all settings that show the same."""
        if run.scene is None or run.camera is None:
            return run.trace
        key = (id(run.scene), repr(run.camera), repr(run.frame))
        if key not in self._traces:
            self._traces = {key: (run.scene, cached_trace(run.scene, run.camera, run.frame))}
        return self._traces[key][1]

    def close(self) -> None:
        """Delete what was made on the device."""
        self.device.finish()
        mine = [key for key in self.device.owned if key not in self._owned_before and key[0] != "glDeleteSamplers"]
        for delete, name in mine:
            self.device.delete_object(delete, name)
