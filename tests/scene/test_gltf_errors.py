"""Everything wrong with a file is a diagnostic of a stable code that names the place."""

from __future__ import annotations

import json
import os
import struct

import numpy as np
import pytest
from tiny_gltf import full

from rendergraph.document.messages import RenderGraphError
from rendergraph.scene.gltf import load_gltf


def code_of(load, *arguments):
    with pytest.raises(RenderGraphError) as caught:
        load(*arguments)
    (diagnostic,) = caught.value.diagnostics
    return diagnostic.code, diagnostic.data.get("where", "")


def load_bytes(folder, content, name="bad.glb"):
    (folder / name).write_bytes(content)
    return load_gltf(folder / name)


# ---------------------------------------------------------------- the container


def test_missing_file_and_directory(tmp_path):
    assert code_of(load_gltf, tmp_path / "absent.glb")[0] == "RG601"
    assert code_of(load_gltf, tmp_path)[0] == "RG601"
    assert code_of(load_gltf, tmp_path / "with\0zero.glb")[0] == "RG601"
    os.mkfifo(tmp_path / "pipe.glb")  # reading one would never end
    assert code_of(load_gltf, tmp_path / "pipe.glb")[0] == "RG601"


@pytest.mark.parametrize("content", [b"", b"\x00\x01\x02 garbage", b"glTF", b"glTF\x02\x00\x00\x00\x14", b"[1, 2]"])
def test_not_gltf(tmp_path, content):
    assert code_of(load_bytes, tmp_path, content)[0] == "RG602"


def test_damaged_glb(tiny, tmp_path):
    tiny.triangle()
    sound = tiny.glb()
    assert load_bytes(tmp_path, sound).triangles == 1
    json_length = struct.unpack_from("<I", sound, 12)[0]
    binary = 20 + json_length
    damaged = {
        "version 1": sound[:4] + struct.pack("<I", 1) + sound[8:],
        "cut short": sound[:-4],
        "JSON chunk past the end": sound[:12] + struct.pack("<I", len(sound)) + sound[16:],
        "binary chunk past the end": sound[:binary] + struct.pack("<I", 2**31) + sound[binary + 4 :],
        "first chunk is not JSON": sound[:16] + b"BIN\0" + sound[20:],
        "no chunks": struct.pack("<4sII", b"glTF", 2, 12) + bytes(8),
    }
    for name, content in damaged.items():
        assert code_of(load_bytes, tmp_path, content)[0] == "RG602", name


@pytest.mark.parametrize(
    "text",
    [
        b'{"asset": ',
        b'{"asset": \xff}',
        b'{"asset": NaN}',
        b'{"asset": 1e999}',
        b'{"asset": ' + b"9" * 5000 + b"}",
        b'{"a":' * 100_000,
        b'{"a":' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    ],
)
def test_broken_json(tmp_path, text):
    assert code_of(load_bytes, tmp_path, text, "bad.gltf")[0] == "RG603"


def test_json_error_has_line_and_column(tmp_path):
    with pytest.raises(RenderGraphError) as caught:
        load_bytes(tmp_path, b'{\n  "asset": nothing\n}', "bad.gltf")
    position = caught.value.diagnostics[0].position
    assert (position.line, position.column) == (2, 12)


@pytest.mark.parametrize(
    ("document", "code"),
    [
        ({}, "RG605"),
        ({"asset": {}}, "RG605"),
        ({"asset": {"version": "1.0"}}, "RG602"),
        ({"asset": {"version": "2.0", "minVersion": "2.1"}}, "RG602"),
        ({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}, "RG612"),
        ({"asset": {"version": 2.0}}, "RG604"),
        ({"asset": {"version": "2.0"}, "nodes": {}}, "RG604"),
        ({"asset": {"version": "2.0"}, "scene": 0}, "RG606"),
        ({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}]}, "RG606"),
        ({"asset": {"version": "2.0"}, "extensions": {"KHR_lights_punctual": []}}, "RG604"),
    ],
)
def test_wrong_document(tmp_path, document, code):
    assert code_of(load_bytes, tmp_path, json.dumps(document).encode(), "bad.gltf")[0] == code


def test_unknown_used_extension_is_a_note(tiny):
    tiny.triangle()
    tiny.json["extensionsUsed"] = ["KHR_materials_unlit", "EXT_unheard_of\ud800"]
    assert ["EXT_unheard_of" in note for note in tiny.load().notes] == [True]


# ---------------------------------------------------------------- values in the JSON

TEXTURED = "/materials/0/pbrMetallicRoughness/baseColorTexture"


def set_at(document, pointer, value):
    *parents, last = [int(p) if p.isdigit() else p for p in pointer.split("/")[1:]]
    for key in parents:
        document = document[key]
    if value is ...:
        del document[last]
    else:
        document[last] = value


