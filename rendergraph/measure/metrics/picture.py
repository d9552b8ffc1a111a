"""Error maps as pictures to look at: black for no error, over purple and orange to pale yellow for the largest."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from rendergraph.run.image_files import write_image

F64 = npt.NDArray[np.float64]

#: Nine steps of the colour map magma (Smith and van der Walt 2015, CC0), whose lightness grows evenly; sRGB.
_MAGMA: Final = np.array(
    [
        (0x00, 0x00, 0x04),
        (0x1D, 0x11, 0x47),
        (0x51, 0x12, 0x7C),
        (0x82, 0x26, 0x81),
        (0xB6, 0x36, 0x79),
        (0xE6, 0x51, 0x64),
        (0xFB, 0x88, 0x61),
        (0xFE, 0xC2, 0x87),
        (0xFC, 0xFD, 0xBF),
    ],
    np.float64,
)
INFINITE: Final = (0, 255, 255)  # cyan, nowhere near magma
HATCH: Final = ((72, 72, 72), (104, 104, 104))  # greys
_STRIPE: Final = 4


def picture_range(errors: F64) -> tuple[float, float]:
    """What an :func:`error_picture` spans by default: 0 to the largest finite error, or to 1 where none is above 0."""
    finite = errors[np.isfinite(errors)]
    largest = float(finite.max()) if finite.size else 0.0
    return 0.0, largest if largest > 0.0 else 1.0


def error_picture(errors: F64, limits: tuple[float, float] | None = None) -> npt.NDArray[np.uint8]:
    """An error map float64[h, w] as uint8[h, w, 3], sRGB, rows as they come.

    ``limits`` are the errors shown as the first and the last colour (by default :func:`picture_range`; 0 and 1 is usual
    for FLIP); errors beyond take those colours. Infinite errors are cyan, masked texels (NaN) hatched grey.

    :raises ValueError: for limits that are no rising pair of numbers.
    """
    low, high = limits or picture_range(errors)
    if not -np.inf < low < high < np.inf:
        raise ValueError(f"no range to show errors in: {low} to {high}")
    shown = colours((np.where(np.isfinite(errors), errors, low) - low) / (high - low))
    shown[np.isinf(errors)] = INFINITE
    y, x = np.indices(errors.shape)
    stripes = np.array(HATCH, np.uint8)[(x + y) // _STRIPE % 2]
    return np.where(np.isnan(errors)[..., None], stripes, shown)


def colours(shares: F64) -> npt.NDArray[np.uint8]:
    """The colour map at 0..1 (clamped), uint8[..., 3], sRGB."""
    steps = np.linspace(0.0, 1.0, len(_MAGMA))
    clamped = np.clip(shares, 0.0, 1.0)
    return np.stack([np.interp(clamped, steps, row) + 0.5 for row in _MAGMA.T], axis=-1).astype(np.uint8)


def write_error_picture(path: Path, errors: F64, limits: tuple[float, float] | None = None) -> tuple[float, float]:
    """Write an error map, rows bottom-up, as a PNG (its first row on top), and give back the range shown.

    :raises RenderGraphError: RG560 where the file cannot be written, RG561 for a suffix other than an image's.
    """
    shown = limits or picture_range(errors)
    write_image(path, error_picture(errors, shown))
    return shown
