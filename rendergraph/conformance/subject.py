"""The node under test: its class, its own graph made small, and what several demands look at."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.stress.target import StressTarget, find_target, load_target
from rendergraph.node.contract import Node
from rendergraph.node.discovery import find_node
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, load_document_scene, plan_for_scene

if TYPE_CHECKING:
    from rendergraph.device.context import Device
    from rendergraph.measure.stress.stress import StressReport
    from rendergraph.measure.truth.accuracy import PassAccuracy
    from rendergraph.measure.truth.cache import TruthCache

#: The frame that demands are tried at: small enough for software rendering, with more than a few tiles of 8 x 8.
SIZE: Final = (64, 36)
MOST_FRAMES: Final = 2


class Subject:
    """A node on its own graph. What is asked for is made once; the device is opened when the first demand needs it.

    ``isolate`` tries extremes in a process of their own, so that a driver's crash costs one of them.
    """

    def __init__(self, name: str, *, device: int | None = None, isolate: bool = False) -> None:
        self.name = name
        self.isolate = isolate
        self.device_index = device
        self._scenes: dict[str, Any] = {}

    @cached_property
    def node(self) -> type[Node[Any]]:
        """The class. Importing it may fail in any way."""
        return find_node(self.name)

    @cached_property
    def target(self) -> StressTarget:
        """The node's own graph. Raises RenderGraphError RG771 where there is none."""
        return find_target(self.name)

    @cached_property
    def document(self) -> Document:
        """The graph with targets of a fixed size as they are, procedural scenes at their least detail."""
        return self.with_overrides()

    @cached_property
    def shrunk(self) -> Document:
        """The graph with targets of a fixed size shrunk too: for what does not hang on sizes."""
        return load_target(self.target)

    def with_overrides(self, *overrides: str) -> Document:
        """The graph under ``--set`` arguments. Raises RenderGraphError for its mistakes and theirs."""
        model = load_document(self.target.file).model
        least = model.scene is not None and "detail" not in model.scene.model_fields_set
        return load_document(self.target.file, (*(("scene.detail=0",) if least else ()), *overrides))

    def planned(
        self, document: Document, options: PlanOptions | None = None, size: tuple[int, int] = SIZE
    ) -> PlannedDocument:
        """A document's plan at the size of the tests."""
        key = repr((document.model.scene, document.model.frame.seed))
        if key not in self._scenes:
            self._scenes[key] = load_document_scene(document, None)
        frames = min(MOST_FRAMES, document.model.frame.count)
        return plan_for_scene(document, self._scenes[key], options or PlanOptions(), size=size, frames=frames)

    @cached_property
    def passes(self) -> tuple[str, ...]:
        """The passes of the graph that are this node's."""
        return tuple(name for name, model in self.document.model.passes.items() if model.node == self.name)

    @cached_property
    def device(self) -> Device:
        """The process's device. Raises RenderGraphError with exit code 3 where there is none."""
        from rendergraph.device.context import open_device

        return open_device(self.device_index)

    @cached_property
    def cache(self) -> TruthCache | None:
        """The user's cache of truths."""
        from rendergraph.measure.truth.cache import open_cache

        return open_cache()

    def judge(self, document: Document, size: tuple[int, int] = SIZE) -> tuple[PassAccuracy, ...]:
        """The node's passes, judged in the graph's last frame of the tests."""
        from rendergraph.measure.truth.accuracy import judge_graph

        planned = self.planned(document, size=size)
        return judge_graph(document, planned, self.device, self.passes, cache=self.cache, flip=False)

    @cached_property
    def judged(self) -> tuple[PassAccuracy, ...]:
        """At the graph's own settings."""
        return self.judge(self.document)

    @cached_property
    def stressed(self) -> StressReport:
        """What came of every extreme."""
        from rendergraph.measure.stress.stress import StressOptions, stress

        return stress(self.name, StressOptions(device=self.device_index, isolate=self.isolate))

    @cached_property
    def graph_problem(self) -> str:
        """Why there is no graph to try the node on; empty where there is one that plans and runs a pass of it."""
        try:
            planned = self.planned(self.document)
        except RenderGraphError as error:
            return "; ".join(f"{d.code} {d.text}" for d in error.diagnostics)
        ran = {subpass.parent for subpass in planned.plan.order}
        if not ran & set(self.passes):
            return f"no pass of {self.target.file.name} that runs is a {self.name}"
        return ""