def test_full_file_is_sound(tiny):
    assert full(tiny).load().notes == []


@pytest.mark.parametrize(
    ("pointer", "value", "code"),
    [
        ("/nodes/0/mesh", "0", "RG604"),
        ("/nodes/0/mesh", True, "RG604"),
        ("/nodes/0/mesh", 1.5, "RG604"),
        ("/nodes/0/mesh", -1, "RG604"),
        ("/nodes/0/mesh", 7, "RG606"),
        ("/nodes/0/mesh", None, "RG604"),
        ("/nodes/0/children", [9], "RG606"),
        ("/nodes/0/children", [1, 1], "RG615"),
        ("/nodes/0/children", [0], "RG615"),
        ("/nodes/1/children", [0], "RG615"),
        ("/nodes/0/translation", [0, 0], "RG604"),
        ("/nodes/0/translation", [0, 0, "x"], "RG604"),
        ("/nodes/0/translation", [0, 0, 10**400], "RG604"),
        ("/nodes/0/translation", [0, 0, 10**60], "RG604"),
        ("/nodes/0/scale", [1e30, 1, 1], "RG610"),
        ("/nodes/0/rotation", [0, 0, 0, 0], "RG604"),
        ("/nodes/0/matrix", [1] * 16, "RG604"),
        ("/nodes/0/name", 5, "RG604"),
        ("/scenes/0/nodes", [0, 0], "RG615"),
        ("/meshes/0/primitives", ..., "RG605"),
        ("/meshes/0/primitives/0", [], "RG604"),
        ("/meshes/0/primitives/0/mode", 7, "RG604"),
        ("/meshes/0/primitives/0/material", 1, "RG606"),
        ("/meshes/0/primitives/0/indices", 99, "RG606"),
        ("/meshes/0/primitives/0/indices", 0, "RG608"),
        ("/meshes/0/primitives/0/attributes/POSITION", 3, "RG608"),
        ("/meshes/0/primitives/0/attributes/NORMAL", 4, "RG608"),
        ("/meshes/0/primitives/0/attributes/TEXCOORD_0", 1, "RG608"),
        ("/accessors/0/count", 0, "RG604"),
        ("/accessors/0/count", 10**12, "RG604"),
        ("/accessors/0/count", 4, "RG608"),
        ("/accessors/0/componentType", 5124, "RG608"),
        ("/accessors/0/type", "VEC9", "RG608"),
        ("/accessors/0/normalized", "no", "RG604"),
        ("/accessors/0/normalized", True, "RG608"),
        ("/accessors/0/byteOffset", 4, "RG607"),
        ("/accessors/0/byteOffset", -4, "RG604"),
        ("/accessors/0/bufferView", 99, "RG606"),
        ("/bufferViews/2/byteLength", 35, "RG607"),
        ("/bufferViews/0/byteLength", 10**9, "RG607"),
        ("/bufferViews/0/byteOffset", 10**9, "RG607"),
        ("/bufferViews/2/byteStride", 8, "RG608"),
        ("/bufferViews/0/byteStride", 13, "RG604"),
        ("/bufferViews/0/byteStride", 256, "RG604"),
        ("/bufferViews/0/byteStride", 16, "RG607"),
        ("/bufferViews/0/buffer", 1, "RG606"),
        ("/materials/0/alphaMode", "CUTOUT", "RG604"),
        ("/materials/0/doubleSided", 1, "RG604"),
        ("/materials/0/pbrMetallicRoughness", "shiny", "RG604"),
        ("/materials/0/pbrMetallicRoughness/metallicFactor", 2, "RG604"),
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", [1, 1, 1], "RG604"),
        ("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", -1, "RG604"),
        (f"{TEXTURED}/index", 5, "RG606"),
        (f"{TEXTURED}/texCoord", "0", "RG604"),
        (f"{TEXTURED}/extensions/KHR_texture_transform/offset", 3, "RG604"),
        ("/textures/0/source", 3, "RG606"),
        ("/textures/0/sampler", 3, "RG606"),
        ("/samplers/0/wrapS", 1, "RG604"),
        ("/samplers/0/minFilter", 1, "RG604"),
        ("/images/0/bufferView", 0, "RG613"),
        ("/images/0/bufferView", ..., "RG605"),
        ("/cameras/0/type", "fisheye", "RG604"),
        ("/cameras/0/perspective/yfov", 4, "RG604"),
        ("/cameras/0/perspective/znear", 0, "RG604"),
        ("/cameras/0/perspective/zfar", 0.05, "RG604"),
        ("/cameras/0/perspective", ..., "RG605"),
        ("/extensions/KHR_lights_punctual/lights/0/type", "area", "RG604"),
        ("/extensions/KHR_lights_punctual/lights/0/spot", ..., "RG605"),
        ("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", 2, "RG604"),
        ("/extensions/KHR_lights_punctual/lights/0/range", 0, "RG604"),
        ("/nodes/1/extensions/KHR_lights_punctual/light", 1, "RG606"),
        ("/skins/0/joints", [], "RG604"),
        ("/skins/0/joints", [1, 1], "RG608"),
        ("/skins/0/inverseBindMatrices", 0, "RG608"),
        ("/animations/0/channels/0/sampler", 1, "RG606"),
        ("/animations/0/channels/0/target/path", "color", "RG604"),
        ("/animations/0/samplers/0/interpolation", "SMOOTH", "RG604"),
        ("/animations/0/samplers/0/output", 0, "RG608"),
    ],
)
def test_one_wrong_value(tiny, pointer, value, code):
    set_at(full(tiny).json, pointer, value)
    found, where = code_of(tiny.load)
    assert found == code
    assert where.startswith("tiny.glb: /")


