"""A maker of tiny glTF files for tests."""

from __future__ import annotations

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
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


def full(tiny: TinyGltf) -> TinyGltf:
    """A file that uses nearly everything, to be broken one value at a time."""
    uv = tiny.accessor([[0, 0], [1, 0], [0, 1]])
    normal = tiny.accessor([[0, 0, 1]] * 3)
    primitive = tiny.triangle(NORMAL=normal, TEXCOORD_0=uv)
    primitive.update(indices=tiny.accessor([0, 1, 2], "u2"), material=0)
    sampler = tiny.append("samplers", {"wrapS": 10497})
    texture = tiny.texture(sampler=sampler)
    transform = {"KHR_texture_transform": {"offset": [0, 0], "scale": [1, 1], "rotation": 0}}
    pbr = {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": texture, "extensions": transform}}
    emissive = {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}
    tiny.append("materials", {"pbrMetallicRoughness": pbr, "alphaMode": "MASK", "extensions": emissive})
    tiny.append("cameras", {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "zfar": 10}})
    tiny.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 1}}]}}
    joint = tiny.append("nodes", {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}})
    tiny.json["nodes"][0].update(children=[joint], translation=[0, 0, 0], rotation=[0, 0, 0, 1], scale=[1, 1, 1])
    times, values = tiny.accessor([0.0, 1.0]), tiny.accessor([[0, 0, 0], [1, 1, 1]])
    channel = {"sampler": 0, "target": {"node": joint, "path": "translation"}}
    tiny.append("animations", {"channels": [channel], "samplers": [{"input": times, "output": values}]})
    tiny.append("skins", {"joints": [joint], "inverseBindMatrices": tiny.accessor([np.eye(4).ravel()])})
    return tiny
