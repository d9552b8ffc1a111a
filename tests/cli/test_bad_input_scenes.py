"""Scene files that are damaged, hostile or not there: told by file and place in it, before anything is rendered."""

import os
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import assert_refused, write_graph
from tests.scene.tiny_gltf import TinyGltf, full

SCENE_PASSES = """\
  shade: {node: forward_shading, write: {color: a, depth: depth}}
  show: {node: tonemap, read: {color: a}, write: {color: image}}
"""
RESOURCES = "  a: {format: rgba16f}\n  depth: {format: d32f}\n"


def scene_graph(folder: Path, source: str) -> Path:
    return write_graph(folder, resources=RESOURCES, passes=SCENE_PASSES, extra=f"scene: {{source: {source}}}\n")


def bomb(width: int, height: int) -> bytes:
    """A PNG that claims ``width`` x ``height`` pixels and holds 64 bytes of them."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(64))) + chunk(b"IEND", b"")
    )


def set_at(tiny: TinyGltf, pointer: str, value: Any) -> None:
    *parents, last = [int(part) if part.isdigit() else part for part in pointer.split("/")]
    target: Any = tiny.json
    for part in parents:
        target = target[part]
    target[last] = value


def nan_positions(tiny: TinyGltf) -> None:
    tiny.triangle(POSITION=tiny.accessor([[0, 0, 0], [float("nan"), 0, 0], [0, 1, 0]]))


def textured(content: bytes) -> Callable[[TinyGltf], None]:
    def build(tiny: TinyGltf) -> None:
        full(tiny)
        set_at(tiny, "materials/0/pbrMetallicRoughness/baseColorTexture", {"index": tiny.texture(content)})

    return build


def changed(pointer: str, value: Any) -> Callable[[TinyGltf], None]:
    def build(tiny: TinyGltf) -> None:
        full(tiny)
        set_at(tiny, pointer, value)

    return build


SCENES: dict[str, tuple[Callable[[TinyGltf], None], str, int, str]] = {
    "view past the buffer": (changed("bufferViews/0/byteLength", 10**6), "RG607", 1, "/bufferViews/0"),
    "count past the view": (changed("accessors/2/count", 1000), "RG607", 1, "/accessors/2"),
    "offset past the view": (changed("accessors/0/byteOffset", 1 << 40), "RG607", 1, "/accessors/0"),
    "accessor that is not there": (changed("meshes/0/primitives/0/indices", 99), "RG606", 1, "/meshes/0"),
    "NaN in positions": (nan_positions, "RG610", 1, "nan"),
    "image bomb": (textured(bomb(60000, 60000)), "RG614", 1, "3600000000"),
    "not an image": (textured(b"this is no picture"), "RG613", 1, "/images/"),
    "URI that escapes": (changed("images/0", {"uri": "../secret.png"}), "RG611", 1, "../secret.png"),
    "URI, percent-encoded": (changed("images/0", {"uri": "%2e%2e/secret.png"}), "RG611", 1, "secret.png"),
    "absolute URI": (changed("images/0", {"uri": "/etc/passwd"}), "RG611", 1, "/etc/passwd"),
    "URI of the net": (changed("images/0", {"uri": "http://example.com/x.png"}), "RG611", 1, "example.com"),
    "image that is not there": (changed("images/0", {"uri": "gone.png"}), "RG601", 2, "gone.png"),
    "unknown required extension": (changed("extensionsRequired", ["KHR_no_such"]), "RG612", 1, "KHR_no_such"),
    "glTF 1.0": (changed("asset", {"version": "1.0"}), "RG602", 2, "tiny.glb"),
}


@pytest.mark.parametrize("name", SCENES)
def test_damaged_scene(rg: Rg, tmp_path: Path, name: str) -> None:
    build, code, exit_code, named = SCENES[name]
    tiny = TinyGltf(tmp_path)
    build(tiny)
    (tmp_path / "tiny.glb").write_bytes(tiny.glb())
    graph, out = scene_graph(tmp_path, "tiny.glb"), tmp_path / "out"
    outcome = rg("render", str(graph), "-o", str(out))
    assert_refused(outcome, exit_code, code, "tiny.glb", named)
    assert not out.exists()
    assert_refused(rg("plan", str(graph)), exit_code, code, "tiny.glb")


def test_the_scene_without_damage_can_be_planned(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "tiny.glb").write_bytes(full(TinyGltf(tmp_path)).glb())
    assert rg("plan", str(scene_graph(tmp_path, "tiny.glb"))).code == 0


def test_a_glb_cut_anywhere(rg: Rg, tmp_path: Path) -> None:
    whole = full(TinyGltf(tmp_path)).glb()
    (json_length,) = struct.unpack_from("<I", whole, 12)
    cuts = {0, 1, 4, 11, 12, 19, 20, 20 + json_length // 2, 20 + json_length, 24 + json_length, len(whole) - 1}
    graph = scene_graph(tmp_path, "cut.glb")
    for cut in sorted(cuts):
        (tmp_path / "cut.glb").write_bytes(whole[:cut])
        assert_refused(rg("plan", str(graph)), 2, "RG602", "cut.glb")


@pytest.mark.parametrize("content", [b"\x00garbage" * 9, b"{", b'{"asset": {"version": "2.0"}', b"\xff{}", b"[]"])
def test_garbage_as_a_scene(rg: Rg, tmp_path: Path, content: bytes) -> None:
    for name in ("bad.glb", "bad.gltf"):
        (tmp_path / name).write_bytes(content)
        outcome = rg("plan", str(scene_graph(tmp_path, name)))
        assert_refused(outcome, 2, "RG603" if "RG603" in outcome.err else "RG602", name)


def test_json_error_of_a_gltf_has_a_position(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "bad.gltf").write_text('{\n  "asset": {"version": "2.0"},\n  "nodes": [,]\n}')
    assert_refused(rg("plan", str(scene_graph(tmp_path, "bad.gltf"))), 2, "RG603", "bad.gltf:3:13")


def test_a_scene_that_is_a_folder_or_a_pipe(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "folder.glb").mkdir()
    os.mkfifo(tmp_path / "pipe.glb")
    for name in ("folder.glb", "pipe.glb"):
        assert_refused(rg("plan", str(scene_graph(tmp_path, name))), 1, "RG651", "graph.yaml:3:", name)


def test_a_missing_scene_is_found_by_name(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "kitchen.glb").write_bytes(b"")
    assert_refused(rg("validate", str(scene_graph(tmp_path, "kitchn.glb"))), 1, "RG651", "'kitchen.glb'")


def test_unknown_camera(rg: Rg, tmp_path: Path) -> None:
    graph = scene_graph(tmp_path, "cornell, camera: {name: door}")
    assert_refused(rg("plan", str(graph)), 1, "RG652", "'door'", "graph.yaml:3:")


# ---------------------------------------------------------------- image files of resources

IMAGES: dict[str, tuple[bytes | None, str, str]] = {
    "gone.png": (None, "RG310", "gone.png"),
    "empty.png": (b"", "RG312", "empty.png"),
    "garbage.png": (b"this is no picture", "RG312", "garbage.png"),
    "cut.png": (bomb(8, 8)[:40], "RG312", "cut.png"),
    "bomb.png": (bomb(60000, 60000), "RG312", "3600000000"),
    "cut.hdr": (b"#?RADIANCE\n\n-Y 4 +X", "RG312", "cut.hdr"),
    "bomb.hdr": (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999 +X 99999\n", "RG3", "bomb.hdr"),
    "notes.txt": (b"hello", "RG312", "notes.txt"),
    "../outside.png": (None, "RG311", "../outside.png"),
}


@pytest.mark.parametrize("name", IMAGES)
def test_image_files_of_resources(rg: Rg, tmp_path: Path, name: str) -> None:
    content, code, named = IMAGES[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    graph = write_graph(
        tmp_path,
        resources=f"  a: {{format: rgba16f}}\n  picture: {{file: {name}}}\n",
        passes="  paint: {node: fullscreen, read: {u_p: picture}, write: {o_color: a}, set: {shader: paint.frag}}\n",
        outputs="{a: {file: a.png}}",
    )
    outcome = rg("validate", str(graph))
    assert outcome.code == 1
    assert code in outcome.err
    assert named in outcome.err
    assert "graph.yaml:5:" in outcome.err
    assert "help:" in outcome.err
    assert "Traceback" not in outcome.err


@pytest.mark.gpu
def test_an_image_whose_header_alone_is_sound(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "half.png").write_bytes(bomb(8, 8))
    graph = write_graph(
        tmp_path,
        resources="  a: {format: rgba16f}\n  picture: {file: half.png}\n",
        passes="  paint: {node: fullscreen, read: {u_p: picture}, write: {o_color: a}, set: {shader: paint.frag}}\n",
        outputs="{a: {file: a.png}}",
    )
    out = tmp_path / "out"
    assert_refused(rg("render", str(graph), "-o", str(out)), 2, "RG563", "half.png")
    assert not out.exists()


def test_gltf_json_bomb_of_depth(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "deep.gltf").write_text(
        '{"asset": {"version": "2.0"}, "extras": ' + "[" * 100_000 + "]" * 100_000 + "}"
    )
    assert_refused(rg("plan", str(scene_graph(tmp_path, "deep.gltf"))), 2, "RG603", "deep.gltf")
