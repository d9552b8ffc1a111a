"""The exposure by its definition, in float64: sorted texels instead of a histogram, plain sums."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from rendergraph.node.reference import PassRun, Truth

if TYPE_CHECKING:
    from rendergraph.nodes.exposure import ExposureParams

F64 = npt.NDArray[np.float64]

MIDDLE_GREY = 0.18
_REC709 = np.array([0.2126, 0.7152, 0.0722])


class Metered(NamedTuple):
    """What the exposure buffer holds (shaders/exposure.glsl)."""

    scale: float
    log_luminance: float
    measured: float
    texels: int


def read(words: npt.NDArray[np.float64] | npt.NDArray[np.uint32]) -> Metered:
    """The buffer's first 16 bytes, given as ``uint32[words]``."""
    first = np.asarray(words, np.uint32)[:4]
    scale, log_luminance, measured = (float(v) for v in first[:3].view(np.float32))
    return Metered(scale, log_luminance, measured, int(first[3]))


def log_luminances(image: npt.NDArray[np.floating], min_ev: float, max_ev: float, stride: int = 1) -> F64:
    """Log2 luminance within ``min_ev..max_ev`` of every ``stride``-th finite texel.

    ``image`` is linear radiance ``[height, width, 3 or more]``; the result is ``float64[texels]`` in stops.
    """
    texels = image[::stride, ::stride, :3].astype(np.float64).reshape(-1, 3)
    texels = texels[np.isfinite(texels).all(axis=1)]
    y = np.maximum(texels, 0.0) @ _REC709
    return np.asarray(np.clip(np.log2(np.maximum(y, 2.0 ** (min_ev - 1))), min_ev, max_ev))


def trimmed_mean(evs: F64, low: float, high: float) -> float:
    """Mean of ``evs`` between two ranks, given as fractions of their number; texels on a rank count in part.

    The histogram rounds every texel to the nearest of 256 bins without changing their order, so it is off by at most
    half a bin: ``(max_ev - min_ev) / 510`` stops.
    """
    evs = np.sort(evs)
    edges = np.arange(evs.size + 1, dtype=np.float64)
    inside = np.clip(edges, low * evs.size, high * evs.size)
    weights = np.diff(inside)
    return float(weights @ evs / weights.sum())


def scale(ev: float, compensation: float) -> float:
    """Factor that maps log2 luminance ``ev`` to middle grey, ``compensation`` stops brighter."""
    return float(2.0**compensation * MIDDLE_GREY / 2.0**ev)


def adapt(last: float, target: float, brighten: float, darken: float) -> float:
    """Log2 luminance one frame after ``last`` on the way to ``target``; a darker scene asks for a higher exposure."""
    return last + (target - last) * (brighten if target < last else darken)


# ---------------------------------------------------------------- judging

