"""By what a sweep tells how wrong a setting is: ``--error PASS[.MEASURE]`` or ``--error image[:METRIC]``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.measure.metrics.table import METRICS, NOT_FINITE
from rendergraph.measure.sweep.axes import Axis
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Quantity
from rendergraph.plan.graph import Position, TextureDesc
from rendergraph.plan.plan import Plan

IMAGE: Final = "image"
#: More of it is better, and of equal images there is none: no error to rank settings by.
_NO_ERROR: Final = ("psnr", NOT_FINITE)


@dataclass(frozen=True, slots=True)
class ErrorChoice:
    """``kind`` ``pass``: a measure of a pass's own reference; ``image``: ``output`` of the graph against its twin, in
    which all that is swept is at its most accurate. ``quantity`` and ``metric`` say how, ``why`` how this was chosen.
    """

    kind: Literal["pass", "image"]
    metric: str
    quantity: str
    why: Literal["asked", "one_pass", "several_passes", "no_ideal_reference"]
    pass_name: str = ""
    measure: str = ""
    output: str = ""

    @property
    def name(self) -> str:
        """As ``--error`` takes it."""
        return f"{self.pass_name}.{self.measure}" if self.kind == "pass" else f"{IMAGE}:{self.metric}"


def choose_error(document: Document, plan: Plan, axes: Sequence[Axis], asked: str = "") -> ErrorChoice:
    """What was asked for; by default the first ideal measure of the one pass that all axes belong to, else the image.

    :raises RenderGraphError: RG758 for a pass, measure or metric that is not there, RG759 where no output depends on
        what is swept; exit code 2.
    """
    if asked and asked.partition(":")[0] != IMAGE:
        return _pass_error(document, asked)
    if asked:
        return _image_error(document, plan, axes, asked.partition(":")[2], "asked")
    passes = {axis.passed for axis in axes}
    if len(passes) != 1 or "" in passes:
        return _image_error(document, plan, axes, "", "several_passes")
    name = passes.pop()
    reference = find_node(document.model.passes[name].node).reference
    if reference is not None and reference.ideal:
        for key, measure in reference.measures.items():
            if measure.ideal:
                return ErrorChoice("pass", measure.metric, measure.quantity.value, "one_pass", name, key)
    return _image_error(document, plan, axes, "", "no_ideal_reference")


def _pass_error(document: Document, asked: str) -> ErrorChoice:
    name, _, key = asked.partition(".")
    if name not in document.model.passes:
        raise _refused(asked, f"there is no pass '{name}'", did_you_mean(name, [*document.model.passes, IMAGE]))
    node = find_node(document.model.passes[name].node)
    measures = node.reference.measures if node.reference is not None else {}
    if not measures:
        raise _refused(asked, f"node '{node.name}' has no reference", "name another pass, or --error image")
    found = key or next((k for k, m in measures.items() if m.ideal), next(iter(measures)))
    if found not in measures:
        raise _refused(asked, f"the reference of '{node.name}' has no measure '{key}'", did_you_mean(key, measures))
    measure = measures[found]
    return ErrorChoice("pass", measure.metric, measure.quantity.value, "asked", name, found)


def _image_error(document: Document, plan: Plan, axes: Sequence[Axis], metric: str, why: str) -> ErrorChoice:
    output = image_output(document, plan, [axis.passed for axis in axes])
    quantity = output_quantity(document, plan, output)
    known = [m for m in METRICS[quantity] if m not in _NO_ERROR]
    if metric and metric not in known:
        raise _refused(f"{IMAGE}:{metric}", f"{quantity} images have no error '{metric}'", did_you_mean(metric, known))
    return ErrorChoice(IMAGE, metric or default_metric(quantity), quantity.value, why, output=output)  # type: ignore[arg-type]


def image_output(document: Document, plan: Plan, passes: Sequence[str]) -> str:
    """The first of the graph's output textures that depends on one of these passes ("": on everything)."""
    everything = "" in passes or not passes
    reached = reached_by(document, plan, passes)
    for name in output_textures(plan):
        if everything or name in reached:
            return name
    what = ", ".join(dict.fromkeys(passes)) or "what is swept"
    raise RenderGraphError([diagnose("RG759", what=what)], exit_code=2)


def output_textures(plan: Plan) -> list[str]:
    """The outputs that are images, in the file's order."""
    return [name for name in plan.graph.outputs if isinstance(plan.graph.resources[name].desc, TextureDesc)]


def reached_by(document: Document, plan: Plan, passes: Iterable[str]) -> set[str]:
    """The resources that these passes' outputs have a part in, this frame or a later one."""
    touched = {name for name in passes if name}
    resources: set[str] = set()
    while True:
        known = len(touched) + len(resources)
        for name, model in document.model.passes.items():
            if name in touched or resources & set(model.read.values()):
                touched.add(name)
                resources |= set(model.write.values())
        resources |= {r.name for r in plan.graph.resources.values() if r.previous_of in resources}
        if len(touched) + len(resources) == known:
            return resources


def output_quantity(document: Document, plan: Plan, output: str) -> Quantity:
    """What an output's numbers mean: light where it is kept as floats, else what a screen shows."""
    desc = plan.graph.resources[output].desc
    assert isinstance(desc, TextureDesc)
    row = FORMATS[desc.format]
    if row.channel in (Channel.UINT, Channel.INT):
        return Quantity.IDENTITY
    if row.channel is Channel.FLOAT and not document.model.outputs[output].file.endswith(".png"):
        return Quantity.RADIANCE
    return Quantity.DISPLAY if row.channel in (Channel.UNORM, Channel.FLOAT) else Quantity.SCALAR


def default_metric(quantity: Quantity) -> str:
    """FLIP where its package is installed, else the root mean square (relative, of light)."""
    from rendergraph.measure.metrics import HEADLINE, flip_version

    if HEADLINE[quantity] != "flip":
        return HEADLINE[quantity]
    try:
        flip_version()
    except RenderGraphError:
        return "rmse"
    return "flip"


def _refused(asked: str, problem: str, hint: str) -> RenderGraphError:
    return RenderGraphError(
        [diagnose("RG758", Position(f"--error {asked}", 1, 1), problem=problem, hint=hint)], exit_code=2
    )