def test_error_names_file_and_json_path(tiny):
    set_at(full(tiny).json, "/meshes/0/primitives/0/attributes/POSITION", 77)
    assert code_of(tiny.load) == ("RG606", "tiny.glb: /meshes/0/primitives/0/attributes/POSITION")


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30])
def test_unusable_positions(tiny, value):
    tiny.triangle(POSITION=tiny.accessor([[0, 0, 0], [1, value, 0], [0, 1, 0]]))
    assert code_of(tiny.load) == ("RG610", "tiny.glb: /meshes/0/primitives/0/attributes/POSITION")


def test_index_beyond_the_vertices(tiny):
    tiny.triangle()["indices"] = tiny.accessor([0, 1, 3], "u1")
    assert code_of(tiny.load)[0] == "RG609"


@pytest.mark.parametrize("count", [1, 2, 4])
def test_no_whole_triangles(tiny, count):
    tiny.triangle()["indices"] = tiny.accessor([0, 1, 2, 0][:count], "u1")
    assert code_of(tiny.load)[0] == "RG616"


def test_attributes_of_different_lengths(tiny):
    tiny.triangle(NORMAL=tiny.accessor([[0, 0, 1]] * 2))
    assert code_of(tiny.load)[0] == "RG608"


def test_unnormalised_integer_normals(tiny):
    tiny.triangle(NORMAL=tiny.accessor([[0, 0, 1]] * 3, "i2", bufferView=tiny.view(bytes(24), byteStride=8)))
    assert code_of(tiny.load)[0] == "RG608"


@pytest.mark.parametrize(("component", "index", "code"), [(5121, 3, "RG609"), (5126, 0, "RG608")])
def test_bad_sparse_indices(tiny, component, index, code):
    values = {"bufferView": tiny.view(bytes(12))}
    indices = {"bufferView": tiny.view(bytes([index])), "componentType": component}
    sparse = {"count": 1, "indices": indices, "values": values}
    tiny.triangle(POSITION=tiny.accessor([[0, 0, 0]] * 3, sparse=sparse))
    assert code_of(tiny.load)[0] == code


def test_joint_that_the_skin_lacks(tiny):
    weights = tiny.accessor([[1, 0, 0, 0]] * 3)
    tiny.triangle(JOINTS_0=tiny.accessor([[0, 1, 0, 0]] * 3, "u1"), WEIGHTS_0=weights)
    tiny.append("skins", {"joints": [0]})
    tiny.json["nodes"][0]["skin"] = 0
    assert code_of(tiny.load)[0] == "RG609"


def test_two_parents(tiny):
    tiny.triangle()
    tiny.json["nodes"] = [{"children": [2]}, {"children": [2]}, {}]
    assert code_of(tiny.load) == ("RG615", "tiny.glb: /nodes/2")


def test_deep_hierarchy_is_fine_and_a_long_cycle_is_found(tiny):
    tiny.triangle()
    count = 5000
    tiny.json["nodes"] = [{"children": [i + 1], "mesh": 0} for i in range(count)] + [{}]
    assert len(tiny.load().instances) == count
    tiny.json["nodes"][-1]["children"] = [1]
    assert code_of(tiny.load)[0] == "RG615"


def test_keyframes_that_go_back_in_time(tiny):
    times, values = tiny.accessor([1.0, 0.5]), tiny.accessor([[0, 0, 0]] * 2)
    tiny.append("nodes", {})
    channel = {"sampler": 0, "target": {"node": 0, "path": "scale"}}
    tiny.append("animations", {"channels": [channel], "samplers": [{"input": times, "output": values}]})
    assert code_of(tiny.load)[0] == "RG616"


