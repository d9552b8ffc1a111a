"""The exposure by its definition, in float64: sorted texels instead of a histogram, plain sums."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]

MIDDLE_GREY = 0.18
_REC709 = np.array([0.2126, 0.7152, 0.0722])


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
