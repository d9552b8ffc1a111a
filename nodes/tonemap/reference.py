"""The tone curves, the sRGB encoding and the dither in float64, from their definitions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.measure.truth.storage import step, storage_error
from rendergraph.node.reference import PassRun, Truth

if TYPE_CHECKING:
    from rendergraph.nodes.tonemap import TonemapParams

F64 = npt.NDArray[np.float64]

CEILING = 65504.0
_REC709 = np.array([0.2126, 0.7152, 0.0722])

# Rows.
_AGX_INSET = np.array(
    [
        [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
        [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
        [0.0423756549057051, 0.0784336, 0.879142973793104],
    ]
)
_ACES_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_ACES_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])


def srgb_encode(linear: F64) -> F64:
    """IEC 61966-2-1, linear 0..1 to encoded 0..1."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def agx_sigmoid(x: F64) -> F64:
    """Sobotka's sigmoid on 0..1 in its simplified closed form (toe power 3, shoulder power 13/4, slope 2)."""
    pivot = 20.0 / 33.0
    offset = x - pivot
    # The scales are those for which the curve meets (0, 0) and (1, 1) exactly.
    toe_scale = ((2 * pivot) ** -3.0 * ((2 * pivot / 0.5) ** 3.0 - 1.0)) ** (-1.0 / 3.0)
    run = 1.0 - pivot
    shoulder_scale = ((2 * run) ** -3.25 * ((2 * run / 0.5) ** 3.25 - 1.0)) ** (-1.0 / 3.25)
    t, s = np.maximum(-offset, 0.0) * 2 / toe_scale, np.maximum(offset, 0.0) * 2 / shoulder_scale
    toe = -toe_scale * t / np.cbrt(1.0 + t**3)
    shoulder = shoulder_scale * s / (1.0 + s**3.25) ** (1 / 3.25)
    return np.asarray(0.5 + np.where(offset < 0.0, toe, shoulder))


def agx(radiance: F64) -> F64:
    """Display-linear AgX: inset, 16.5 stops to 0..1, sigmoid, outset, gamma 2.2 decoded."""
    stops = np.log2(np.maximum(radiance @ _AGX_INSET.T, 1e-10) / 0.18)
    curved = agx_sigmoid(np.clip((stops + 10.0) / 16.5, 0.0, 1.0))
    return np.asarray(np.clip(curved @ np.linalg.inv(_AGX_INSET).T, 0.0, 1.0) ** 2.2)


def aces(radiance: F64) -> F64:
    """Display-linear ACES by Hill's fit."""
    v = radiance @ _ACES_IN.T
    curved = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.asarray(np.clip(curved @ _ACES_OUT.T, 0.0, 1.0))


def reinhard(radiance: F64, white: float) -> F64:
    """Reinhard's extended curve on luminance."""
    y = (radiance @ _REC709)[..., None]
    return np.asarray(np.clip(radiance * (1 + y / white**2) / (1 + y), 0.0, 1.0))


def tonemap(image: npt.NDArray[np.floating], curve: str, gain: float = 1.0, white: float = 4.0) -> F64:
    """sRGB-encoded ``float64[height, width, 3]`` of linear radiance, before dither and rounding.

    NaN and negatives count as 0, infinities as the ceiling.
    """
    exposed = _exposed(image, gain)
    curves: dict[str, Callable[[F64], F64]] = {
        "agx": agx,
        "aces": aces,
        "reinhard": lambda linear: reinhard(linear, white),
        "linear": lambda linear: linear,
    }
    return srgb_encode(curves[curve](exposed))


def _exposed(image: npt.NDArray[np.floating], gain: float) -> F64:
    """Radiance times the gain, 0..CEILING; where either is NaN, 0."""
    radiance = np.clip(np.nan_to_num(image[..., :3].astype(np.float64), nan=0.0, posinf=3e38, neginf=0.0), 0.0, 3e38)
    with np.errstate(invalid="ignore"):
        return np.clip(np.nan_to_num(radiance * gain, nan=0.0, posinf=CEILING, neginf=0.0), 0.0, CEILING)


# ---------------------------------------------------------------- dither


def bayer_matrix() -> F64:
    """The 8 x 8 threshold matrix by Bayer's recursion, in -0.5..0.5, ``[row, column]``."""
    matrix = np.zeros((1, 1))
    for _ in range(3):
        matrix = np.block([[4 * matrix, 4 * matrix + 2], [4 * matrix + 3, 4 * matrix + 1]])
    return np.asarray((matrix + 0.5) / 64 - 0.5)