def test_claims_without_data_do_not_allocate(tiny):
    """Accessors without a buffer view are zeros: many of the largest allowed count are refused before decoding."""
    zeros = [tiny.append("accessors", {"componentType": 5126, "count": 2**24, "type": "VEC3"}) for _ in range(2)]
    primitive = tiny.triangle()
    tiny.json["meshes"][0]["primitives"] = [primitive, {"attributes": {"POSITION": zeros[0]}}]
    assert code_of(tiny.load)[0] == "RG617"


def test_too_many_instances(tiny, monkeypatch):
    monkeypatch.setattr("rendergraph.scene.gltf.load.MAX_INSTANCES", 3)
    primitive = tiny.triangle()
    tiny.json["meshes"][0]["primitives"] = [primitive] * 4
    assert code_of(tiny.load)[0] == "RG617"


# ---------------------------------------------------------------- URIs


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin", "a/../../secret.bin", "%2e%2e/secret.bin", "%2e%2e%2fsecret.bin", "/etc/passwd",
        "%2Fetc/passwd", "\\\\host\\share", "file:///etc/passwd", "http://example.org/a.bin",
        "HTTPS://example.org", "c:/a.bin",
        "data:application/octet-stream;base64,@@@",
        "data:no-comma", "", ".", "..", "a%00b.bin", "link.bin", "loop.bin",
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["buffers", "images"])
def test_forbidden_uris(tiny, uri, kind):
    outside = tiny.folder.parent / "secret.bin"
    outside.write_bytes(bytes(100))
    (tiny.folder / "link.bin").symlink_to(outside)
    (tiny.folder / "loop.bin").symlink_to("loop.bin")
    full(tiny)
    if kind == "buffers":
        tiny.json["buffers"] = [{"byteLength": len(tiny.data), "uri": uri}]
        assert code_of(tiny.load_text) == ("RG611", "tiny.gltf: /buffers/0/uri")
    else:
        tiny.json["images"] = [{"uri": uri}]
        assert code_of(tiny.load_text) == ("RG611", "tiny.gltf: /images/0/uri")


def test_links_and_dots_inside_the_folder_are_fine(tiny):
    tiny.triangle()
    (tiny.folder / "sub").mkdir()
    (tiny.folder / "data.bin").write_bytes(tiny.data)
    (tiny.folder / "sub" / "link.bin").symlink_to("../data.bin")
    tiny.json["buffers"] = [{"byteLength": len(tiny.data), "uri": "sub/../sub/link.bin"}]
    assert tiny.load_text().triangles == 1


def test_missing_directory_and_short_buffer_files(tiny):
    tiny.triangle()
    (tiny.folder / "folder.bin").mkdir()
    (tiny.folder / "short.bin").write_bytes(tiny.data[:-1])
    for uri, code in (("absent.bin", "RG601"), ("folder.bin", "RG601"), ("short.bin", "RG607")):
        tiny.json["buffers"] = [{"byteLength": len(tiny.data), "uri": uri}]
        assert code_of(tiny.load_text)[0] == code
    tiny.json["buffers"] = [{"byteLength": len(tiny.data)}]  # a .gltf has no binary chunk to stand in
    assert code_of(tiny.load_text)[0] == "RG605"


def test_many_accessors_over_the_same_bytes(tiny, monkeypatch):
    monkeypatch.setattr("rendergraph.scene.gltf.accessors.MAX_DECODED_BYTES", 100)
    tiny.triangle()  # 36 bytes of positions
    assert tiny.load().triangles == 1
    sampler = {"input": tiny.accessor([0.0, 1.0]), "output": tiny.accessor([[0, 0, 0]] * 2)}
    channels = [{"sampler": 0, "target": {"node": 0, "path": "scale"}}] * 3
    tiny.append("animations", {"channels": channels, "samplers": [sampler]})
    assert code_of(tiny.load)[0] == "RG617"


def test_flat_shading_counts_a_vertex_for_every_corner(tiny, monkeypatch):
    monkeypatch.setattr("rendergraph.scene.gltf.meshes.MAX_VERTICES", 5)
    tiny.triangle()["indices"] = tiny.accessor([0, 1, 2, 0, 1, 2], "u1")
    assert code_of(tiny.load)[0] == "RG617"
    tiny.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = tiny.accessor([[0, 0, 1]] * 3)
    assert tiny.load().triangles == 2


def test_buffers_too_large_together(tiny, monkeypatch):
    tiny.triangle()
    monkeypatch.setattr("rendergraph.scene.gltf.document.MAX_FILE", len(tiny.data) - 1)
    assert code_of(tiny.load)[0] == "RG617"
