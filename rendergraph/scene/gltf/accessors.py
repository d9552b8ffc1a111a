"""Accessors: typed, strided, normalised and sparse views into buffers (glTF 2.0, 3.6.2)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.scene import F32, U32

COMPONENTS: Final[dict[int, np.dtype[Any]]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS: Final = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

FLOAT = (5126,)
#: Bytes and shorts, signed or not, or floats: what KHR_mesh_quantization lets positions and texture coordinates be.
QUANTIZED = (5120, 5121, 5122, 5123, 5126)
SIGNED = (5120, 5122, 5126)
UNSIGNED = (5121, 5123, 5126)

#: An accessor may claim any count without a single byte behind it (no buffer view: zeros)...
MAX_COUNT = 2**24
#: ...and any number of them may read the same bytes: this bounds what all decode to.
MAX_DECODED_BYTES = 2**31
#: Beyond this, squares and products of coordinates leave float32.
MAX_MAGNITUDE = 1e18


class Accessors:
    """Decodes accessors of a document. ``where`` is the item that refers to one: it is named when the use is wrong."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._decoded_bytes = 0

    def count(self, where: Item) -> int:
        """How many elements the accessor referred to has."""
        return self._item(where).require("count").as_integer(1, MAX_COUNT)

    def floats(
        self, where: Item, types: tuple[str, ...], components: tuple[int, ...] = FLOAT, *, normalized_only: bool = False
    ) -> F32:
        """``float32[count, width]``, dequantised. ``normalized_only``: integers must be normalised ones.

        RG608 for a type not in ``types`` or a component type not in ``components``, RG610 for NaN, infinity or absurdly
        large values, RG607 out of bounds.
        """
        values, normalized = self._decode(where, types, components)
        if values.dtype.kind == "f":
            return _checked(values.astype(np.float32), where)
        if not normalized:
            if normalized_only:
                raise gltf_error(
                    "RG608", str(where), got="an integer accessor", expected="floats or normalised integers"
                )
            return values.astype(np.float32)
        scaled = values.astype(np.float32)
        scaled /= np.iinfo(values.dtype).max
        return np.maximum(scaled, np.float32(-1.0))

    def integers(self, where: Item, types: tuple[str, ...], components: tuple[int, ...]) -> U32:
        """``uint32[count, width]`` of unsigned integers."""
        values, _ = self._decode(where, types, components)
        return values.astype(np.uint32)

    # ---- decoding

    def _item(self, where: Item) -> Item:
        return self._document.arrays["accessors"][self._document.as_index(where, "accessors")]

    def _decode(
        self, where: Item, types: tuple[str, ...], components: tuple[int, ...]
    ) -> tuple[npt.NDArray[Any], bool]:
        accessor = self._item(where)
        kind = accessor.require("type").as_text()
        component = accessor.require("componentType").as_integer()
        normalized = accessor.boolean("normalized")
        if kind not in types or component not in components or (normalized and component in (5125, 5126)):
            names = " or ".join(str(COMPONENTS[c]) for c in components)
            got = f"an accessor of {kind[:8]!r}, component type {component}{', normalized' if normalized else ''}"
            raise gltf_error("RG608", str(where), got=got, expected=f"{' or '.join(types)} of {names}")
        count = accessor.require("count").as_integer(1, MAX_COUNT)
        dtype, width = COMPONENTS[component], WIDTHS[kind]
        self._decoded_bytes += count * width * 4
        if self._decoded_bytes > MAX_DECODED_BYTES:
            what = "bytes of decoded accessors"
            raise gltf_error("RG617", str(where), what=what, count=self._decoded_bytes, limit=MAX_DECODED_BYTES)
        view = self._document.index(accessor, "bufferView", "bufferViews")
        if view is None:
            values: npt.NDArray[Any] = np.zeros((count, width), dtype)
        else:
            values = self._strided(view, accessor.integer("byteOffset", 0), count, width, dtype, accessor)
        sparse = accessor.get("sparse")
        return (values if sparse is None else self._replace(values, sparse)), normalized

    def _strided(
        self, view: int, offset: int, count: int, width: int, dtype: np.dtype[Any], owner: Item
    ) -> npt.NDArray[Any]:
        content, stride = self._document.view_bytes(view)
        element = width * dtype.itemsize
        if stride is None:
            stride = element
        elif stride < element:
            got = f"a stride of {stride} bytes for elements of {element}"
            raise gltf_error("RG608", str(owner), got=got, expected="a stride not below the element's size")
        end = offset + stride * (count - 1) + element
        if end > len(content):
            what = f"/bufferViews/{view}"
            raise gltf_error("RG607", str(owner), start=offset, end=end, what=what, size=len(content))
        return np.ndarray((count, width), dtype, content, offset, (stride, dtype.itemsize))

    def _replace(self, values: npt.NDArray[Any], sparse: Item) -> npt.NDArray[Any]:
        count = sparse.require("count").as_integer(1, len(values))
        indices, replacements = sparse.require("indices"), sparse.require("values")
        component = indices.require("componentType").as_integer()
        if component not in (5121, 5123, 5125):
            raise gltf_error(
                "RG608", str(indices), got=f"component type {component}", expected="unsigned byte, short or int"
            )
        index_view = self._document.as_index(indices.require("bufferView"), "bufferViews")
        value_view = self._document.as_index(replacements.require("bufferView"), "bufferViews")
        width = values.shape[1]
        where = self._strided(index_view, indices.integer("byteOffset", 0), count, 1, COMPONENTS[component], indices)[
            :, 0
        ]
        check_below(where.astype(np.uint32), len(values), indices, "elements")
        result = values.copy()
        offset = replacements.integer("byteOffset", 0)
        result[where] = self._strided(value_view, offset, count, width, values.dtype, replacements)
        return result


def check_below(values: U32, limit: int, where: Item, what: str) -> None:
    """RG609 naming the first value that is not below ``limit``."""
    if values.size and int(values.max()) >= limit:
        element = int(np.argmax(values.reshape(-1) >= limit))
        value = int(values.reshape(-1)[element])
        raise gltf_error("RG609", str(where), element=element, value=value, count=limit, what=what)


def _checked(values: F32, where: Item) -> F32:
    good = np.abs(values) < MAX_MAGNITUDE  # false for NaN
    if not good.all():
        element, component = (int(i) for i in np.argwhere(~good)[0])
        value = float(values[element, component])
        raise gltf_error("RG610", str(where), element=element, value=value, limit=MAX_MAGNITUDE)
    return values
