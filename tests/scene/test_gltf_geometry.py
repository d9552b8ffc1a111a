"""Accessors and primitives: every encoding of the same few vertices gives the same arrays."""

from __future__ import annotations

import numpy as np
import pytest

QUAD = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float32)
UP = [[0, 0, 1]] * 4


def drawn(scene):
    """Positions of the drawn corners of mesh 0, float32[triangles, 3, 3]."""
    mesh = scene.meshes[0]
    run = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count] + mesh.base_vertex
    return scene.positions[run].reshape(-1, 3, 3)


def test_triangle_gets_every_array(tiny):
    tiny.triangle()
    scene = tiny.load()
    assert scene.triangles == 1
    np.testing.assert_array_equal(scene.positions, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_allclose(scene.normals, [[0, 0, 1]] * 3)
    np.testing.assert_array_equal(scene.colors, np.ones((3, 4)))
    np.testing.assert_array_equal(scene.uv0, np.zeros((3, 2)))
    np.testing.assert_allclose((scene.tangents[:, :3] * scene.normals).sum(axis=1), 0, atol=1e-6)
    assert scene.joints is None
    arrays = (scene.positions, scene.normals, scene.tangents, scene.uv0, scene.uv1, scene.colors)
    assert {a.dtype for a in arrays} == {np.dtype(np.float32)}
    assert scene.indices.dtype == np.uint32
    assert scene.meshes[0].bounds_max == (1.0, 1.0, 0.0)


@pytest.mark.parametrize("load", ["load", "load_text"])
def test_glb_and_gltf_agree(tiny, load):
    tiny.triangle()
    assert drawn(getattr(tiny, load)()).tolist() == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


def test_external_buffer_with_escaped_name(tiny):
    tiny.triangle()
    (tiny.folder / "geo metry.bin").write_bytes(tiny.data)
    tiny.json["buffers"] = [{"byteLength": len(tiny.data), "uri": "geo%20metry.bin"}]
    assert tiny.load_text().triangles == 1


@pytest.mark.parametrize("dtype", ["u1", "u2", "u4"])
def test_index_types(tiny, dtype):
    primitive = tiny.triangle(POSITION=tiny.accessor(QUAD), NORMAL=tiny.accessor(UP))
    primitive["indices"] = tiny.accessor([2, 3, 0], dtype)
    assert drawn(tiny.load()).tolist() == [[[1, 1, 0], [0, 1, 0], [0, 0, 0]]]


@pytest.mark.parametrize("mode", [5, 6])
def test_strips_and_fans_wind_like_their_first_triangle(tiny, mode):
    order = [0, 1, 3, 2] if mode == 5 else [0, 1, 2, 3]
    primitive = tiny.triangle(POSITION=tiny.accessor(QUAD), NORMAL=tiny.accessor(UP))
    primitive.update(mode=mode, indices=tiny.accessor(order, "u2"))
    corners = drawn(tiny.load())
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    assert areas.tolist() == [0.5, 0.5]  # counter-clockwise, and together the whole quad


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_are_noted(tiny, mode):
    tiny.triangle()["mode"] = mode
    scene = tiny.load()
    assert scene.instances == []
    assert len(scene.notes) == 1


def test_interleaved(tiny):
    rows = np.hstack([QUAD, np.array(UP, np.float32)]).astype("<f4")
    view = tiny.view(rows.tobytes(), byteStride=24)
    common = {"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"}
    position, normal = tiny.append("accessors", common), tiny.append("accessors", {**common, "byteOffset": 12})
    tiny.triangle(POSITION=position, NORMAL=normal)["indices"] = tiny.accessor([0, 1, 2], "u1")
    scene = tiny.load()
    np.testing.assert_array_equal(scene.positions, QUAD)
    np.testing.assert_array_equal(scene.normals, UP)


@pytest.mark.parametrize("base", [True, False])
def test_sparse(tiny, base):
    """Two positions replaced, over a buffer view or over the zeros that stand in for one."""
    values = tiny.view(np.array([[1, 0, 0], [0, 1, 0]], "<f4").tobytes())
    indices = tiny.view(np.array([1, 2], "<u2").tobytes())
    sparse = {
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values},
    }
    if base:
        position = tiny.accessor([[0, 0, 0], [9, 9, 9], [9, 9, 9]], sparse=sparse)
    else:
        position = tiny.append("accessors", {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse})
    tiny.triangle(POSITION=position)
    assert tiny.load().positions.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("dtype", "largest", "normalized", "scale"),
    [
        ("u1", 255, True, 255),
        ("u2", 65535, True, 65535),
        ("i1", 127, True, 127),
        ("i2", 32767, True, 32767),
        ("u1", 255, False, 1),
        ("u2", 65535, False, 1),
        ("i1", -128, False, 1),
        ("i2", -32768, False, 1),
    ],
)
def test_quantised_positions(tiny, dtype, largest, normalized, scale):
    """KHR_mesh_quantization; elements padded to four bytes, as the stride rule asks."""
    values = np.zeros((3, 4), dtype="<" + dtype)
    values[1, 0] = values[2, 1] = largest
    view = tiny.view(values.tobytes(), byteStride=values.itemsize * 4)
    component = {"u1": 5121, "u2": 5123, "i1": 5120, "i2": 5122}[dtype]
    accessor = {"bufferView": view, "componentType": component, "count": 3, "type": "VEC3", "normalized": normalized}
    tiny.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    tiny.triangle(POSITION=tiny.append("accessors", accessor))
    assert tiny.load().positions[1].tolist() == [largest / scale, 0, 0]


