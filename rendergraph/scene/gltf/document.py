"""A glTF file opened: its JSON arrays, its buffers read on demand, and the notes gathered while loading."""

from __future__ import annotations

from pathlib import Path

from rendergraph.scene.gltf.container import MAX_FILE, read_container
from rendergraph.scene.gltf.items import Item, gltf_error, printable
from rendergraph.scene.gltf.uris import read_uri

#: What this loader handles. KHR_mesh_quantization only widens the component types, which are accepted anyway.
SUPPORTED = (
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
)

_ARRAYS = (
    "accessors", "animations", "buffers", "bufferViews", "cameras", "images", "materials", "meshes", "nodes",
    "samplers", "scenes", "skins", "textures",
)  # fmt: skip


class Document:
    """The parsed file. ``RenderGraphError`` from the constructor: RG601-RG605, RG612, RG616."""

    def __init__(self, path: Path) -> None:
        self.file = path.name or str(path)
        self.folder = path.parent
        self.notes: list[str] = []
        self.root, self._chunk = read_container(path)
        self._check_asset()
        self._check_extensions()
        self.arrays: dict[str, list[Item]] = {name: self.root.elements(name) for name in _ARRAYS}
        lights = self.root.extension("KHR_lights_punctual")
        self.arrays["lights"] = [] if lights is None else lights.elements("lights")
        self._buffers: dict[int, bytes] = {}

    def note(self, text: str) -> None:
        """Remember something left out or approximated; the same note is kept once."""
        if text not in self.notes:
            self.notes.append(text)

    def index(self, owner: Item, name: str, array: str) -> int | None:
        """The member ``name`` of ``owner`` as an index into ``array``; none when absent, RG606 when out of range."""
        item = owner.get(name)
        return None if item is None else self.as_index(item, array)

    def as_index(self, item: Item, array: str) -> int:
        """A value as an index into ``array``; RG606 when out of range."""
        index = item.as_integer()
        if index >= len(self.arrays[array]):
            raise gltf_error("RG606", str(item), what=array, index=index, count=len(self.arrays[array]))
        return index

    def view_bytes(self, index: int) -> tuple[memoryview, int | None]:
        """The bytes of a buffer view and its stride, none when tightly packed. RG607 when it leaves its buffer."""
        view = self.arrays["bufferViews"][index]
        buffer = self.as_index(view.require("buffer"), "buffers")
        start = view.integer("byteOffset", 0)
        end = start + view.require("byteLength").as_integer(low=1)
        content = self._buffer(buffer)
        if end > len(content):
            what = f"/buffers/{buffer}"
            raise gltf_error("RG607", str(view), start=start, end=end, what=what, size=len(content))
        stride = view.get("byteStride")
        if stride is not None and stride.as_integer(4, 252) % 4:
            raise stride.wrong("a multiple of 4")
        return memoryview(content)[start:end], None if stride is None else int(stride.value)

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self.arrays["buffers"][index]
            length = buffer.require("byteLength").as_integer(low=1)
            uri = buffer.get("uri")
            if uri is not None:
                content = read_uri(uri, self.folder)
            elif index == 0 and self._chunk is not None:
                content = self._chunk
            else:
                raise gltf_error("RG605", str(buffer), name="uri")
            total = length + sum(len(other) for other in self._buffers.values())
            if total > MAX_FILE:
                raise gltf_error("RG617", str(buffer), what="bytes of all buffers", count=total, limit=MAX_FILE)
            if len(content) < length:
                raise gltf_error("RG607", str(buffer), start=0, end=length, what="its data", size=len(content))
            self._buffers[index] = content[:length]
        return self._buffers[index]

    def _check_asset(self) -> None:
        asset = self.root.require("asset")
        version = asset.require("version").as_text()
        minimum = asset.get("minVersion")
        if not version.startswith("2.") or (minimum is not None and minimum.as_text() != "2.0"):
            raise gltf_error("RG602", self.file, reason=f"it is glTF {printable(version)}")

    def _check_extensions(self) -> None:
        for item in self.root.elements("extensionsRequired"):
            name = printable(item.as_text())
            if name not in SUPPORTED:
                supported = ", ".join(SUPPORTED)
                raise gltf_error("RG612", str(item), what="the file", extension=name, supported=supported)
        for item in self.root.elements("extensionsUsed"):
            name = printable(item.as_text())
            if name not in SUPPORTED:
                self.note(f"extension {name} is not supported and was ignored")
