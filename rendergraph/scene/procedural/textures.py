"""Tileable noise, and fields made into 8-bit images. All arrays are [row, column], row 0 on top."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import Image

F32 = npt.NDArray[np.float32]
Rgb = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Maps:
    """A material's images: base colour (sRGB, alpha), tangent-space normal, and occlusion-roughness-metallic."""

    base: Image | None = None
    normal: Image | None = None
    orm: Image | None = None
    tiles: bool = True  # False: the image ends at its upper and lower edge


def noise(rng: np.random.Generator, size: int, *, exponent: float, scale: float = 1.0, stretch: float = 1.0) -> F32:
    """Tileable noise with the power spectrum ``1 / f^exponent``, float32[size, size], mean 0.5, mostly within 0..1.

    Wavelengths above ``1 / scale`` of the image are faded out, so that repetition does not catch the eye; ``stretch``
    lengthens the grain along the columns' direction. One inverse FFT of random phases (Saupe, "Algorithms for random
    fractals", 1988: spectral synthesis) tiles by nature and costs less than a stack of interpolated octaves.
    """
    fy = np.fft.fftfreq(size, 1.0 / size).astype(np.float32)[:, None] * np.float32(stretch)
    fx = np.fft.rfftfreq(size, 1.0 / size).astype(np.float32)[None, :]
    square = fx * fx + fy * fy
    square[0, 0] = 1.0
    amplitude = square ** np.float32(-exponent / 4.0)
    if scale > 1.0:
        amplitude *= square / (square + np.float32(scale * scale))
    amplitude[0, 0] = 0.0
    phase = rng.random(amplitude.shape, dtype=np.float32) * np.float32(2.0 * np.pi)
    field = np.fft.irfft2(amplitude * np.exp(1j * phase), s=(size, size))
    return np.asarray(field * (0.2 / field.std()) + 0.5, dtype=np.float32)


def smoothstep(low: float, high: float, values: F32) -> F32:
    """Hermite step from 0 at ``low`` to 1 at ``high``."""
    t = np.clip((values - np.float32(low)) / np.float32(high - low), 0.0, 1.0).astype(np.float32)
    return np.asarray(t * t * (3.0 - 2.0 * t), dtype=np.float32)


def blend(low: Rgb | F32, high: Rgb | F32, weight: F32) -> F32:
    """Colours mixed by ``weight`` float32[r, c]: float32[r, c, 3]."""
    a, b = np.asarray(low, np.float32), np.asarray(high, np.float32)
    return a + (b - a) * weight[..., None]


def base_image(name: str, srgb: F32, alpha: F32 | None = None) -> Image:
    """Base colour: ``srgb`` float32[r, c, 3] already sRGB-encoded, 0..1."""
    pixels = np.full((*srgb.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = _bytes(srgb)
    if alpha is not None:
        pixels[..., 3] = _bytes(alpha)
    return Image(pixels, srgb=True, name=f"{name}_base")


def normal_image(name: str, height: F32, depth: float) -> Image:
    """Normal map of a tileable height field 0..1 that is ``depth`` image widths deep. Green points up the image."""
    step = np.float32(depth * height.shape[1] / 2.0)
    x = (np.roll(height, 1, axis=1) - np.roll(height, -1, axis=1)) * step
    y = (np.roll(height, -1, axis=0) - np.roll(height, 1, axis=0)) * step
    scale = (0.5 / np.sqrt(x * x + y * y + 1.0)).astype(np.float32)
    pixels = np.full((*height.shape, 4), 255, np.uint8)
    for channel, component in enumerate((x * scale, y * scale, scale)):
        pixels[..., channel] = _bytes(component + np.float32(0.5))
    return Image(pixels, srgb=False, name=f"{name}_normal")


def orm_image(name: str, roughness: F32, occlusion: F32 | float = 1.0, metallic: F32 | float = 0.0) -> Image:
    """Occlusion in red, roughness in green, metallic in blue."""
    pixels = np.full((*roughness.shape, 4), 255, np.uint8)
    for channel, values in enumerate((occlusion, roughness, metallic)):
        pixels[..., channel] = _bytes(np.asarray(values, np.float32))
    return Image(pixels, srgb=False, name=f"{name}_orm")


def _bytes(values: F32) -> npt.NDArray[np.uint8]:
    return (np.clip(values, 0.0, 1.0) * np.float32(255.0) + np.float32(0.5)).astype(np.uint8)
