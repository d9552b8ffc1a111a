"""One graph run under variations that must not matter: order, poison, sharing of memory, specialisation."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Final

from rendergraph.device.context import Device
from rendergraph.device.texels import Poison
from rendergraph.document.load import Document
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.run.plan_document import PlannedDocument, load_document_scene, plan_for_scene
from rendergraph.run.render import frame_cameras
from rendergraph.run.result import Pixels
from rendergraph.run.runner import Runner
from rendergraph.run.scene_store import SceneStore

#: The dimensions of a case, in the order in which they are dropped.
DIMENSIONS: Final = ("full", "poison", "alias", "order")


@dataclass(frozen=True, slots=True)
class FuzzCase:
    """One variation. ``order`` is the planner's (None), a random legal one by seed, or sub-passes by name; ``poison``
    what transients hold before their first use (None: what happens to be there).
    """

    order: int | tuple[str, ...] | None = None
    poison: Poison | None = None
    alias: bool = True
    full: bool = False

    @property
    def varied(self) -> tuple[str, ...]:
        """The dimensions in which it is not as usual."""
        return tuple(name for name in DIMENSIONS if getattr(self, name) != getattr(USUAL, name))

    def without(self, dimension: str) -> FuzzCase:
        """The same with one dimension as usual."""
        return replace(self, **{dimension: getattr(USUAL, dimension)})


USUAL: Final = FuzzCase()

#: By output, frame after frame.
Images = dict[str, tuple[Pixels, ...]]


@dataclass
class TestBed:
    """Runs cases of one document: the scene is loaded and uploaded once, plans are kept. Close it with ``closed``."""

    __test__ = False  # no test class, whatever its name

    document: Document
    device: Device
    size: tuple[int, int]
    frames: int
    scene: str | None = None
    _plans: dict[FuzzCase, PlannedDocument] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._owned_before = set(self.device.owned)
        self._loaded = load_document_scene(self.document, self.scene)
        self._store = SceneStore(self.device, self._loaded.scene) if self._loaded is not None else None

    @contextmanager
    def closed(self) -> Iterator[TestBed]:
        """Itself; what it made on the device is deleted in the end."""
        try:
            yield self
        finally:
            mine = [key for key in self.device.owned if key not in self._owned_before and key[0] != "glDeleteSamplers"]
            for delete, name in mine:
                self.device.delete_object(delete, name)

    def plan(self, case: FuzzCase) -> Plan:
        """The verified plan of a case, whatever its poison."""
        return self._planned(case).plan

    def _planned(self, case: FuzzCase) -> PlannedDocument:
        key = case.without("poison")
        if key not in self._plans:
            if isinstance(case.order, tuple):
                options = PlanOptions(alias=case.alias, order="listed", sequence=case.order)
            elif case.order is not None:
                options = PlanOptions(alias=case.alias, order="random", seed=case.order)
            else:
                options = PlanOptions(alias=case.alias)
            self._plans[key] = plan_for_scene(
                self.document, self._loaded, options, size=self.size, frames=self.frames, full=case.full
            )
        return self._plans[key]

    def images(self, case: FuzzCase) -> Images:
        """All outputs after each frame.

        :raises RenderGraphError: for every error of the run.
        """
        outputs = self.plan(case).graph.outputs
        shown: dict[str, list[Pixels]] = {name: [] for name in outputs}
        with self.runner(case) as runner:
            for index in range(self.frames):
                runner.run_frame(index)
                for name in outputs:
                    shown[name].append(runner.read(name, index))
        return {name: tuple(pixels) for name, pixels in shown.items()}

    @contextmanager
    def runner(self, case: FuzzCase) -> Iterator[Runner]:
        """A runner of a case, ready."""
        planned = self._planned(case)
        scene = planned.scene.scene if planned.scene is not None else None
        runner = Runner(
            self.device, planned.plan, scene, frame_cameras(planned), poison=case.poison or False, store=self._store
        )
        try:
            runner.prepare()
            yield runner
        finally:
            runner.release()
