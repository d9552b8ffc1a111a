"""Images of two folders, file by file: the same texels, nearly, or not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.metrics.images import ImageError, Pixels, compare_images
from rendergraph.run.image_files import read_image, require_writer

#: Root mean square error, as a share of the range, that counts as a different image: half an 8-bit step.
TOLERANCE: Final = 0.5 / 255


@dataclass(frozen=True, slots=True)
class ImageChange:
    """One image. ``status``: identical, close (within the tolerance), different, resized, missing (only before) or
    extra (only after). ``error`` is None where the texels could not be compared.
    """

    name: str
    status: str
    error: ImageError | None = None

    @property
    def worse(self) -> bool:
        """Whether the image is not what it was."""
        return self.status in ("different", "resized", "missing")


_ORDER: Final = ("missing", "resized", "different", "extra", "close", "identical")


def compare_image_files(
    before: Mapping[str, Path], after: Mapping[str, Path], tolerance: float = TOLERANCE
) -> list[ImageChange]:
    """Every image of either folder, worst first.

    :raises RenderGraphError: RG563 for a file that is no sound image, RG562 for an EXR without the library.
    """
    found = [ImageChange(name, "missing") for name in before if name not in after]
    found += [ImageChange(name, "extra") for name in after if name not in before]
    found += [_compare(name, before[name], after[name], tolerance) for name in before if name in after]
    return sorted(found, key=lambda c: (_ORDER.index(c.status), -c.error.rmse if c.error else 0.0, c.name))


def _compare(name: str, before: Path, after: Path, tolerance: float) -> ImageChange:
    truth, image = load_pixels(before), load_pixels(after)
    if truth.shape != image.shape or truth.dtype.kind != image.dtype.kind:
        return ImageChange(name, "resized")
    error = compare_images(image, truth)
    status = "identical" if error.max == 0.0 else "close" if error.rmse <= tolerance else "different"
    return ImageChange(name, status, error)


def load_pixels(path: Path) -> Pixels:
    """A written image, ``[height, width, channels]``, first row at the bottom: uint8 of a PNG, floats of EXR and NPY.

    :raises RenderGraphError: RG562, RG563.
    """
    suffix = path.suffix.lower()
    try:
        if suffix == ".npy":
            pixels = np.load(path, allow_pickle=False)
        elif suffix == ".exr":
            pixels = _load_exr(path)
        else:
            return read_image(path)
    except (OSError, ValueError, EOFError, RuntimeError) as error:
        raise RenderGraphError([diagnose("RG563", path=str(path), reason=str(error))], exit_code=2) from None
    if pixels.ndim != 3 or pixels.size == 0 or pixels.dtype.kind not in "uif":
        reason = f"it holds {pixels.dtype} {pixels.shape}, not height x width x channels"
        raise RenderGraphError([diagnose("RG563", path=str(path), reason=reason)], exit_code=2)
    return np.ascontiguousarray(pixels[::-1])


def _load_exr(path: Path) -> Pixels:
    require_writer(path.name)
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.channels()
        names = sorted(channels, key=lambda name: ("RGBA".find(name), name))  # as they were written
        return np.stack([channels[name].pixels for name in names], axis=-1)