def test_most_negative_normalised_value_is_minus_one(tiny):
    normals = np.array([[-128, 0, 0, 0]] * 3, "<i1")
    accessor = {"componentType": 5120, "count": 3, "type": "VEC3", "normalized": True}
    normal = tiny.append("accessors", {"bufferView": tiny.view(normals.tobytes(), byteStride=4), **accessor})
    tiny.triangle(NORMAL=normal)
    assert tiny.load().normals.tolist() == [[-1, 0, 0]] * 3


def test_missing_normals_are_flat_and_vertices_unshared(tiny):
    """Two triangles folded along a shared edge: four vertices become six."""
    positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    primitive = tiny.triangle(POSITION=tiny.accessor(positions), TANGENT=tiny.accessor([[1, 0, 0, -1]] * 4))
    primitive["indices"] = tiny.accessor([0, 1, 2, 0, 2, 3], "u1")
    scene = tiny.load()
    assert len(scene.positions) == 6
    np.testing.assert_allclose(scene.normals, [[0, 0, 1]] * 3 + [[1, 0, 0]] * 3)
    assert (scene.tangents[:, 3] == 1).all()  # given tangents are ignored without normals


def test_triangle_without_area_has_a_unit_normal(tiny):
    tiny.triangle(POSITION=tiny.accessor([[1, 2, 3]] * 3))
    assert np.linalg.norm(tiny.load().normals, axis=1).tolist() == [1, 1, 1]


@pytest.mark.parametrize(("dtype", "one"), [("f4", 1.0), ("u1", 255), ("u2", 65535)])
@pytest.mark.parametrize("width", [3, 4])
def test_colors(tiny, dtype, one, width):
    row = [one, 0, one, 0][:width]
    tiny.triangle(COLOR_0=tiny.accessor([row] * 3, dtype, normalized=dtype != "f4"))
    assert tiny.load().colors[0].tolist() == [1, 0, 1, 1 if width == 3 else 0]


def test_two_uv_sets(tiny):
    uv = tiny.accessor([[0, 0], [255, 0], [0, 255]], "u1", normalized=True)
    tiny.triangle(TEXCOORD_0=uv, TEXCOORD_1=tiny.accessor([[5, 6]] * 3))
    scene = tiny.load()
    assert scene.uv0.tolist() == [[0, 0], [1, 0], [0, 1]]
    assert scene.uv1.tolist() == [[5, 6]] * 3


def test_skinning_attributes_and_weights_that_do_not_sum_to_one(tiny):
    tiny.triangle(
        JOINTS_0=tiny.accessor([[0, 1, 0, 0]] * 3, "u1"),
        WEIGHTS_0=tiny.accessor([[1, 3, 0, 0], [0, 0, 0, 0], [2, 0, 0, 0]]),
    )
    tiny.append("skins", {"joints": [tiny.append("nodes", {}), tiny.append("nodes", {})]})
    tiny.json["nodes"][0]["skin"] = 0
    scene = tiny.load()
    assert scene.joints.tolist() == [[0, 1, 0, 0]] * 3
    assert scene.weights.tolist() == [[0.25, 0.75, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]]


def test_primitives_of_equal_accessors_share_their_place(tiny):
    primitive = tiny.triangle()
    tiny.json["materials"] = [{"name": "a"}, {"name": "b"}]
    tiny.json["meshes"].append({"primitives": [{**primitive, "material": i} for i in (0, 1)]})
    tiny.json["scenes"][0]["nodes"].append(tiny.append("nodes", {"mesh": 1}))
    scene = tiny.load()
    assert len(scene.positions) == 3
    assert {(m.first_index, m.base_vertex) for m in scene.meshes} == {(0, 0)}
    assert [scene.materials[m.material].name for m in scene.meshes] == ["default", "a", "b"]


def test_second_mesh_is_placed_behind_the_first(tiny):
    first = tiny.triangle()
    second = {"attributes": {"POSITION": tiny.accessor(QUAD + 5), "NORMAL": tiny.accessor(UP)}}
    second["indices"] = tiny.accessor([0, 1, 2, 0, 2, 3], "u2")
    tiny.json["meshes"][0]["primitives"] = [first, second]
    mesh = tiny.load().meshes[1]
    assert (mesh.first_index, mesh.index_count, mesh.base_vertex) == (3, 6, 3)


def test_ignored_content_is_noted(tiny):
    primitive = tiny.triangle()
    primitive["targets"] = [{"POSITION": 0}]
    primitive["attributes"]["TEXCOORD_2"] = 0
    primitive["attributes"]["_CUSTOM"] = 0
    assert len(tiny.load().notes) == 2  # application-specific attributes are not worth one


def test_empty_scene(tiny):
    scene = tiny.load_text()
    assert scene.triangles == 0
    assert scene.positions.shape == (0, 3)
