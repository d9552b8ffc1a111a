"""The bits of a texel: numbers as a shader reads them to the bytes that store them, and back under another format.

A copy without conversion keeps bits, so between two formats of one view class it changes what they mean.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.measure.truth.decode import srgb_decode
from rendergraph.measure.truth.storage import channel_bits, srgb_encode

F64 = npt.NDArray[np.float64]
Codes = npt.NDArray[np.uint64]

#: Bits of the fraction of the unsigned floats of r11g11b10f (GL 4.5, 2.3.4.3 and 2.3.4.4): the upper bits of a half's.
_SMALL_FLOAT: Final = {11: 4, 10: 5}


def reinterpret(values: F64, source: str, destination: str) -> tuple[F64, npt.NDArray[np.bool_]]:
    """Texels of ``source`` read as ``destination``, and bool[...]: False where the values do not tell the bits, as of
    NaN and of -1 in signed normalised formats, which two codes mean.

    Both formats have texels of one size in bytes; ``values`` is float64[..., channels].
    """
    known = np.asarray(~np.isnan(values).any(axis=-1))
    if FORMATS[source].channel is Channel.SNORM:
        known &= (values > -1.0).all(axis=-1)
    texel = np.zeros((*values.shape[:-1], 2), np.uint64)  # 128 bits, the low half first
    _each_channel(texel, source, write=_codes(np.nan_to_num(values, nan=0.0), source))
    return _numbers(_each_channel(texel, destination), destination), known


def _each_channel(texel: Codes, format: str, write: Codes | None = None) -> Codes:
    """Codes of the channels, the first in the lowest bits; with ``write``, they are put there."""
    read, shift = [], 0
    for channel, bits in enumerate(channel_bits(format)):
        half, low = np.uint64(shift // 64), np.uint64(shift % 64)
        if write is not None:
            texel[..., half] |= write[..., channel] << low
        read.append(texel[..., half] >> low & np.uint64((1 << bits) - 1))
        shift += bits
    return np.stack(read, axis=-1)


def _codes(values: F64, format: str) -> Codes:
    row, bits = FORMATS[format], channel_bits(format)
    if row.srgb:
        values = np.concatenate([srgb_encode(values[..., :3]), values[..., 3:]], axis=-1)
    if row.channel is Channel.FLOAT:
        return np.stack([_float_code(values[..., i], b) for i, b in enumerate(bits)], axis=-1)
    most = {Channel.UNORM: 0, Channel.SNORM: 1}.get(row.channel)
    if most is not None:
        values = values * (2.0 ** (np.array(bits) - most) - 1.0)
    mask = np.left_shift(1, np.array(bits, np.int64)) - 1
    return np.asarray(np.round(values).astype(np.int64) & mask).astype(np.uint64)


def _numbers(codes: Codes, format: str) -> F64:
    row, bits = FORMATS[format], channel_bits(format)
    if row.channel is Channel.FLOAT:
        return np.stack([_float_number(codes[..., i], b) for i, b in enumerate(bits)], axis=-1)
    whole = codes.astype(np.float64)
    width = 2.0 ** np.array(bits)
    if row.channel in (Channel.INT, Channel.SNORM):
        whole = np.where(whole >= width / 2, whole - width, whole)
    if row.channel is Channel.SNORM:
        return np.maximum(whole / (width / 2 - 1.0), -1.0)
    if row.channel is not Channel.UNORM:
        return whole
    whole = whole / (width - 1.0)
    if row.srgb:
        whole[..., :3] = srgb_decode(whole[..., :3])
    return whole


def _float_code(values: F64, bits: int) -> Codes:
    if bits == 32:
        return values.astype(np.float32).view(np.uint32).astype(np.uint64)
    half = values.astype(np.float16).view(np.uint16).astype(np.uint64)
    return half >> np.uint64(_SMALL_FLOAT[bits]) if bits < 16 else half


def _float_number(codes: Codes, bits: int) -> F64:
    if bits == 32:
        return codes.astype(np.uint32).view(np.float32).astype(np.float64)
    half = codes << np.uint64(_SMALL_FLOAT[bits]) if bits < 16 else codes
    return half.astype(np.uint16).view(np.float16).astype(np.float64)
