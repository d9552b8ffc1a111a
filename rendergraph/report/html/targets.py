"""Textures for the page: their range and histogram, a picture to look at, and values to read, within a byte budget.

A target is reduced by keeping some texels, never by averaging, so that a value read on the page is one the renderer
wrote. Floats keep 12 bits of mantissa (relative error 2^-13), integers all of theirs.
"""

from __future__ import annotations

import base64
import io
import math
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel, Format
from rendergraph.plan.graph import Graph, TextureDesc
from rendergraph.run.result import Pixels

#: Bytes of base64 that all targets of a page may take together.
BUDGET: Final = 3_600_000
_LONGEST_SIDE: Final = 640
_SMALLEST_SIDE: Final = 24
_BINS: Final = 48
_MOST_CHANNELS: Final = 4
_MANTISSA_12: Final = np.uint32(0xFFFFF800)


@dataclass(frozen=True, slots=True)
class ChannelRange:
    """One channel as stored, over every texel: the finite extremes, and how many are not finite."""

    low: float
    high: float
    nan: int
    infinite: int


@dataclass(frozen=True, slots=True)
class TargetView:
    """A texture's ``samples`` ``[rows, columns, channels]``, its texels at :func:`_kept` rows and columns, first row at
    the bottom; and the ``ranges`` of all its texels, ``width`` x ``height``.
    """

    name: str
    width: int
    height: int
    samples: Pixels
    ranges: tuple[ChannelRange, ...]


@dataclass(slots=True)
class TargetGallery:
    """Collects textures while a run hands them out: pass :meth:`add` as ``RenderOptions.inspect``."""

    views: dict[str, TargetView] = field(default_factory=dict)

    def add(self, name: str, pixels: Pixels) -> None:
        """Keep a reduced copy of ``[height, width, channels]`` pixels, and their range."""
        height, width, _ = pixels.shape
        samples = _shrunk(pixels, _LONGEST_SIDE)
        ranges = tuple(_range(pixels[..., channel]) for channel in range(pixels.shape[-1]))
        self.views[name] = TargetView(name, width, height, samples, ranges)


def _range(plane: Pixels) -> ChannelRange:
    if not np.issubdtype(plane.dtype, np.floating):
        return ChannelRange(float(plane.min()), float(plane.max()), 0, 0)
    finite = np.isfinite(plane)
    if finite.all():
        return ChannelRange(float(plane.min()), float(plane.max()), 0, 0)
    nan = int(np.isnan(plane).sum())
    kept = plane[finite]
    low, high = (float(kept.min()), float(kept.max())) if kept.size else (0.0, 0.0)
    return ChannelRange(low, high, nan, plane.size - kept.size - nan)


