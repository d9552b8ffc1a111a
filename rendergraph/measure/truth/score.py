"""Holds one measure's pixels against their truth: metrics, verdict, the worst texel, whether the truth may judge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from rendergraph.measure.metrics import METRICS, compare, error_map, worst_texel
from rendergraph.measure.truth.judgement import F64, Pictures, Verdict, WorstTexel, exceeds
from rendergraph.node.reference import Measure, PassRun, Quantity, Truth

#: How many of its own standard errors a truth must be able to spare.
SIGMAS = 3.0


@dataclass(frozen=True, slots=True)
class Score:
    """The measured part of a :class:`~rendergraph.measure.truth.judgement.Judgement`."""

    metrics: Mapping[str, float | None]
    value: float | None
    tolerance: float
    verdict: Verdict
    reason: str
    masked: float
    worst_texel: WorstTexel | None
    standard_error: float
    pictures: Pictures


def score(measure: Measure, truth: Truth, run: PassRun, *, flip: bool = True) -> Score:
    """Compare and decide; without ``flip`` that metric, the slowest, is taken only where the verdict needs it.

    Raises ``ValueError`` where the truth has not the shape of what is judged.
    """
    pictures = lay_out(measure, truth, run)
    tolerance = measure.tolerance if truth.tolerance is None else truth.tolerance
    masked = 0.0 if pictures.mask is None else 1.0 - float(pictures.mask.mean())
    if pictures.mask is not None and not pictures.mask.any():
        return Score({}, None, tolerance, "cannot_judge", "all_masked", 1.0, None, 0.0, pictures)
    names = METRICS[measure.quantity]
    wanted = None if flip else [name for name in names if name != "flip" or name == measure.metric]
    metrics = compare(measure.quantity, pictures.judged, pictures.truth, pictures.mask, wanted)
    if measure.metric not in metrics:  # asked for by itself, it says why it is not there
        metrics |= compare(measure.quantity, pictures.judged, pictures.truth, pictures.mask, [measure.metric])
    value = metrics[measure.metric]
    own = own_error(measure, truth, pictures)
    verdict: Verdict = "above" if exceeds(measure.metric, value, tolerance) else "within"
    reason = ""
    if exceeds(measure.metric, own, tolerance):
        verdict, reason = "cannot_judge", "standard_error"
    elif metrics["not_finite"]:
        verdict, reason = "above", "not_finite"
    worst = find_worst(measure, pictures, run)
    return Score(metrics, value, tolerance, verdict, reason, masked, worst, own or 0.0, pictures)


def lay_out(measure: Measure, truth: Truth, run: PassRun) -> Pictures:
    """Judged and true pixels of one shape ``[h, w, c]``; the layers of an array above each other."""
    judged = truth.judged if truth.judged is not None else run.outputs[measure.port]
    judged, value = _flat(np.asarray(judged, np.float64)), _flat(np.asarray(truth.value, np.float64))
    if judged.shape != value.shape:
        raise ValueError(f"the truth has shape {list(value.shape)}, what it judges {list(judged.shape)}")
    mask = truth.mask
    if mask is not None:
        mask = np.asarray(mask, bool).reshape(-1, mask.shape[-1])
        if mask.shape != value.shape[:2]:
            raise ValueError(f"the mask has shape {list(mask.shape)}, the truth {list(value.shape)}")
    return Pictures(judged, value, mask)


def _flat(pixels: F64) -> F64:
    """``[h, w, c]``: layers above each other, a buffer's words in one row."""
    if pixels.ndim not in (1, 3, 4):
        raise ValueError(f"an image has 3 dimensions, or 4 with layers, not the shape {list(pixels.shape)}")
    return pixels.reshape(1, -1, 1) if pixels.ndim == 1 else pixels.reshape(-1, *pixels.shape[-2:])


def own_error(measure: Measure, truth: Truth, pictures: Pictures) -> float | None:
    """The metric's value of a truth that is off by 3 of its standard errors everywhere, in the worst of the directions
    that differ; None for a truth without an error of its own.
    """
    own = np.asarray(truth.standard_error, np.float64)
    error = SIGMAS * np.broadcast_to(_flat(own) if own.ndim else own, pictures.truth.shape)
    if not error.any():
        return None
    channels = pictures.truth.shape[-1]
    # A normal moved along itself keeps its direction, so vectors are moved along every diagonal.
    vectors = measure.quantity is Quantity.NORMAL
    signs = product((1.0, -1.0), repeat=channels) if vectors else [(1.0,) * channels, (-1.0,) * channels]
    only = [measure.metric]
    moved = [pictures.truth + error * np.array(sign) for sign in signs]
    values = [compare(measure.quantity, m, pictures.truth, pictures.mask, only)[measure.metric] for m in moved]
    known = [value for value in values if value is not None]
    if not known:
        return None
    worst = known[0]
    for value in known[1:]:
        worst = value if exceeds(measure.metric, value, worst) else worst
    return worst


def find_worst(measure: Measure, pictures: Pictures, run: PassRun) -> WorstTexel | None:
    """The texel with the largest error of the metric's kind; one that is not finite is worse than any."""
    errors = error_map(measure.quantity, pictures.judged, pictures.truth, pictures.mask, measure.metric)
    place = worst_texel(errors)
    if place is None:
        return None
    x, y = place
    inputs = {}
    for port, content in run.inputs.items():
        pixels = _flat(np.asarray(content, np.float64)) if content.ndim in (3, 4) else None
        if pixels is not None and pixels.shape[:2] == errors.shape:
            inputs[port] = _texel(pixels, x, y)
    return WorstTexel(
        x, y, float(errors[y, x]), _texel(pictures.judged, x, y), _texel(pictures.truth, x, y), inputs
    )  # fmt: skip


def _texel(pixels: F64, x: int, y: int) -> tuple[float, ...]:
    return tuple(float(value) for value in pixels[y, x])
