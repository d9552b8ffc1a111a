"""Stored texels as the numbers that a shader reads, in float64, by the rules of the OpenGL specification."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel

F64 = npt.NDArray[np.float64]


def decode(texels: npt.NDArray[Any], format: str) -> F64:
    """Texels as :func:`rendergraph.device.textures.read_texture` gives them, of any shape ``[..., channels]``.

    Unsigned normalised codes divide by their largest (GL 4.5, 2.3.5.1), signed ones too, with the lowest code clamped
    to -1; sRGB colours are decoded, their alpha is not (8.24). Integers, floats and depth are what they are.
    """
    row = FORMATS[format]
    with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
        values = texels.astype(np.float64)
    if not np.issubdtype(texels.dtype, np.integer) or row.channel in (Channel.UINT, Channel.INT):
        return values
    values = np.maximum(values / np.iinfo(texels.dtype).max, -1.0)
    if row.srgb:
        values[..., :3] = srgb_decode(values[..., :3])
    return values


def srgb_decode(encoded: F64) -> F64:
    """Linear light of sRGB values in 0..1 (IEC 61966-2-1)."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