def target_entries(graph: Graph, views: Mapping[str, TargetView], budget: int = BUDGET) -> list[dict[str, Any]]:
    """Everything the page says of each target; see ``page.js`` for how ``data`` is read."""
    entries: dict[str, dict[str, Any]] = {}
    left = budget
    for name in sorted(views, key=lambda name: views[name].samples.nbytes):  # what the small leave, the large may take
        entries[name] = _entry(views[name], graph.resources[name].desc, left // (len(views) - len(entries)))
        left -= len(entries[name]["png"]) + len(entries[name]["data"])
    return [entries[name] for name in views]


def _entry(view: TargetView, desc: Any, budget: int) -> dict[str, Any]:
    assert isinstance(desc, TextureDesc)
    layout = FORMATS[desc.format]
    scale = _scale(layout, view.samples.dtype)
    low, high, srgb = _shown_range(layout, view, scale)
    entry: dict[str, Any] = {
        "name": view.name,
        "layer_width": desc.width,
        "format": desc.format,
        "width": view.width,
        "height": view.height,
        "layers": desc.layers,
        "channels": view.samples.shape[-1],
        "scale": scale,
        "low": low,
        "high": high,
        "srgb": srgb,
        "ranges": [
            {"low": r.low * scale, "high": r.high * scale, "nan": r.nan, "infinite": r.infinite} for r in view.ranges
        ],
        "histogram": _histograms(view, scale, low, high),
    }
    return entry | _reduced(view, budget, scale, low, high, srgb)


def _scale(layout: Format, dtype: np.dtype[Any]) -> float:
    """What a stored number is multiplied by: 1 but for normalised integers (OpenGL 4.5 core, 2.3.5)."""
    if layout.channel in (Channel.UNORM, Channel.SNORM) and np.issubdtype(dtype, np.integer):
        return 1.0 / float(np.iinfo(dtype).max)
    return 1.0


def _shown_range(layout: Format, view: TargetView, scale: float) -> tuple[float, float, bool]:
    """The values shown black and white, and whether they are encoded sRGB (radiance is; data is not)."""
    if layout.channel is Channel.UNORM:
        return 0.0, 1.0, False
    if layout.channel is Channel.SNORM:
        return -1.0, 1.0, False
    low, high = min(r.low for r in view.ranges), max(r.high for r in view.ranges)
    colour = layout.channel is Channel.FLOAT and layout.channels >= 3
    if layout.channel is Channel.FLOAT:
        shown = view.samples[..., :3].astype(np.float64)
        finite = shown[np.isfinite(shown)]
        if finite.size:  # a few very bright texels must not turn the rest black
            low, high = (float(v) for v in np.percentile(finite, (0.5, 99.5)))
        low = min(low, 0.0) if colour or low < 0.2 * high else low
    if not high > low:
        high = low + max(1.0, abs(low))
    return low * scale, high * scale, colour


def _histograms(view: TargetView, scale: float, low: float, high: float) -> dict[str, Any]:
    """Kept samples in equal bins over the range shown, what lies beyond in the outer ones: an SVG path a channel, over
    48 x 1, heights as square roots so that small counts show.
    """
    counts = []
    for channel in range(min(_MOST_CHANNELS, view.samples.shape[-1])):
        plane = view.samples[..., channel].astype(np.float64) * scale
        counts.append(np.histogram(np.clip(plane[np.isfinite(plane)], low, high), _BINS, (low, high))[0].tolist())
    most = max((max(plane) for plane in counts), default=0) or 1
    paths = ["".join(f"V{1 - math.sqrt(c / most):.3f}H{x}" for x, c in enumerate(plane, 1)) for plane in counts]
    beyond = (min(r.low for r in view.ranges) * scale < low, max(r.high for r in view.ranges) * scale > high)
    return {"beyond": beyond, "paths": [f"M0 1{path}V1Z" for path in paths]}


# ---------------------------------------------------------------- bytes


def _reduced(view: TargetView, budget: int, scale: float, low: float, high: float, srgb: bool) -> dict[str, Any]:
    """The picture and the values at the largest size that fits ``budget`` bytes of base64."""
    height, width, _ = view.samples.shape
    guess = view.samples.size * min(4, view.samples.dtype.itemsize)
    side = max(width, height) * min(1.0, 1.3 * math.sqrt(budget / guess))
    while True:
        side = max(side, _SMALLEST_SIDE)
        kept = _shrunk(view.samples, side)[::-1]  # files and canvases have the first row on top
        picture, data = _png(kept, scale, low, high, srgb), _packed(kept)
        size = (len(picture) + len(data)) * 4 // 3
        if size <= budget or side <= _SMALLEST_SIDE:
            break
        side *= 0.97 * math.sqrt(budget / size)
    return {
        "columns": kept.shape[1],
        "rows": kept.shape[0],
        "samples": [width, height],
        "type": _kind(kept.dtype),
        "png": "data:image/png;base64," + base64.b64encode(picture).decode(),
        "data": base64.b64encode(data).decode(),
    }


def _shrunk(pixels: Pixels, side: float) -> Pixels:
    """A copy whose longer side is at most ``side``."""
    height, width, _ = pixels.shape
    ratio = min(1.0, side / max(height, width))
    rows, columns = (_kept(count, max(1, round(count * ratio))) for count in (height, width))
    return pixels[rows][:, columns]


def _kept(count: int, wanted: int) -> npt.NDArray[np.int64]:
    """The middles of ``wanted`` equal parts of ``count`` samples; ``page.js`` computes the same."""
    return (2 * np.arange(wanted) + 1) * count // (2 * wanted)


def _kind(dtype: np.dtype[Any]) -> str:
    """How the page reads a number: ``f4``, or integers as numpy writes them (``u1``, ``i2``, ...)."""
    return "f4" if np.issubdtype(dtype, np.floating) else f"{dtype.kind}{dtype.itemsize}"


def _packed(samples: Pixels) -> bytes:
    """Channel planes with all first bytes first, then all second bytes and so on, little-endian, deflated (zlib)."""
    planes = np.ascontiguousarray(np.moveaxis(samples[..., :_MOST_CHANNELS], -1, 0))
    if np.issubdtype(planes.dtype, np.floating):
        words = planes.astype("<f4").view("<u4")
        rounded = (words + np.uint32(0x400)) & _MANTISSA_12
        overflows = ~np.isfinite(rounded.view("<f4")) | ~np.isfinite(planes)
        planes = np.where(overflows, words & _MANTISSA_12 | np.isnan(planes), rounded).astype("<u4")
    raw = planes.astype(planes.dtype.newbyteorder("<")).view(np.uint8).reshape(-1, planes.dtype.itemsize)
    return zlib.compress(np.ascontiguousarray(raw.T).tobytes(), 6)


def _png(samples: Pixels, scale: float, low: float, high: float, srgb: bool) -> bytes:
    """As ``page.js`` paints it at first: one channel grey, two red and green; NaN magenta, infinities at the ends."""
    from PIL import Image

    values = samples[..., :3].astype(np.float64) * scale
    bad = np.isnan(values).any(axis=-1)
    ratio = np.clip((np.nan_to_num(values, nan=low, posinf=high, neginf=low) - low) / (high - low), 0.0, 1.0)
    if srgb:
        ratio = np.where(ratio <= 0.0031308, ratio * 12.92, 1.055 * np.power(ratio, 1 / 2.4) - 0.055)
    shown = (ratio * 255.0 + 0.5).astype(np.uint8)
    if shown.shape[-1] == 2:
        shown = np.concatenate([shown, np.zeros_like(shown[..., :1])], axis=-1)
    if bad.any():
        shown = np.repeat(shown, 3, axis=-1) if shown.shape[-1] == 1 else shown
        shown[bad] = (255, 0, 255)
    image = Image.fromarray(shown[..., 0] if shown.shape[-1] == 1 else shown)
    buffer = io.BytesIO()
    image.save(buffer, "PNG", compress_level=6)
    return buffer.getvalue()
