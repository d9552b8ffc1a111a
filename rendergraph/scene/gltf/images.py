"""Images: PNG and JPEG, measured by their headers before anything is decoded, decoded on demand."""

from __future__ import annotations

import io
import struct

import numpy as np
import numpy.typing as npt
from PIL import Image as PillowImage

from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.gltf.uris import read_uri
from rendergraph.scene.scene import Image

MAX_PIXELS = 2**26  # of one image: 8192 x 8192, 256 MiB decoded
MAX_TOTAL_PIXELS = 2**28  # of all images of a scene, 1 GiB decoded


class EncodedImage:
    """A PNG or JPEG file in memory: size known and within limits, decoded on demand."""

    def __init__(self, content: bytes | memoryview, where: str) -> None:
        self._content = content
        self._where = where
        self.width, self.height = _measure(content, where)
        pixels = self.width * self.height
        if pixels > MAX_PIXELS:
            raise gltf_error("RG614", where, what="the image", pixels=pixels, limit=MAX_PIXELS)

    def decode(self) -> npt.NDArray[np.uint8]:
        """``uint8[height, width, 4]``, first row on top. RG613 when the data is corrupt or cut short."""
        try:
            with PillowImage.open(io.BytesIO(self._content), formats=("PNG", "JPEG")) as image:
                if image.size != (self.width, self.height):
                    raise ValueError("its size is ambiguous")
                return np.asarray(_to_8_bit(image).convert("RGBA"))
        except MemoryError:
            raise
        except Exception as error:  # Pillow's decoders raise nearly any type on damaged data
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise gltf_error("RG613", self._where, reason=reason) from None


def _to_8_bit(image: PillowImage.Image) -> PillowImage.Image:
    """Pillow clips 16-bit grey to 255 when it converts: keep the upper byte instead."""
    if image.mode.startswith("I"):
        return PillowImage.fromarray((np.asarray(image).astype(np.uint32) >> 8).astype(np.uint8))
    return image


class Images:
    """The scene's images: one entry a glTF image and encoding, so that a file used as colour and as data has two."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._sources: dict[int, EncodedImage] = {}
        self._entries: dict[tuple[int, bool], int] = {}
        self.images: list[Image] = []

    def use(self, index: int, srgb: bool) -> int:
        """Index into ``images`` of glTF image ``index`` read as colour (``srgb``) or data."""
        key = (index, srgb)
        if key not in self._entries:
            item = self._document.arrays["images"][index]
            source = self._source(index, item)
            self._entries[key] = len(self.images)
            self.images.append(Image(source, srgb, item.text("name") or f"image {index}"))
        return self._entries[key]

    def _source(self, index: int, item: Item) -> EncodedImage:
        if index not in self._sources:
            view = self._document.index(item, "bufferView", "bufferViews")
            if view is not None:
                content: bytes | memoryview = self._document.view_bytes(view)[0]
            else:
                content = read_uri(item.require("uri"), self._document.folder)
            self._sources[index] = EncodedImage(content, str(item))
            total = sum(source.width * source.height for source in self._sources.values())
            if total > MAX_TOTAL_PIXELS:
                where = f"{self._document.file}: /images"
                raise gltf_error("RG614", where, what="all images together", pixels=total, limit=MAX_TOTAL_PIXELS)
        return self._sources[index]


# ---------------------------------------------------------------- sizes, from headers alone


def _measure(content: bytes | memoryview, where: str) -> tuple[int, int]:
    magic = bytes(content[:4])
    if magic != b"\x89PNG" and magic[:2] != b"\xff\xd8":
        raise gltf_error("RG613", where, reason="it is neither PNG nor JPEG")
    try:
        size = _png_size(content) if magic == b"\x89PNG" else _jpeg_size(content)
    except struct.error:
        raise gltf_error("RG613", where, reason="it ends inside its header") from None
    if size is None:
        raise gltf_error("RG613", where, reason="its header is damaged")
    if 0 in size:
        raise gltf_error("RG613", where, reason="it has no pixels")
    return size


def _png_size(content: bytes | memoryview) -> tuple[int, int]:
    _, _, width, height = struct.unpack_from(">I4sII", content, 8)
    return width, height


def _jpeg_size(content: bytes | memoryview) -> tuple[int, int] | None:
    """Walks the segments to the start of frame (ITU T.81, B.1.1)."""
    offset = 2
    while True:
        mark, marker = struct.unpack_from(">BB", content, offset)
        if mark != 0xFF:
            return None
        if marker == 0xFF:  # fill byte
            offset += 1
            continue
        length = struct.unpack_from(">H", content, offset + 2)[0]
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            _, height, width = struct.unpack_from(">BHH", content, offset + 4)
            return width, height
        if marker == 0xDA or length < 2:
            return None
        offset += 2 + length
