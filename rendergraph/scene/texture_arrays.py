"""Groups a scene's images into texture arrays of square power-of-two layers, at most eight for one program."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from PIL import Image as PillowImage

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.scene.scene import Image, Material, Scene

U8 = npt.NDArray[np.uint8]

MAX_ARRAYS = 8
NO_ARRAY = -1
MAX_LAYERS = 2048  # GL 4.5's guaranteed MAX_ARRAY_TEXTURE_LAYERS
MAX_SIZE = 4096


@dataclass(frozen=True, slots=True)
class TextureArrayLayers:
    """One texture array: ``size`` x ``size`` texels a layer; ``images`` are the layers in order."""

    size: int
    srgb: bool
    images: tuple[Image, ...]

    @property
    def bytes(self) -> int:
        """Bytes of the first mip level of all layers, RGBA8."""
        return len(self.images) * self.size * self.size * 4

    def pixels(self) -> U8:
        """All layers, ``uint8[layers, size, size, 4]``, as stored (first row first), decoded and resampled in threads.

        ``RenderGraphError`` RG613 when an image file turns out corrupt.
        """
        stacked = np.empty((len(self.images), self.size, self.size, 4), dtype=np.uint8)

        def fill(layer: int) -> None:
            stacked[layer] = resample(self.images[layer].pixels, self.size, self.srgb)

        with ThreadPoolExecutor() as pool:
            list(pool.map(fill, range(len(self.images))))
        return stacked

    def levels(self) -> list[U8]:
        """The whole mip chain, each level ``uint8[layers, s, s, 4]`` from ``size`` down to one texel.

        Made here and not by the driver: each rounds its own way at every level, and a neutral normal then tilts by
        another angle on another renderer.
        """
        first = self.pixels()
        with ThreadPoolExecutor() as pool:
            chains = list(pool.map(lambda layer: halved(layer, self.srgb), first))
        return [first, *(np.stack(level) for level in zip(*chains, strict=True))]


@dataclass(frozen=True, slots=True)
class TexturePlacement:
    """Where every image of a scene went. ``refs``: index into ``Scene.images`` to (array, layer)."""

    arrays: list[TextureArrayLayers]
    refs: dict[int, tuple[int, int]]

    def ref(self, image: int) -> tuple[int, int] | None:
        """Array and layer of ``Scene.images[image]``; none for an image that nothing drawn uses."""
        return self.refs.get(image)

    def arrays_of(self, material: Material) -> tuple[int, ...]:
        """The array of each slot of ``Material.textures``; ``NO_ARRAY`` for an empty one."""
        places = [None if use is None else self.ref(use.image) for use in material.textures]
        return tuple(NO_ARRAY if place is None else place[0] for place in places)


def place_textures(scene: Scene) -> TexturePlacement:
    """Give each image that a drawn material uses a layer; nothing is decoded yet.

    Images share an array when they have the same size class (the power of two at or above the larger side, at most
    4096) and the same encoding. While that makes more than eight arrays, the class whose move to the next larger one
    costs the fewest bytes is merged upward. ``RenderGraphError`` RG617 when an array would have more than 2048 layers.
    """
    drawn = [scene.materials[index] for index in sorted({scene.meshes[i.mesh].material for i in scene.instances})]
    used = sorted({image for material in drawn for image in texture_images(material)})
    classes: dict[tuple[bool, int], list[int]] = {}
    for index in used:
        image = scene.images[index]
        classes.setdefault((image.srgb, size_class(image.width, image.height)), []).append(index)
    while len(classes) > MAX_ARRAYS:
        _merge_cheapest(classes)
    arrays: list[TextureArrayLayers] = []
    refs: dict[int, tuple[int, int]] = {}
    for (srgb, size), members in sorted(classes.items(), key=lambda item: (not item[0][0], item[0][1])):
        if len(members) > MAX_LAYERS:
            raise RenderGraphError(
                [
                    diagnose(
                        "RG617", where=scene.name, what="images of one size class", count=len(members), limit=MAX_LAYERS
                    )
                ]
            )
        refs.update({image: (len(arrays), layer) for layer, image in enumerate(members)})
        arrays.append(TextureArrayLayers(size, srgb, tuple(scene.images[image] for image in members)))
    return TexturePlacement(arrays, refs)


def texture_images(material: Material) -> Iterable[int]:
    """Indices into ``Scene.images`` that a material samples."""
    return [use.image for use in material.textures if use is not None]


def size_class(width: int, height: int) -> int:
    """The power of two at or above the larger side, at most ``MAX_SIZE``."""
    return int(min(MAX_SIZE, 1 << (max(width, height) - 1).bit_length()))


def _merge_cheapest(classes: dict[tuple[bool, int], list[int]]) -> None:
    def cost(step: tuple[tuple[bool, int], tuple[bool, int]]) -> int:
        small, large = step
        return len(classes[small]) * (large[1] ** 2 - small[1] ** 2)

    steps: Sequence[tuple[tuple[bool, int], tuple[bool, int]]] = [
        (small, large) for small, large in pairwise(sorted(classes)) if small[0] == large[0]
    ]
    small, large = min(steps, key=cost)
    classes[large] = sorted(classes[large] + classes.pop(small))


# ---------------------------------------------------------------- resampling

_CODES = np.arange(256) / 255.0
_DECODE = np.where(_CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4).astype(np.float32)
_STEPS = np.arange(65536) / 65535.0
_ENCODE = np.rint(
    255.0 * np.where(_STEPS <= 0.0031308, _STEPS * 12.92, 1.055 * np.maximum(_STEPS, 1e-9) ** (1 / 2.4) - 0.055)
).astype(np.uint8)


def halved(pixels: U8, srgb: bool) -> list[U8]:
    """The levels below ``uint8[s, s, 4]``, ``s`` a power of two: means of 2x2 texels, taken before any rounding.

    Colour is averaged in linear light; alpha and data as stored.
    """
    values = pixels.astype(np.float32) / np.float32(255.0)
    if srgb:
        values[..., :3] = _DECODE[pixels[..., :3]]
    levels = []
    while (half := values.shape[0] // 2) > 0:
        values = values.reshape(half, 2, half, 2, 4).mean(axis=(1, 3))
        level = np.rint(values * np.float32(255.0)).astype(np.uint8)
        if srgb:
            level[..., :3] = _ENCODE[np.rint(values[..., :3] * np.float32(65535.0)).astype(np.uint16)]
        levels.append(level)
    return levels


def resample(pixels: U8, size: int, srgb: bool) -> U8:
    """Stretch ``uint8[h, w, 4]`` to ``uint8[size, size, 4]`` with a triangle filter (area-wide when shrinking).

    Colour is filtered in linear light and encoded again; alpha and data are filtered as stored. Edges are clamped.
    """
    if pixels.shape[:2] == (size, size):
        return pixels
    planes = []
    for channel in range(4):
        plane = pixels[:, :, channel]
        linear = _DECODE[plane] if srgb and channel < 3 else plane.astype(np.float32) / np.float32(255.0)
        image = PillowImage.fromarray(linear).resize((size, size), PillowImage.Resampling.BILINEAR)
        values = np.clip(np.asarray(image), 0.0, 1.0)
        if srgb and channel < 3:
            planes.append(_ENCODE[np.rint(values * 65535.0).astype(np.uint16)])
        else:
            planes.append(np.rint(values * 255.0).astype(np.uint8))
    return np.stack(planes, axis=-1)