BINS = 256
#: Of float32 arithmetic, in stops: a logarithm of 24 stops and a sum of many, in pairs (measured: 4e-6).
ARITHMETIC = 5e-5


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``exposure``: the ideal, from every texel. ``meter``, ``adaptation`` and ``texels``: by definition."""
    params: ExposureParams = run.params  # type: ignore[assignment]
    image = np.asarray(run.inputs["color"], np.float64)
    now = read(run.outputs["exposure"])
    last = read(run.inputs["previous"]) if "previous" in run.inputs and params.mode != "manual" else None
    texels = _one(float(_metered(image, params).size if params.mode != "manual" else 0))
    ideal, metered = (_measure(params, image, stride, exact) for stride, exact in ((1, True), (params.stride, False)))
    followed = [_follow(params, ev, last) for ev in (ideal, metered)]
    return {
        "exposure": Truth(
            _one(params.compensation + np.log2(MIDDLE_GREY) - followed[0]),
            judged=_one(_log2(now.scale)),
            tolerance=_ideal_tolerance(params, image),
        ),
        "meter": Truth(
            _one(followed[1] if metered is None else metered),
            judged=_one(now.measured),
            tolerance=_meter_tolerance(params, image),
        ),
        "adaptation": Truth(
            np.array([[[_follow(params, now.measured if now.texels else None, last)]]]).repeat(2, axis=-1),
            judged=np.array([[[now.log_luminance, params.compensation + np.log2(MIDDLE_GREY) - _log2(now.scale)]]]),
        ),
        "texels": Truth(texels, judged=_one(float(now.texels))),
    }


def invariants(run: PassRun) -> Iterator[str]:
    """Whatever the image: a positive factor, between what the darkest and the brightest texel would ask for."""
    params: ExposureParams = run.params  # type: ignore[assignment]
    now = read(run.outputs["exposure"])
    if not 0.0 < now.scale < np.inf:
        yield f"the scale is {now.scale:g}"
    last = read(run.inputs["previous"]) if "previous" in run.inputs else None
    reach = [params.min_ev, params.max_ev, *([last.log_luminance] if last and last.scale > 0.0 else [])]
    middle = float(np.log2(MIDDLE_GREY))
    if now.texels == 0:
        reach.append(middle)
    if params.mode != "manual" and not min(reach) - 1e-3 <= now.log_luminance <= max(reach) + 1e-3:
        yield f"log luminance {now.log_luminance:g} lies outside {min(reach):g}..{max(reach):g}"
    if now.texels > np.asarray(run.inputs["color"]).shape[0] * np.asarray(run.inputs["color"]).shape[1]:
        yield f"{now.texels} texels were metered, and the image has fewer"


def _measure(params: ExposureParams, image: F64, stride: int, exact: bool) -> float | None:
    """Log2 of the average luminance, by sorted texels or, not ``exact``, by the meter's own 256 bins; None for none."""
    if params.mode == "manual":
        return None
    evs = log_luminances(image, params.min_ev, params.max_ev, stride)
    if evs.size == 0:
        return None
    if params.mode == "average":
        return float(evs.mean())
    return trimmed_mean(evs if exact else _binned(params, evs), params.low, params.high)


def _metered(image: F64, params: ExposureParams) -> F64:
    return log_luminances(image, params.min_ev, params.max_ev, params.stride)


def _binned(params: ExposureParams, evs: F64) -> F64:
    """Every value at the centre of its bin; both ends of the range are centres."""
    width = (params.max_ev - params.min_ev) / (BINS - 1)
    return np.asarray(np.floor((evs - params.min_ev) / width + 0.5) * width + params.min_ev)


def _follow(params: ExposureParams, measured: float | None, last: Metered | None) -> float:
    """Log luminance after adaptation: of the last exposure where nothing was measured, middle grey without one."""
    if last is not None and last.scale > 0.0:
        target = last.log_luminance if measured is None else measured
        return adapt(last.log_luminance, target, params.brighten, params.darken)
    return float(np.log2(MIDDLE_GREY)) if measured is None else measured


def _ideal_tolerance(params: ExposureParams, image: F64) -> float:
    """Half a bin of the histogram; where texels are left out, four standard errors of the mean of those that count."""
    tolerance = ARITHMETIC
    if params.mode == "histogram":
        tolerance += (params.max_ev - params.min_ev) / (2 * (BINS - 1))
    sampled = _metered(image, params)
    if params.stride > 1 and params.mode != "manual" and sampled.size:
        counted = max(sampled.size * (params.high - params.low if params.mode == "histogram" else 1.0), 1.0)
        tolerance += 4.0 * float(log_luminances(image, params.min_ev, params.max_ev).std()) / float(np.sqrt(counted))
    return tolerance


def _meter_tolerance(params: ExposureParams, image: F64) -> float:
    """Texels whose logarithm lies within float32's error of a bin's border may be counted in the next one."""
    if params.mode != "histogram":
        return ARITHMETIC
    evs = _metered(image, params)
    if evs.size == 0:
        return ARITHMETIC
    width = (params.max_ev - params.min_ev) / (BINS - 1)
    place = (evs - params.min_ev) / width + 0.5
    doubtful = float((np.abs(place - np.round(place)) * width < ARITHMETIC).mean())
    return ARITHMETIC + width * min(doubtful / (params.high - params.low), 1.0)


def _one(value: float) -> F64:
    return np.array([[[value]]], np.float64)


def _log2(value: float) -> float:
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.log2(np.float64(value)))
