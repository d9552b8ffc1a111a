"""Image files: PNG (sRGB), EXR (through the `exr` extra) and NPY out; PNG, JPEG and Radiance HDR in.

Arrays are ``[height, width, channels]`` with the first row at the bottom, as OpenGL has them; files have it on top.
"""

from __future__ import annotations

import importlib.util
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.output_files import IMAGE_SUFFIXES
from rendergraph.document.whole_files import whole_file
from rendergraph.plan.graph import BufferDesc, Position, Resource

Pixels = npt.NDArray[Any]


def write_image(path: Path, pixels: Pixels) -> None:
    """Write pixels by the file's suffix.

    ``.png``: uint8 is written as it is (display-referred already); anything else is clamped to 0..1 and encoded sRGB,
    NaN as magenta so that it shows. ``.exr`` keeps float16/float32; ``.npy`` keeps everything.
    Raises RenderGraphError RG561 (suffix), RG562 (no EXR library), RG560 (cannot write).
    """
    suffix = path.suffix.lower()
    if suffix not in IMAGE_SUFFIXES:
        raise RenderGraphError([diagnose("RG561", path=str(path), suffix=suffix, known=", ".join(IMAGE_SUFFIXES))], 2)
    require_writer(path.name)
    top_down = np.ascontiguousarray(pixels[::-1])
    with whole_file(path) as temporary:
        if suffix == ".png":
            _write_png(temporary, top_down)
        elif suffix == ".npy":
            np.save(temporary, top_down)
        else:
            _write_exr(temporary, top_down)


def capture_files(resource: Resource) -> tuple[str, ...]:
    """The files a captured resource is saved as, inside the output folder.

    A texture is a .png to look at, and where that loses values also an .exr (float and depth formats, when the OpenEXR
    library is there) or .npy; a buffer is a .npy of its 32-bit words, ``float32[1, words]`` (``view(np.uint32)`` for
    integers).
    """
    if isinstance(resource.desc, BufferDesc):
        return (f"{resource.name}.npy",)
    kind = FORMATS[resource.desc.format]
    if kind.channel is Channel.UNORM and kind.texel_bytes == kind.channels:
        return (f"{resource.name}.png",)
    real = kind.channel in (Channel.FLOAT, Channel.DEPTH)
    return f"{resource.name}.png", f"{resource.name}{'.exr' if real and _has_openexr() else '.npy'}"


def write_capture(folder: Path, resource: Resource, pixels: Pixels) -> list[Path]:
    """Write a captured resource as its :func:`capture_files`; the paths.

    The picture of a depth texture is stretched from its least to its greatest value: depth is seldom spread out.
    """
    paths = [folder / file for file in capture_files(resource)]
    for path in paths:
        shown = pixels
        if isinstance(resource.desc, BufferDesc):
            shown = pixels[..., 0]  # float32[1, words]
        elif path.suffix == ".png" and FORMATS[resource.desc.format].depth:
            low, high = float(pixels.min()), float(pixels.max())
            shown = (255.0 * (pixels - low) / max(high - low, 1e-30) + 0.5).astype(np.uint8)
        write_image(path, shown)
    return paths


def _has_openexr() -> bool:
    return importlib.util.find_spec("OpenEXR") is not None


def require_writer(file: str, position: Position | None = None) -> None:
    """Raise RenderGraphError RG562 where ``file`` would be an EXR and the library is not installed."""
    if file.lower().endswith(".exr"):
        try:
            import OpenEXR  # noqa: F401
        except ImportError:
            raise RenderGraphError([diagnose("RG562", position, path=file)], exit_code=3) from None


def display_pixels(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """Any pixels as uint8 for display: integers by their type's range, floats encoded sRGB, NaN magenta."""
    if pixels.dtype == np.uint8:
        return pixels
    if np.issubdtype(pixels.dtype, np.integer):
        scaled = pixels.astype(np.float64) * (255.0 / np.iinfo(pixels.dtype).max)
        return (np.maximum(scaled, 0.0) + 0.5).astype(np.uint8)
    values = pixels.astype(np.float32)
    bad = np.isnan(values).any(axis=-1)
    values = np.clip(np.nan_to_num(values, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    encoded = np.where(values <= 0.0031308, values * 12.92, 1.055 * np.power(values, 1 / 2.4) - 0.055)
    out: npt.NDArray[np.uint8] = (encoded * 255.0 + 0.5).astype(np.uint8)
    if out.shape[-1] == 4:
        out[..., 3] = (values[..., 3] * 255.0 + 0.5).astype(np.uint8)
    if bad.any() and out.shape[-1] >= 3:
        out[bad, :3] = (255, 0, 255)
    return out


def picture(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """Any pixels as ``uint8[height, width, 3]`` for looking at: grey for one channel, red and green for two."""
    shown = display_pixels(pixels)
    if shown.shape[-1] == 1:
        return np.repeat(shown, 3, axis=-1)
    if shown.shape[-1] == 2:
        return np.concatenate([shown, np.zeros_like(shown[..., :1])], axis=-1)
    return shown[..., :3]  # alpha of a finished frame means nothing to a viewer


def _write_png(path: Path, pixels: Pixels) -> None:
    from PIL import Image

    shown = picture(pixels)
    grey = pixels.shape[-1] == 1
    Image.fromarray(np.ascontiguousarray(shown[..., 0] if grey else shown)).save(path, compress_level=1)


def _write_exr(path: Path, pixels: Pixels) -> None:
    import OpenEXR

    kept = pixels if pixels.dtype in (np.float16, np.float32) else pixels.astype(np.float32)
    names = {1: "Y", 3: "RGB", 4: "RGBA"}
    channels = kept.shape[-1]
    if channels in names:
        data = kept[..., 0] if channels == 1 else kept
        named = {names[channels]: np.ascontiguousarray(data)}
    else:
        named = {"RGBA"[i]: np.ascontiguousarray(kept[..., i]) for i in range(channels)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, named) as file:
        try:
            file.write(str(path))
        except RuntimeError as error:  # the reason stands behind the quoted file name
            raise OSError(str(error).rpartition('"')[2].strip(" .")) from None


def read_image(path: Path) -> Pixels:
    """Read an image: uint8[h, w, 4] for PNG and JPEG, float32[h, w, 4] for Radiance .hdr; first row at the bottom."""
    if path.suffix.lower() == ".hdr":
        from rendergraph.run.radiance_hdr import read_hdr

        rgb = read_hdr(path)
        pixels = np.concatenate([rgb, np.ones_like(rgb[..., :1])], axis=-1)
    else:
        from PIL import Image, UnidentifiedImageError

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # a texture's limit was checked before
                with Image.open(path) as image:
                    pixels = np.asarray(image.convert("RGBA"))
        except (OSError, UnidentifiedImageError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
            raise RenderGraphError([diagnose("RG563", path=str(path), reason=str(error))], 2) from None
    return np.ascontiguousarray(pixels[::-1])
