"""Real scenes load completely. Skipped where the asset folder is absent."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.scene.gltf import load_gltf
from rendergraph.scene.gpu_layout import pack_instances, pack_materials, place_textures
from rendergraph.scene.tangents import generate_tangents

pytestmark = pytest.mark.assets


@pytest.fixture(scope="module")
def helmet(assets):
    return load_gltf(assets / "flight_helmet" / "FlightHelmet.gltf")


def test_fireplace_room(assets):
    scene = load_gltf(assets / "fireplace_room" / "fireplace_room.glb")
    features = scene.features()
    assert (features.triangles, features.draws, features.materials) == (105_299, 49, 23)
    assert features.opaque
    assert features.masked
    assert features.blended
    assert not features.normal_mapped
    assert scene.notes == []
    assert len(pack_instances(scene)) == 49 * 128
    placement = place_textures(scene)
    assert len(pack_materials(scene, placement)) == 23 * 256
    assert sum(len(array.images) for array in placement.arrays) == len(scene.images)


def test_flight_helmet(helmet):
    features = helmet.features()
    assert (features.triangles, features.draws) == (94_722, 6)
    assert features.normal_mapped
    assert features.occlusion_mapped
    assert features.blended
    low, high = helmet.bounds()
    assert 0.3 < (high - low).max() < 1.0  # metres
    array = place_textures(helmet).arrays[0]
    assert array.pixels().shape == (len(array.images), array.size, array.size, 4)


def test_fox(assets):
    scene = load_gltf(assets / "fox" / "Fox.glb")
    assert scene.triangles == 576
    assert [a.name for a in scene.animations] == ["Survey", "Walk", "Run"]
    assert len(scene.skins[0].joints) == 24
    assert scene.joints is not None
    np.testing.assert_allclose(np.linalg.norm(scene.normals, axis=1), 1, rtol=1e-5)  # the file has none: flat


def test_knight(assets):
    scene = load_gltf(assets / "knight" / "Knight.glb")
    assert (scene.triangles, len(scene.animations), len(scene.skins[0].joints)) == (6952, 76, 41)
    assert scene.notes == []


def helmet_agreement(helmet, flip_v):
    """Share of vertices with the same w as the file's own tangents, and median cosine to them."""
    signs, cosines = [], []
    for mesh in helmet.meshes:
        indices = helmet.indices[mesh.first_index : mesh.first_index + mesh.index_count]
        run = slice(mesh.base_vertex, mesh.base_vertex + int(indices.max()) + 1)
        uv = helmet.uv0[run] * np.float32([1, -1]) if flip_v else helmet.uv0[run]
        space = generate_tangents(helmet.positions[run], helmet.normals[run], uv, indices)
        given = helmet.tangents[run][space.vertices]
        signs.append(space.tangents[:, 3] == given[:, 3])
        cosines.append((space.tangents[:, :3] * given[:, :3]).sum(axis=1))
    return float(np.concatenate(signs).mean()), float(np.median(np.concatenate(cosines)))


def test_tangents_agree_with_those_of_the_helmet(helmet):
    """The file's tangents come from another implementation; with v turned round, the known-bad twin, w is wrong."""
    same_sign, cosine = helmet_agreement(helmet, flip_v=False)
    assert same_sign > 0.999
    assert cosine > 0.9995
    assert helmet_agreement(helmet, flip_v=True)[0] < 0.01
