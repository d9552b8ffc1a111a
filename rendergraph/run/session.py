"""Frames of a scene that changes: at a frame boundary its plan gives way to the one for what the scene now holds.

Plans are kept by the features that they were specialised on (a session has one size and one set of options), and their
recorded commands, targets and buffers with them: a scene that comes back to what it was creates nothing and compiles
nothing. Features that specialise alike share a plan. What changes under the same plan (lights moved or dimmed, another
camera) is uploaded before the frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Self

from rendergraph.device import enums
from rendergraph.device.buffers import clear_buffer, copy_buffer
from rendergraph.device.context import Device, open_device
from rendergraph.device.info import Counters
from rendergraph.device.textures import clear_texture, copy_texture
from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.scene_models import ChangeModel
from rendergraph.plan.graph import Kind
from rendergraph.plan.plan import Plan
from rendergraph.run.options import RenderOptions
from rendergraph.run.plan_document import (
    PlannedDocument,
    plan_document,
    plan_for_scene,
    scene_cameras,
    scene_features,
)
from rendergraph.run.result import Pixels, Switch
from rendergraph.run.runner import Runner
from rendergraph.run.scene_store import SceneStore
from rendergraph.run.state import restore_defaults
from rendergraph.scene.changes import SceneState, scene_in_state
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.scene import Camera


@dataclass(frozen=True, slots=True)
class _Stage:
    """A plan with everything recorded, and its number in the order of first use."""

    number: int
    planned: PlannedDocument
    runner: Runner


@dataclass
class _Stages:
    """Every plan so far, in the order of first use, and which of them each set of features has; stages by the number of
    their plan and what was hidden of the scene.
    """

    plans: list[PlannedDocument] = field(default_factory=list)
    number_of: dict[SceneFeatures | None, int] = field(default_factory=dict)
    known: dict[tuple[int, frozenset[str]], list[_Stage]] = field(default_factory=dict)
    all: list[_Stage] = field(default_factory=list)

    def number(self, features: SceneFeatures | None, make: Callable[[], PlannedDocument]) -> int:
        """The number of the plan for a set of features: one there is, or one that is made."""
        if features not in self.number_of:
            made = make()
            alike = (n for n, known in enumerate(self.plans) if _alike(known.plan, made.plan))
            found = next(alike, len(self.plans))
            if found == len(self.plans):
                self.plans.append(made)
            self.number_of[features] = found
        return self.number_of[features]


def _alike(one: Plan, other: Plan) -> bool:
    """Whether two plans of one document run alike: the same order of the same sub-passes on the same resources."""
    return one.order == other.order and one.graph.resources == other.graph.resources


class Session:
    """A document under way, frame by frame. Its own ``scene.changes`` come at their frames; :meth:`frame` takes more.

    ``switches`` tells of every frame before which the scene changed, ``notes`` of history that could not be handed on.
    Use it in a ``with`` block, or call :meth:`close`.
    """

    def __init__(self, document: Document, planned: PlannedDocument, device: Device, options: RenderOptions) -> None:
        """``planned`` is the document's plan for the first frame; see :meth:`open`.

        :raises RenderGraphError: RG790 for a change that hides what the scene does not have; RG652 and RG653 from
            cameras of changes.
        """
        self._document, self._device, self._options = document, device, options
        self._frame = planned.plan.graph.frame
        self._owned_before = set(device.owned)
        self._whole = planned.scene.whole or planned.scene if planned.scene is not None else None
        self._scene = planned.scene
        self._state = SceneState()
        self._changes: dict[int, ChangeModel] = {}
        model = document.model.scene
        if model is not None and self._whole is not None and planned.scene is not None:
            self._check_changes(model.changes)
        self._stages = _Stages()
        self._first = planned
        self._stage: _Stage | None = None
        self._store: SceneStore | None = None
        self.index = 0
        self.switches: list[Switch] = []
        self.notes: list[Diagnostic] = []
        self.made_by_switches = Counters()

    @classmethod
    def open(cls, document: Document, options: RenderOptions | None = None) -> Session:
        """A session on this process's device.

        :raises RenderGraphError: for every mistake of the document, its files or its scene, and where no GL is.
        """
        options = options or RenderOptions()
        planned = plan_document(
            document, options.plan, scene=options.scene, size=options.size, frames=options.frames, full=options.full
        )
        session = cls(document, planned, open_device(options.device), options)
        session.prepare()
        return session

    def _check_changes(self, changes: Iterable[ChangeModel]) -> None:
        """Tell mistakes of the document's changes before anything is rendered."""
        state = SceneState()
        for index, change in enumerate(changes):
            state = state.after(change)
            self._in_state(state, index)
            if change.frame == 0:
                self._state = state
            else:
                self._changes[change.frame] = change

    def _in_state(self, state: SceneState, index: int | None = None) -> LoadedScene:
        assert self._whole is not None
        position = None if index is None else self._document.position("scene", "changes", index)
        return scene_in_state(self._whole, state, self._document.model.frame.seed, position)

    def prepare(self, progress: Callable[[int, int], None] = lambda done, total: None) -> None:
        """Compile, upload and record what the first frame needs."""
        if self._whole is not None:
            self._store = SceneStore(self._device, self._whole.scene)
        number = self._stages.number(self._features(self._scene), lambda: self._first)
        self._stage = self._new_stage(number, self._scene, progress)

    # ---- frames

    @property
    def plan(self) -> Plan:
        """The plan of the frame that ran last."""
        return self._current.planned.plan

    @property
    def runner(self) -> Runner:
        """What runs it."""
        return self._current.runner

    @property
    def _current(self) -> _Stage:
        assert self._stage is not None, "prepare the session first"
        return self._stage

    @property
    def compile_ns(self) -> int:
        """Time taken to compile, by all plans together."""
        return sum(stage.runner.compile_ns for stage in self._stages.all)

    @property
    def upload_ns(self) -> int:
        """Time taken to upload and allocate, by all plans together."""
        return sum(stage.runner.upload_ns for stage in self._stages.all)

    def frame(
        self,
        change: ChangeModel | Mapping[str, Any] | None = None,
        *,
        capture: Iterable[str] = (),
        check_finite: bool = False,
    ) -> dict[str, Pixels]:
        """Run the next frame, after the document's own change at it and then ``change`` (as an entry of
        ``scene.changes``, whose ``frame`` is ignored). The resources to ``capture`` come back.

        :raises RenderGraphError: RG790, RG652, RG653 from the change, RG793 where there is no scene; those of a run.
        """
        state = self._state
        if self.index in self._changes:
            state = state.after(self._changes[self.index])
        if change is not None:
            if self._whole is None:
                raise RenderGraphError([diagnose("RG793")])
            given = change if isinstance(change, ChangeModel) else ChangeModel(**{"frame": self.index, **change})
            state = state.after(given)
        if state != self._state:
            self._switch(state)
        captured = self.runner.run_frame(self.index, capture=capture, check_finite=check_finite)
        self.index += 1
        return captured

    def read(self, name: str) -> Pixels:
        """A resource's content after the last frame: ``[height, width, channels]``, first row at the bottom."""
        return self.runner.read(name, max(0, self.index - 1))

    # ---- changes

    def _features(self, loaded: LoadedScene | None) -> SceneFeatures | None:
        return scene_features(self._document, loaded, self._options.size, self._options.frames)

    def _switch(self, state: SceneState) -> None:
        """Make the scene what the next frame shows."""
        device, before, loaded = self._device, self._current, self._in_state(state)
        counted = device.counters.snapshot()
        seen = self._camera_before()
        number = self._stages.number(self._features(loaded), lambda: self._plan(loaded))
        cameras = scene_cameras(loaded, self._frame.count)
        for stage in self._stages.known.get((number, loaded.hidden), ()):
            if stage.runner.change_scene(loaded.scene, cameras, first=self.index, before=seen):
                revisited = True
                break
        else:
            stage, revisited = self._new_stage(number, loaded), False
            stage.runner.change_scene(loaded.scene, cameras, first=self.index, before=seen)
        self._state, self._scene, self._stage = state, loaded, stage
        kept, cleared = self._hand_on(before.runner, stage.runner) if self.index else ((), ())
        made = device.counters - counted
        total = self.made_by_switches
        if self.index:
            self.made_by_switches = Counters(
                total.objects_created + made.objects_created,
                total.programs_compiled + made.programs_compiled,
                total.bytes_uploaded + made.bytes_uploaded,
            )
        self.switches.append(
            Switch(
                self.index, stage.number, revisited, made.objects_created, made.programs_compiled, made.bytes_uploaded,
                kept, cleared,
            )
        )  # fmt: skip

    def _camera_before(self) -> Camera | None:
        if self.index == 0:
            return None
        cameras = scene_cameras(self._scene, self._frame.count)
        return cameras[min(self.index - 1, len(cameras) - 1)]

    def _plan(self, loaded: LoadedScene) -> PlannedDocument:
        options = self._options
        return plan_for_scene(
            self._document, loaded, options.plan, size=options.size, frames=options.frames, full=options.full
        )

    def _new_stage(
        self,
        number: int,
        loaded: LoadedScene | None,
        progress: Callable[[int, int], None] = lambda done, total: None,
    ) -> _Stage:
        planned = self._stages.plans[number]
        runner = Runner(
            self._device,
            planned.plan,
            loaded.scene if loaded is not None else None,
            scene_cameras(loaded, self._frame.count),
            poison=self._options.poison,
            store=self._store,
        )
        runner.prepare(progress)
        stage = _Stage(number, planned, runner)
        self._stages.known.setdefault((number, loaded.hidden if loaded else frozenset()), []).append(stage)
        self._stages.all.append(stage)
        return stage

    def _hand_on(self, old: Runner, new: Runner) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Copy what last frame left to the histories of the plan that takes over; clear those that it did not have."""
        if old is new:
            return (), ()
        self._device.gl.glMemoryBarrier(enums.ALL_BARRIER_BITS)
        kept, cleared = [], []
        for name in sorted(new.plan.lifetimes):
            resource = new.plan.graph.resources[name]
            if resource.kind is not Kind.HISTORY:
                continue
            known = old.plan.graph.resources.get(name)
            if name in old.plan.lifetimes and known is not None and known.desc == resource.desc:
                kept.append(name)
                if new.storage.is_texture(name):
                    copy_texture(
                        self._device, old.storage.texture(name, self.index), new.storage.texture(name, self.index)
                    )
                else:
                    one, other = old.storage.buffer(name, self.index), new.storage.buffer(name, self.index)
                    copy_buffer(self._device, one, other, one.bytes)
            else:
                cleared.append(name)
                self.notes.append(diagnose("RG792", resource.position, frame=self.index, resource=name))
                if new.storage.is_texture(name):
                    clear_texture(self._device, new.storage.texture(name, self.index), (0.0, 0.0, 0.0, 0.0))
                else:
                    clear_buffer(self._device, new.storage.buffer(name, self.index))
        self._device.gl.glMemoryBarrier(enums.ALL_BARRIER_BITS)
        return tuple(kept), tuple(cleared)

    # ---- the end

    def close(self) -> None:
        """Delete everything made on the device since the session was opened."""
        for stage in reversed(self._stages.all):
            stage.runner.release()
        self._device.finish()
        restore_defaults(self._device.gl)
        mine = [key for key in self._device.owned if key not in self._owned_before and key[0] != "glDeleteSamplers"]
        for delete, name in mine:
            self._device.delete_object(delete, name)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
