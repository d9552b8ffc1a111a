"""How a format's texels look on the client's side: numpy dtype, channel count, and GL's transfer format and type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rendergraph.device import enums as e
from rendergraph.document.formats import FORMATS, Channel, Format


@dataclass(frozen=True, slots=True)
class Transfer:
    """Client-side layout of one texel: ``channels`` values of ``dtype``, as GL's ``format`` and ``type``."""

    dtype: DTypeLike
    channels: int
    format: int
    type: int


_GL_TYPE: Final[dict[str, int]] = {
    "uint8": e.UNSIGNED_BYTE, "int8": e.BYTE, "uint16": e.UNSIGNED_SHORT, "int16": e.SHORT, "uint32": e.UNSIGNED_INT,
    "int32": e.INT, "float16": e.HALF_FLOAT, "float32": e.FLOAT,
}  # fmt: skip
_REAL: Final = {1: e.RED, 2: e.RG, 3: e.RGB, 4: e.RGBA}
_INTEGER: Final = {1: e.RED_INTEGER, 2: e.RG_INTEGER, 4: e.RGBA_INTEGER}
#: Packed texels have no numpy dtype: they travel as the next wider one that holds every value.
_UNPACKED: Final = {"rgb10_a2": "float32", "r11g11b10f": "float32", "rgb10_a2ui": "uint16"}


def transfer(format: str, aspect: str = "color") -> Transfer:
    """The layout in which texels of a format are read and written without loss (sRGB as stored, not decoded).

    ``aspect`` ``"stencil"`` of a depth-stencil format is uint8, its depth float32.
    """
    row = FORMATS[format]
    if aspect == "stencil":
        return Transfer(np.uint8, 1, e.STENCIL_INDEX, e.UNSIGNED_BYTE)
    if row.depth:
        return Transfer(np.float32, 1, e.DEPTH_COMPONENT, e.FLOAT)
    dtype = _UNPACKED.get(format) or _dtype(row)
    table = _INTEGER if row.channel in (Channel.UINT, Channel.INT) else _REAL
    return Transfer(np.dtype(dtype), row.channels, table[row.channels], _GL_TYPE[dtype])


def _dtype(row: Format) -> str:
    bits = row.texel_bytes // row.channels * 8
    kind = {Channel.FLOAT: "float", Channel.UINT: "uint", Channel.UNORM: "uint"}.get(row.channel, "int")
    return f"{kind}{bits}"


def clear_value(format: str, value: tuple[float, float, float, float]) -> tuple[NDArray[Any], int, int]:
    """One texel for ``glClearTexImage``: data, format, type. Depth formats take depth first and stencil second.

    Values of normalised formats are 0..1 (or -1..1); integer formats take whole numbers.
    """
    row = FORMATS[format]
    if row.stencil:
        packed = np.zeros(2, np.uint32)
        packed[:1].view(np.float32)[0] = value[0]
        packed[1] = int(value[1])
        return packed, e.DEPTH_STENCIL, e.FLOAT_32_UNSIGNED_INT_24_8_REV
    if row.depth:
        return np.array(value[:1], np.float32), e.DEPTH_COMPONENT, e.FLOAT
    if row.channel is Channel.UINT:
        return np.array([int(v) for v in value], np.uint32), e.RGBA_INTEGER, e.UNSIGNED_INT
    if row.channel is Channel.INT:
        return np.array([int(v) for v in value], np.int32), e.RGBA_INTEGER, e.INT
    if row.channel is Channel.SNORM:  # NVIDIA clamps floating-point clears of these to 0..1
        layout = transfer(format)
        most = np.iinfo(layout.dtype).max
        return np.round(np.clip(value, -1.0, 1.0) * np.float64(most)).astype(layout.dtype), e.RGBA, layout.type
    return np.array(value, np.float32), e.RGBA, e.FLOAT


#: What memory nobody has written is filled with: a float value, and what stands for it in formats that cannot hold it.
Poison = Literal["nan", "inf", "1000"]
POISONS: Final[tuple[Poison, ...]] = ("nan", "inf", "1000")

#: By kind: what floats hold, normalised channels (0..1), depth, and the 32-bit words of a buffer.
_FLOAT: Final = {"nan": float("nan"), "inf": float("inf"), "1000": 1000.0}
_SHARE: Final = {"nan": 1.0, "inf": 1.0, "1000": 0.5}
_DEPTH: Final = {"nan": 0.37, "inf": 1.0, "1000": 0.63}
POISON_WORDS: Final[dict[Poison, int]] = {"nan": 0xFFFFFFFF, "inf": 0x7F800000, "1000": 0x447A0000}


def poison_value(format: str, poison: Poison = "nan") -> tuple[float, float, float, float]:
    """What a target nobody has written holds under ``--poison``: NaN, infinity or 1000 in float formats; the largest
    number in integer ones; full or half scale in normalised ones. 0 would hide.

    Depth is 0.37, 1 or 0.63 (NaN cannot be stored in unorm depth), stencil 0xA5.
    """
    row = FORMATS[format]
    if row.depth:
        return (_DEPTH[poison], 0xA5, 0.0, 0.0)
    if row.channel in (Channel.UINT, Channel.INT):
        bits = 10 if format == "rgb10_a2ui" else row.texel_bytes // row.channels * 8
        most = float(2 ** (bits - (row.channel is Channel.INT)) - 1)
        return (most, most, most, 3.0 if format == "rgb10_a2ui" else most)
    fill = (_FLOAT if row.channel is Channel.FLOAT else _SHARE)[poison]
    return (fill, fill, fill, fill)
