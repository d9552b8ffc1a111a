"""`rg attribute`: which pass the final image's error comes from.

Each approximate pass is replaced by its truth, or where none can stand in for its output by its most accurate setting:
one at a time, and all but one. The image with all of them replaced is taken for true.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Final, Literal

from rendergraph.device.clock import choose_clock
from rendergraph.device.context import Device
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.metrics import compare
from rendergraph.measure.sweep.accurate import accurate_settings, possible
from rendergraph.measure.sweep.error_choice import default_metric, output_quantity, output_textures, reached_by
from rendergraph.measure.sweep.errors import as_error
from rendergraph.measure.truth.cache import open_cache
from rendergraph.measure.truth.decode import F64
from rendergraph.measure.truth.substitute import ideal_measures, replace_outputs
from rendergraph.node.reference import Quantity
from rendergraph.plan.plan import PlanOptions
from rendergraph.report.resources import resources_record
from rendergraph.run.plan_document import PlannedDocument, load_document_scene, plan_for_scene
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner
from rendergraph.scene.load import LoadedScene

Progress = Callable[[str, int, int], None]

_WARM_UP: Final = 3
_SAMPLES: Final = 9


@dataclass(frozen=True, slots=True)
class Replacement:
    """What stands in for a pass: its truth (``by`` names measures), or settings (``by`` as ``--set`` takes them)."""

    how: Literal["truth", "setting"]
    by: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Contribution:
    """One pass. ``removed``: by how much the error falls when it alone is replaced; ``left``: the error when it alone
    is not; ``share`` of all that is left so. ``ms`` a frame and ``bytes`` it is the first to use, as it is now.
    """

    name: str
    node: str
    replacement: Replacement
    removed: float
    left: float
    share: float
    ms: float
    ms_share: float
    bytes: int

    @property
    def error_per_ms(self) -> float:
        """The error it causes for each millisecond that it takes: the larger, the cheaper the error was come by."""
        return self.left / self.ms if self.ms > 0.0 else 0.0


@dataclass(frozen=True, slots=True)
class Attribution:
    """The image's ``error`` as it is, and the approximate passes, first where a millisecond buys most; ``accurate`` are
    the passes that could be more accurate by nothing known, with the reason.
    """

    output: str
    quantity: Quantity
    metric: str
    frame: int
    error: float
    frame_ms: float
    passes: tuple[Contribution, ...]
    accurate: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class AttributeOptions:
    """``frame`` is the one judged, by default the file's last; ``size`` and ``scene`` replace the file's own."""

    overrides: tuple[str, ...] = ()
    frame: int | None = None
    size: tuple[int, int] | None = None
    scene: str | None = None


def attribute(
    graph: str,
    device: Device,
    options: AttributeOptions | None = None,
    progress: Progress = lambda stage, done, total: None,
) -> tuple[Attribution, Document, PlannedDocument]:
    """Attribute the error of the output image that most approximate passes have a part in.

    :raises RenderGraphError: RG763 where no pass is approximate or the frame is none; those of runs and references.
    """
    return _Attributing(graph, device, options or AttributeOptions(), progress).run()


class _Attributing:
    def __init__(self, graph: str, device: Device, options: AttributeOptions, progress: Progress) -> None:
        self._graph, self._device, self._options, self._progress = graph, device, options, progress
        self._cache = open_cache()
        self._document = self._load(())
        self._loaded: LoadedScene | None = load_document_scene(self._document, options.scene)
        self._planned = self._plan(self._document)
        count = self._planned.plan.graph.frame.count
        self._frame = count - 1 if options.frame is None else options.frame
        if self._frame >= count:
            reason, hint = f"there is no frame {self._frame}", f"the graph has frames 0 to {count - 1}"
            raise RenderGraphError([diagnose("RG763", reason=reason, hint=hint)], exit_code=2)

    def run(self) -> tuple[Attribution, Document, PlannedDocument]:
        plan = self._planned.plan
        ran = list(dict.fromkeys(subpass.parent for subpass in plan.order))
        found, accurate = self._replacements(ran)
        if not found:
            hint = "give a node a reference, or knobs that say which way is accurate"
            raise RenderGraphError([diagnose("RG763", reason="no pass is approximate", hint=hint)], exit_code=2)
        output = self._output(found)
        quantity = output_quantity(self._document, plan, output)
        metric = default_metric(quantity)
        wanted: list[frozenset[str]] = [frozenset(), frozenset(found)]
        wanted += [frozenset({name}) for name in found] + [frozenset(found) - {name} for name in found]
        images = {}
        for done, replaced in enumerate(wanted):
            self._progress("replacing passes", done, len(wanted))
            images[replaced] = self._image(output, replaced, found)
        truth = images[frozenset(found)]

        def error(replaced: Iterable[str]) -> float:
            values = compare(quantity, images[frozenset(replaced)], truth, None, [metric])
            return as_error(metric, values[metric])

        whole = error(())
        left = {name: error(set(found) - {name}) for name in found}
        times, frame_ms = self._times()
        held = self._bytes()
        total = sum(left.values())
        contributions = [
            Contribution(
                name, self._document.model.passes[name].node, found[name], whole - error({name}), left[name],
                left[name] / total if total > 0.0 else 0.0, times[name], times[name] / (sum(times.values()) or 1.0),
                held.get(name, 0),
            )
            for name in found
        ]  # fmt: skip
        contributions.sort(key=lambda entry: -entry.error_per_ms)
        attribution = Attribution(
            output, quantity, metric, self._frame, whole, frame_ms, tuple(contributions), accurate
        )  # fmt: skip
        return attribution, self._document, self._planned

    def _output(self, approximate: Iterable[str]) -> str:
        """The output image that most of these passes have a part in, the first of several."""
        plan = self._planned.plan
        reached = [reached_by(self._document, plan, [name]) for name in approximate]
        outputs = output_textures(plan)
        if not outputs:
            hint = "attribute a graph with an output image"
            raise RenderGraphError([diagnose("RG763", reason="no output is an image", hint=hint)], exit_code=2)
        return max(outputs, key=lambda output: sum(output in resources for resources in reached))

    # ---- what stands in for a pass

    def _replacements(self, ran: Sequence[str]) -> tuple[dict[str, Replacement], dict[str, str]]:
        candidates = [name for name in ran if ideal_measures(self._document, name)]
        truths = self._replace(self._document, candidates)[1] if candidates else {}
        found: dict[str, Replacement] = {}
        accurate: dict[str, str] = {}
        for name in ran:
            if name in truths:
                found[name] = Replacement("truth", truths[name])
                continue
            wanted = accurate_settings(self._document, name)
            settings = possible(self._load, (), wanted, self._loaded, self._options.size)
            if settings and self._load(settings).model != self._document.model:
                found[name] = Replacement("setting", settings)
            elif wanted:
                accurate[name] = "its knobs are at their most accurate"
            else:
                accurate[name] = "no truth can stand in for its outputs, and no knob makes it more accurate"
        return found, accurate

    # ---- images

    def _image(self, output: str, replaced: frozenset[str], by: Mapping[str, Replacement]) -> F64:
        settings = [s for name in by if name in replaced and by[name].how == "setting" for s in by[name].by]
        truths = [name for name in by if name in replaced and by[name].how == "truth"]
        return self._replace(self._load(tuple(settings)), truths)[0][output]

    def _replace(
        self, document: Document, passes: Sequence[str]
    ) -> tuple[Mapping[str, F64], Mapping[str, tuple[str, ...]]]:
        found = replace_outputs(
            document, self._plan(document), self._device, passes, cache=self._cache, frame=self._frame
        )  # fmt: skip
        return found.images, found.measures

    def _load(self, settings: tuple[str, ...]) -> Document:
        return load_document(self._graph, (*self._options.overrides, *settings))

    def _plan(self, document: Document) -> PlannedDocument:
        return plan_for_scene(document, self._loaded, PlanOptions(), size=self._options.size)

    # ---- what passes cost

    def _times(self) -> tuple[dict[str, float], float]:
        """Milliseconds of each pass and of the frame: medians."""
        plan, device = self._planned.plan, self._device
        scene = self._planned.scene.scene if self._planned.scene is not None else None
        runner = Runner(device, plan, scene, frame_cameras(self._planned))
        try:
            runner.prepare()
            first = self._frame + 1 + _WARM_UP
            for index in range(first):
                runner.run_frame(index)
            whole, _, steps = runner.time_frames(first, _SAMPLES, choose_clock(device), self._progress)
        finally:
            runner.release()
        parents = {subpass.name: subpass.parent for subpass in plan.order}
        samples: dict[str, list[float]] = {}
        for step in steps:
            sums = samples.setdefault(parents[step.name], [0.0] * _SAMPLES)
            samples[parents[step.name]] = [a + b / 1e6 for a, b in zip(sums, step.device_ns, strict=True)]
        return {name: median(values) for name, values in samples.items()}, median(whole) / 1e6

    def _bytes(self) -> dict[str, int]:
        held: dict[str, int] = {}
        for resource in resources_record(self._planned.plan, "")["resources"]:
            name = resource["first"].partition(".")[0]
            held[name] = held.get(name, 0) + resource["bytes"]
        return held