def ordered_noise(height: int, width: int) -> F64:
    """Noise of the ordered dither, the same for all channels: ``float64[height, width, 1]``."""
    return np.tile(bayer_matrix(), (-(-height // 8), -(-width // 8)))[:height, :width, None]


def triangular_noise(height: int, width: int, frame: int, seed: int) -> F64:
    """Noise of the triangular dither, ``float64[height, width, 3]`` in -1..1."""
    key = (frame * 2 + seed * 0x9E3779B9) & 0xFFFFFFFF
    return _uniform(height, width, key) - _uniform(height, width, (key + 1) & 0xFFFFFFFF)


def dither(encoded: F64, noise: F64, step: float) -> F64:
    """Add ``noise`` of one ``step``, less where black or white is nearer than that."""
    return encoded + noise * np.minimum(step, np.minimum(encoded, 1.0 - encoded))


def _uniform(height: int, width: int, key: int) -> F64:
    """Three hashed numbers in [0, 1) a texel: pcg3d (Jarzynski and Olano 2020), upper 24 bits."""
    rows, columns = np.mgrid[:height, :width].astype(np.uint32)
    v = [columns, rows, np.full_like(rows, key)]
    v = [c * np.uint32(1664525) + np.uint32(1013904223) for c in v]
    for mixing in (False, True):
        if mixing:
            v = [c ^ (c >> np.uint32(16)) for c in v]
        v[0] = v[0] + v[1] * v[2]
        v[1] = v[1] + v[2] * v[0]
        v[2] = v[2] + v[0] * v[1]
    return np.stack([(c >> np.uint32(8)).astype(np.float64) / 2.0**24 for c in v], axis=-1)


# ---------------------------------------------------------------- judging

#: Of float32 arithmetic, in encoded colour: five roundings of a power whose slope is at most 12.92 (measured: 5e-7 on
#: llvmpipe, 1.1e-6 on an NVIDIA H200).
ARITHMETIC = 2e-5


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``color``: every texel, the dither's noise known. ``display``: the curve alone, without dither and rounding."""
    params: TonemapParams = run.params  # type: ignore[assignment]
    format = run.descs["color"].format  # type: ignore[union-attr]
    judged = _pixels(run.outputs["color"])[..., :3]
    encoded = tonemap(_pixels(run.inputs["color"]), params.curve, _gain(run), params.white)
    one = float(step(format)[0])
    value = dither(encoded, _noise(run, params.dither), one) if one else encoded
    tolerance = float(storage_error(format, np.ones(3))[0]) + ARITHMETIC
    return {
        "color": Truth(value, judged=judged, tolerance=tolerance),
        "display": Truth(
            encoded,
            judged=judged,
            tolerance=_spread(one, params.dither, encoded.shape[0] * encoded.shape[1], tolerance),
        ),
    }


def invariants(run: PassRun) -> Iterator[str]:
    """What holds for every curve: a finite display colour, opaque, and never darker for more of the same light."""
    out = _pixels(run.outputs["color"])
    if not (np.isfinite(out).all() and out.min() >= 0.0 and out.max() <= 1.0):
        yield "the output leaves 0..1"
    if not (out[..., 3] == 1.0).all():
        yield "the output's alpha is not 1"
    light = _exposed(_pixels(run.inputs["color"]), _gain(run))
    grey = (light.max(axis=-1) == light.min(axis=-1)) & (out.shape[-1] > 3)
    order = np.argsort(light[grey][:, 0], kind="stable")
    shown = out[grey][order, :3].mean(axis=-1)
    one = float(step(run.descs["color"].format)[0])  # type: ignore[union-attr]
    slack = 2.0 * (one + float(storage_error(run.descs["color"].format, np.ones(3))[0]) + ARITHMETIC)  # type: ignore[union-attr]
    if shown.size and (np.maximum.accumulate(shown) - shown).max() > slack:
        yield "a brighter grey comes out darker"


def _spread(one: float, mode: str, texels: int, rounding: float) -> float:
    """Largest root mean square of dither and rounding together, in encoded colour.

    Without dither nothing errs by more than the rounding. With it the variance is at most a quarter of a step squared,
    whatever the shade (Lipshitz, Wannamaker and Vanderkooy 1992, "Quantization and Dither": of triangular noise 1/6 and
    of rounding 1/12): half a step, four standard errors of so few texels, and the hardware's bias from the nearest.
    """
    if mode == "none" or not one:
        return rounding
    return rounding - 0.5 * one + 0.5 * one * float(1.0 + 4.0 / np.sqrt(2.0 * 3 * texels))


def _noise(run: PassRun, mode: str) -> F64:
    height, width = _pixels(run.outputs["color"]).shape[:2]
    if mode == "ordered":
        return ordered_noise(height, width)
    if mode == "triangular":
        return triangular_noise(height, width, run.index, run.frame.seed)
    return np.zeros((height, width, 1))


def _gain(run: PassRun) -> float:
    """Two to the stops asked for, times the exposure buffer's scale where one is connected."""
    params: TonemapParams = run.params  # type: ignore[assignment]
    gain = float(2.0**params.ev)
    if "exposure" in run.inputs:
        gain *= float(np.asarray(run.inputs["exposure"], np.uint32)[:1].view(np.float32)[0])
    return gain


def _pixels(content: npt.NDArray[np.float64] | npt.NDArray[np.uint32]) -> F64:
    return np.asarray(content, np.float64)
