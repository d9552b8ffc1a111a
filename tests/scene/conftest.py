"""A maker of tiny glTF files, and the optional asset folder."""

from __future__ import annotations

import base64
import io
import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as PillowImage

from rendergraph.scene.gltf import load_gltf
from rendergraph.scene.scene import Scene

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class TinyGltf:
    """A glTF file under construction: ``json`` is edited freely, ``view`` and ``accessor`` append to buffer 0."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.data = bytearray()
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}}

    def append(self, array: str, element: dict[str, Any]) -> int:
        self.json.setdefault(array, []).append(element)
        return len(self.json[array]) - 1

    def view(self, content: bytes, **extra: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        start = len(self.data)
        self.data += content
        return self.append("bufferViews", {"buffer": 0, "byteOffset": start, "byteLength": len(content), **extra})

    def accessor(self, values: Any, dtype: str = "f4", **extra: Any) -> int:
        array = np.asarray(values, dtype="<" + dtype)
        array = array.reshape(len(array), -1)
        element = {"bufferView": self.view(array.tobytes()), "componentType": COMPONENTS[dtype]}
        return self.append("accessors", {**element, "count": len(array), "type": TYPES[array.shape[1]], **extra})

    def triangle(self, **attributes: Any) -> dict[str, Any]:
        """One counter-clockwise triangle in the xy plane, drawn by one node; returns its primitive."""
        attributes.setdefault("POSITION", self.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))
        primitive = {"attributes": attributes}
        mesh = self.append("meshes", {"primitives": [primitive]})
        self.json["scenes"] = [{"nodes": [self.append("nodes", {"mesh": mesh})]}]
        return primitive

    def png(self, color: tuple[int, ...] = (255, 0, 0, 255), size: tuple[int, int] = (2, 2)) -> bytes:
        stream = io.BytesIO()
        PillowImage.new("RGBA" if len(color) == 4 else "RGB", size, color).save(stream, "PNG")
        return stream.getvalue()

    def texture(self, content: bytes | None = None, **extra: Any) -> int:
        image = self.append("images", {"bufferView": self.view(content or self.png()), "mimeType": "image/png"})
        return self.append("textures", {"source": image, **extra})

    def glb(self, version: int = 2) -> bytes:
        document = dict(self.json)
        if self.data:
            document["buffers"] = [{"byteLength": len(self.data)}, *document.get("buffers", [])[1:]]
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.data) + bytes(-len(self.data) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        return struct.pack("<4sII", b"glTF", version, 12 + len(chunks)) + chunks

    def load(self) -> Scene:
        """As .glb."""
        path = self.folder / "tiny.glb"
        path.write_bytes(self.glb())
        return load_gltf(path)

    def load_text(self) -> Scene:
        """As .gltf; the buffer is a data: URI unless the JSON has ``buffers``."""
        if self.data and "buffers" not in self.json:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
            self.json["buffers"] = [{"byteLength": len(self.data), "uri": uri}]
        path = self.folder / "tiny.gltf"
        path.write_text(json.dumps(self.json))
        return load_gltf(path)


@pytest.fixture
def tiny(tmp_path: Path) -> TinyGltf:
    return TinyGltf(tmp_path)


@pytest.fixture(scope="session")
def assets() -> Path:
    """The folder of real scenes: ``RG_ASSETS``, or ``../shared/assets`` beside the checkout; skips without it."""
    default = Path(__file__).resolve().parents[3] / "shared" / "assets"
    folder = Path(os.environ.get("RG_ASSETS", default))
    if not folder.is_dir():
        pytest.skip(f"no asset folder at {folder}")
    return folder
