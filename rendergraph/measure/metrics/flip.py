"""FLIP, the difference seen when two images alternate on a screen, through the package ``flip-evaluator``.

LDR-FLIP: Andersson et al. 2020, "FLIP: a difference evaluator for alternating images"; HDR-FLIP: Andersson et al. 2021,
"Visualizing errors in rendered high dynamic range images". The evaluator prints and ends the process on arguments that
it does not like, from C++ too (a black truth), and reads beyond the end of images without exactly three channels: it is
given nothing of the kind.
"""

from __future__ import annotations

import importlib.metadata
import io
from contextlib import redirect_stdout
from dataclasses import dataclass
from math import ceil, inf, log2, pi, sqrt
from typing import Final

import numpy as np
import numpy.typing as npt

from rendergraph.document.messages import RenderGraphError, diagnose

F64 = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

#: A 0.7 m wide screen of 3840 pixels seen from 0.7 m: the papers' default, about 67.
PIXELS_PER_DEGREE: Final = 0.7 * (3840 / 0.7) * (pi / 180)

#: The evaluator squares exposed values in float32. Stops between the first and the last exposure, the whole range of
#: half floats, and the largest value under the first exposure (which the tone mapping shows as white from 11 on).
_STOPS: Final = 40.0
_WHITE: Final = 2.0**20

_LUMINANCE: Final = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True, slots=True)
class Flip:
    """One evaluation. ``map`` is float64[h, w] in 0..1 and ``mean`` its mean over the known texels, infinite (as is the
    map there) where only one image is finite, None where no texel is known. ``exposures`` are HDR-FLIP's first and
    last, in stops, and their count.
    """

    map: F64
    mean: float | None
    version: str
    pixels_per_degree: float
    exposures: tuple[float, float, int] | None = None


def flip(
    judged: F64,
    truth: F64,
    *,
    hdr: bool,
    mask: Mask | None = None,
    pixels_per_degree: float = PIXELS_PER_DEGREE,
) -> Flip:
    """Compare float64[h, w, c] images: sRGB-encoded in 0..1, or with ``hdr`` linear and at least 0; beyond is clamped.

    One channel is grey, two are red and green, of more than three the first three count. Where ``mask`` (bool[h, w]) is
    False both images are given the median colour of the known truth, so that what they hold changes nothing.

    :raises RenderGraphError: RG748 where the evaluator fails, RG749 where the package is missing.
    :raises ValueError: for pixels per degree that are no positive number.
    """
    if not 0 < pixels_per_degree < inf:
        raise ValueError(f"{pixels_per_degree} pixels per degree")
    version = flip_version()
    a, b = _three_channels(judged), _three_channels(truth)
    known = np.ones(b.shape[:2], np.bool_) if mask is None else mask
    same = ((a == b) | (np.isnan(a) & np.isnan(b))).all(axis=-1)
    finite = np.isfinite(a).all(axis=-1) & np.isfinite(b).all(axis=-1)
    usable = known & finite
    if not usable.any():
        flat = np.where(known & ~same, inf, 0.0)
        return Flip(flat, float(flat[known].mean()) if known.any() else None, version, pixels_per_degree)
    a, b = np.maximum(a, 0.0), np.maximum(b, 0.0)
    if not usable.all():
        neutral = np.median(b[usable], axis=0)
        a, b = (np.where(usable[..., None], image, neutral) for image in (a, b))
    parameters: dict[str, float] = {"ppd": float(pixels_per_degree)}
    exposures = None
    if hdr:
        exposures = automatic_exposures(b[usable] @ _LUMINANCE)
        parameters |= dict(zip(("startExposure", "stopExposure", "numExposures"), exposures, strict=True))
    limit = _WHITE * 2.0 ** -exposures[0] if exposures else 1.0
    found = _evaluate(np.minimum(a, limit), np.minimum(b, limit), "HDR" if hdr else "LDR", parameters)
    found = np.where(known & ~finite & ~same, inf, found)
    return Flip(found, float(found[known].mean()), version, pixels_per_degree, exposures)


def flip_version() -> str:
    """Version of the installed evaluator.

    :raises RenderGraphError: RG749 where it is missing.
    """
    try:
        import flip_evaluator  # noqa: F401

        return importlib.metadata.version("flip-evaluator")
    except ImportError:
        raise RenderGraphError([diagnose("RG749")], exit_code=3) from None


def automatic_exposures(luminance: F64) -> tuple[float, float, int]:
    """First and last exposure in stops and their count, for the luminances of a truth (Andersson et al. 2021): ACES
    tone mapping shows the brightest texel as 0.85 under the first and the median one under the last, a stop between
    exposures at most.
    """
    middle = luminance.size // 2  # the upper one of two, as the evaluator takes it
    brightest, median = float(luminance.max()), float(np.partition(luminance.ravel(), middle)[middle])
    if brightest <= 0.0:
        return 0.0, 0.0, 2  # all black: shown as it is
    white = log2(_aces_white())
    start = white - log2(brightest)
    stop = min(white - log2(max(median, 2.0**-23)), start + _STOPS)  # the evaluator's least median
    return start, max(start, stop), max(2, ceil(stop - start))


def _aces_white(shown: float = 0.85) -> float:
    """The value that Narkowicz's fit of ACES, with the evaluator's exposure of 0.6, shows as ``shown``."""
    a, b, c = 0.6**2 * (2.51 - shown * 2.43), 0.6 * (0.03 - shown * 0.59), -shown * 0.14
    return (-b + sqrt(b * b - 4 * a * c)) / (2 * a)


def _three_channels(image: F64) -> F64:
    channels = image.shape[-1]
    if channels == 1:
        return np.repeat(image, 3, axis=-1)
    if channels == 2:
        return np.concatenate([image, np.zeros_like(image[..., :1])], axis=-1)
    return image[..., :3]


def _evaluate(judged: F64, truth: F64, dynamic_range: str, parameters: dict[str, float]) -> F64:
    import flip_evaluator

    images = (np.ascontiguousarray(image, np.float32) for image in (truth, judged))
    said = io.StringIO()
    try:
        with redirect_stdout(said):
            found = flip_evaluator.evaluate(
                *images, dynamic_range, applyMagma=False, computeMeanError=False, parameters=parameters
            )[0]
    except (SystemExit, RuntimeError) as error:
        reason = " ".join(said.getvalue().split()) or str(error)
        raise RenderGraphError([diagnose("RG748", reason=reason)]) from None
    values: F64 = found[..., 0].astype(np.float64)
    return values
