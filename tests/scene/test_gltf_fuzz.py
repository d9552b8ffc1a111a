"""Whatever the bytes, loading ends in a scene or in a ``RenderGraphError``."""

from __future__ import annotations

import copy
import json
import struct
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tiny_gltf import TinyGltf, full

from rendergraph.document.messages import RenderGraphError
from rendergraph.scene.gltf import load_gltf
from rendergraph.scene.gpu_layout import pack_instances, pack_lights, pack_materials, place_textures

BOUNDED = settings(max_examples=150, deadline=None, derandomize=True)


@cache
def folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="gltf-fuzz-"))


@cache
def sound() -> TinyGltf:
    return full(TinyGltf(folder()))


def survives(content: bytes) -> bool:
    """Loads, packs and decodes; true if all of it succeeded. Any error but ours fails the test."""
    path = folder() / "fuzz.glb"
    path.write_bytes(content)
    try:
        scene = load_gltf(path)
        placement = place_textures(scene)
        for array in placement.arrays:
            if array.bytes < 2**20:
                array.pixels()
    except RenderGraphError:
        return False
    for packed in (pack_instances(scene), pack_materials(scene, placement), pack_lights(scene)):
        assert len(packed) % 64 == 0
    for array in (scene.positions, scene.normals, scene.tangents, scene.uv0, scene.colors):
        assert np.isfinite(array).all()
    return True


def test_the_unmutated_file_survives():
    assert survives(sound().glb())


@BOUNDED
@given(st.binary(max_size=200))
def test_random_bytes(content):
    survives(content)
    survives(b"glTF" + content)
    survives(b'{"asset":' + content)
    survives(struct.pack("<4sIII4s", b"glTF", 2, 20 + len(content), len(content), b"JSON") + content)


@BOUNDED
@given(st.data())
def test_mutated_bytes(data):
    content = bytearray(sound().glb())
    for _ in range(data.draw(st.integers(1, 8))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    end = data.draw(st.sampled_from([len(content), data.draw(st.integers(0, len(content)))]))
    survives(bytes(content[:end]))


@cache
def places() -> list[tuple[str | int, ...]]:
    """The path of every value of the sound file's JSON."""
    found: list[tuple[str | int, ...]] = []

    def walk(value, path):
        found.append(path)
        if isinstance(value, dict | list):
            for key in value if isinstance(value, dict) else range(len(value)):
                walk(value[key], (*path, key))

    walk(sound().json, ())
    return found


WRONG = st.one_of(
    st.none(), st.booleans(), st.integers(-2, 12), st.sampled_from([2**31, 2**53, 10**30, -(10**30), 0.5, 1e38, -1e38]),
    st.sampled_from(["", "x", "VEC3", "..", "\ud800", "data:,", "{0}"]), st.just([]), st.just({}),
    st.lists(st.integers(-1, 3), max_size=5), st.just([[[]]]),
)  # fmt: skip


@settings(max_examples=400, deadline=None, derandomize=True)
@given(st.data())
def test_mutated_json(data):
    tiny = copy.copy(sound())
    tiny.json = copy.deepcopy(tiny.json)
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from(places()))
        owner = tiny.json
        try:
            for key in path[:-1]:
                owner = owner[key]
            if path and data.draw(st.booleans()):
                del owner[path[-1]]
            elif path:
                owner[path[-1]] = copy.deepcopy(data.draw(WRONG))
        except (KeyError, IndexError, TypeError, AttributeError):
            continue  # an earlier mutation took it away
    survives(_glb(tiny))


def _glb(tiny: TinyGltf) -> bytes:
    """With the mutated JSON as it is, even where it is no object."""
    document = tiny.json
    document.setdefault("buffers", [{"byteLength": len(tiny.data)}])
    text = json.dumps(document).encode()
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(tiny.data), b"BIN\0") + tiny.data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def test_a_loader_without_its_checks_is_caught(monkeypatch):
    """The known-bad twin: with the index check off, an index beyond the vertices is no longer one of our errors."""
    tiny = TinyGltf(folder())
    tiny.triangle()["indices"] = tiny.accessor([0, 1, 200], "u1")
    assert not survives(tiny.glb())
    monkeypatch.setattr("rendergraph.scene.gltf.primitives.check_below", lambda *_: None)
    with pytest.raises(IndexError):
        survives(tiny.glb())
