"""How far a stored texel may be from the number to be stored: what a format and the hardware's rounding cost."""

from __future__ import annotations

from typing import Final

import numpy as np

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.measure.truth.decode import F64

#: Steps by which a normalised code may miss the exact value. Rounding to the nearest code misses by 0.5; OpenGL 4.5
#: (2.3.5.1) asks for no more than that it be near: NVIDIA's render targets miss by up to 0.56, llvmpipe's by
#: 0.94 in 10 bits and by 0.64 in sRGB, whose curve it approximates. Codes of 24 bits are as fine as float32 itself.
ROUNDING: Final = 0.56
_ROUGHER: Final = {"rgb10_a2": 1.0, "d24": 1.0, "d24s8": 1.0, "srgb8_a8": 0.7}

#: Bits of a channel where they do not follow from the texel's bytes.
_BITS: Final = {"rgb10_a2": (10, 10, 10, 2), "r11g11b10f": (11, 11, 10), "rgb10_a2ui": (10, 10, 10, 2)}
#: Bits of the fraction of a float of so many bits, its smallest normal exponent, and its largest value.
_FRACTION: Final = {16: 10, 11: 6, 10: 5}
_LEAST_EXPONENT: Final = {16: -14, 11: -14, 10: -14}
_LARGEST: Final = {32: float(np.finfo(np.float32).max), 16: 65504.0, 11: 65024.0, 10: 64512.0}


def channel_bits(format: str) -> tuple[int, ...]:
    """Bits of each colour channel; of the depth alone for depth formats."""
    row = FORMATS[format]
    if row.depth:
        return ({"d16": 16, "d24": 24, "d24s8": 24}.get(format, 32),)
    return _BITS.get(format) or (row.texel_bytes * 8 // row.channels,) * row.channels


def step(format: str) -> F64:
    """Distance of two neighbouring codes of each channel, float64[channels]; 0 for formats without a fixed one."""
    row = FORMATS[format]
    bits = np.array(channel_bits(format), np.float64)
    if row.channel is Channel.UNORM or (row.depth and bits[0] < 32):
        return 1.0 / (2.0**bits - 1.0)
    if row.channel is Channel.SNORM:
        return 1.0 / (2.0 ** (bits - 1.0) - 1.0)
    return np.zeros(len(bits))


def rounding(format: str) -> float:
    """Steps by which a stored channel may miss the exact value, see :func:`steps`. Normalised codes miss by
    :data:`ROUNDING`; floats of less than 32 bits by one, since truncation is allowed (2.3.3.1) and done by llvmpipe;
    whole numbers and float32 by nothing.
    """
    row = FORMATS[format]
    if step(format).any():
        return _ROUGHER.get(format, ROUNDING)
    return 0.0 if row.channel in (Channel.UINT, Channel.INT) or channel_bits(format)[0] == 32 else 1.0


def steps(format: str, values: F64) -> F64:
    """How far the next code lies from each of ``values`` (float64[..., channels], within the format's range), of their
    shape: a code of normalised formats (decoded for sRGB colours), a unit in the last place of floats; 1 for whole
    numbers and for float32.
    """
    row = FORMATS[format]
    codes = step(format)[: values.shape[-1]]
    if codes.any():
        size = np.broadcast_to(codes, values.shape).copy()
        if row.srgb:
            # The slope of the decoding at the far end of the code's step: it grows with the value.
            encoded = np.minimum(srgb_encode(values[..., :3]) + codes[0], 1.0)
            size[..., :3] *= np.where(encoded <= 0.04045, 1 / 12.92, 2.4 / 1.055 * ((encoded + 0.055) / 1.055) ** 1.4)
        return size
    if rounding(format) == 0.0:
        return np.ones_like(values)
    bits = channel_bits(format)[: values.shape[-1]]
    fraction, least = (np.array([table[b] for b in bits], np.float64) for table in (_FRACTION, _LEAST_EXPONENT))
    magnitude = np.where(np.isfinite(values), np.abs(values), 0.0)
    exponent = np.maximum(np.floor(np.log2(np.maximum(magnitude, 2.0**-200))), least)
    return np.asarray(2.0 ** (exponent - fraction))


def storage_error(format: str, values: F64) -> F64:
    """Largest error of ``values`` once stored, of their shape: :func:`rounding` times :func:`steps`."""
    return rounding(format) * steps(format, values)


def held(format: str, values: F64) -> F64:
    """``values`` moved into the range that a format holds, float64[..., channels]; whole numbers and depth as given."""
    row = FORMATS[format]
    if row.channel is Channel.UNORM:
        return np.clip(values, 0.0, 1.0)
    if row.channel is Channel.SNORM:
        return np.clip(values, -1.0, 1.0)
    if row.channel is not Channel.FLOAT:
        return np.array(values)
    most = np.array([_LARGEST[bits] for bits in channel_bits(format)[: values.shape[-1]]])
    return np.clip(values, 0.0 if format == "r11g11b10f" else -most, most)


def srgb_encode(linear: F64) -> F64:
    """Linear light as sRGB values in 0..1 (IEC 61966-2-1)."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
