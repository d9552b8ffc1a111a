"""The error of one setting, read from its own runner on the way to its last frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite, isnan, sqrt
from statistics import fmean, stdev
from typing import Any, Final

from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.metrics import LARGER_IS_BETTER, compare
from rendergraph.measure.sweep.bench import Overrides, Workbench
from rendergraph.measure.sweep.twin import twin_of
from rendergraph.measure.truth.accuracy import rooted, run_content
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.judgement import Judgement
from rendergraph.measure.truth.observe import content, watch_frame
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Quantity
from rendergraph.run.plan_document import PlannedDocument
from rendergraph.run.runner import Runner

#: Frames whose mean a random image's error is.
FRAMES: Final = 8


@dataclass(frozen=True, slots=True)
class PointError:
    """``value`` in terms of the chosen metric (None: there is none), with its standard error over frames where the
    graph is random. ``verdict``: ``within`` or ``above`` the node's tolerance, ``measured`` of images,
    ``cannot_judge``, or ``no_truth``; ``reason`` says why of the last two.
    """

    value: float | None
    verdict: str
    reason: str = ""
    standard_error: float = 0.0
    tolerance: float | None = None


def measure_error(
    bench: Workbench, runner: Runner, overrides: Overrides, planned: PlannedDocument
) -> tuple[PointError, int]:
    """Run the graph's frames and judge the last of them, or that and those after it where the graph is random; also how
    many frames were run.

    :raises RenderGraphError: for every error of the run; RG744 and others of the references.
    """
    document = bench.settings.document(overrides)
    last = planned.plan.graph.frame.count - 1
    for index in range(last):
        runner.run_frame(index)
    count = judged_frames(document)
    found = [
        _of_frame(bench, runner, document, overrides, planned, index) for index in range(last, last + count)
    ]  # fmt: skip
    return over_frames(found), last + count


def over_frames(found: list[PointError]) -> PointError:
    """The mean over frames with its standard error; the worst verdict of any."""
    worst = max(found, key=lambda error: _BADNESS.index(error.verdict))
    values = [error.value for error in found if error.value is not None]
    if worst.value is None or len(values) < len(found) or len(found) == 1:
        return worst
    spread = stdev(values) / sqrt(len(values)) if all(isfinite(value) for value in values) else 0.0
    return replace(worst, value=fmean(values), standard_error=spread)


_BADNESS: Final = ("measured", "within", "above", "no_truth", "cannot_judge")


def _of_frame(
    bench: Workbench, runner: Runner, document: Document, overrides: Overrides, planned: PlannedDocument, index: int
) -> PointError:
    choice = bench.job.error
    if choice.kind == "pass":
        return _pass_error(bench, runner, document, planned, index)
    runner.run_frame(index)
    image = content(runner, planned, choice.output, index)
    try:
        truth = twin_of(bench, overrides).image
    except RenderGraphError as error:
        return PointError(None, "no_truth", "; ".join(d.text for d in error.diagnostics))
    if image.shape != truth.shape:
        reason = f"its image has another size than its twin's: {_size(image)}, {_size(truth)}"
        return PointError(None, "no_truth", reason)
    return image_error(Quantity(choice.quantity), choice.metric, image, truth)


def image_error(quantity: Quantity, metric: str, image: Any, truth: Any) -> PointError:
    """The error of an image against its twin's, float64[h, w, c] each."""
    return PointError(as_error(metric, compare(quantity, image, truth, None, [metric])[metric]), "measured")


def _pass_error(
    bench: Workbench, runner: Runner, document: Document, planned: PlannedDocument, index: int
) -> PointError:
    name, key = bench.job.error.pass_name, bench.job.error.measure
    runs = watch_frame(runner, document, planned, bench.device, {name}, index)
    if name not in runs:
        return PointError(None, "no_truth", "the pass does not run: `rg explain` tells why it was left out")
    run = rooted(runs[name], run_content(planned, bench.device))
    run = replace(run, trace=bench.traced_once(run))
    judged = judge_pass(name, find_node(document.model.passes[name].node), run, bench.cache, flip=False)
    found = next(judgement for judgement in judged if judgement.measure == key)
    return judged_error(found)


def judged_error(found: Judgement) -> PointError:
    """A judgement as the error of a setting."""
    if found.verdict == "cannot_judge":
        return PointError(None, "cannot_judge", found.reason, tolerance=found.tolerance)
    return PointError(as_error(found.metric, found.value), found.verdict, tolerance=found.tolerance)


def as_error(metric: str, value: float | None) -> float:
    """A metric's value with 0 for none and more for worse: of similarities, what is missing to 1; of signal to noise,
    the noise as a share of the signal (10^(-dB/20)).
    """
    if metric == "psnr":
        return 0.0 if value is None else inf if isnan(value) else 10.0 ** (-value / 20.0)
    if value is None:
        return inf
    error = 1.0 - value if metric in LARGER_IS_BETTER else value
    return inf if isnan(error) else error


def judged_frames(document: Document) -> int:
    """From how many frames the error is taken: one, or :data:`FRAMES` where a node of the graph is random."""
    nodes = (find_node(model.node) for model in document.model.passes.values())
    random = any(node.reference is not None and node.reference.stochastic for node in nodes)
    return FRAMES if random else 1


def _size(image: Any) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"
