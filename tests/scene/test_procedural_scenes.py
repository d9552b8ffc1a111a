"""The shipped scenes: enough triangles, the same for the same seed, sound geometry, every kind of material."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from rendergraph.scene import procedural
from rendergraph.scene.scene import Alpha, Scene


@cache
def shipped(name: str, detail: float = 1.0, seed: int = 0) -> Scene:
    return procedural.build(name, detail=detail, seed=seed)


SCENES = [(name, detail) for name in procedural.SHIPPED for detail in (0.0, 0.2, 1.0)]


def test_the_full_atrium_has_at_least_200_000_triangles() -> None:
    scene = shipped("atrium")
    assert 200_000 <= scene.triangles <= 600_000
    assert len(scene.indices) // 3 < scene.triangles / 4, "columns and arches are instances"


@pytest.mark.parametrize("name", procedural.SHIPPED)
def test_triangles_never_fall_as_detail_rises(name: str) -> None:
    counts = [procedural.build(name, detail=detail).triangles for detail in (0.0, 0.1, 0.25, 0.5, 0.75)]
    counts.append(shipped(name).triangles)
    assert counts == sorted(counts)
    assert counts[-1] > 4 * counts[0]


def test_low_detail_keeps_the_silhouette() -> None:
    coarse, fine = shipped("atrium", 0.0), shipped("atrium")
    assert coarse.triangles < 22_000
    np.testing.assert_allclose(coarse.bounds(), fine.bounds(), atol=0.02)
    for low, high in zip(coarse.instances, fine.instances, strict=True):
        assert low.name == high.name
        np.testing.assert_array_equal(low.world, high.world)


def _arrays(scene: Scene) -> list[np.ndarray]:
    pool = [scene.positions, scene.normals, scene.tangents, scene.uv0, scene.colors, scene.indices]
    return [*pool, *(i.world for i in scene.instances), *(image.pixels for image in scene.images)]


def test_equal_seeds_give_identical_scenes_and_others_differ() -> None:
    first, again = shipped("atrium", 0.2), procedural.build("atrium", detail=0.2)
    for a, b in zip(_arrays(first), _arrays(again), strict=True):
        np.testing.assert_array_equal(a, b)
    assert first.materials == again.materials
    other = shipped("atrium", 0.2, 1)
    assert not np.array_equal(first.positions, other.positions)
    assert not np.array_equal(first.images[0].pixels, other.images[0].pixels)
    assert first.triangles == other.triangles


@pytest.mark.parametrize(("name", "detail"), SCENES)
def test_vertices_are_finite_and_orthonormal(name: str, detail: float) -> None:
    scene = shipped(name, detail)
    for array in (scene.positions, scene.normals, scene.tangents, scene.uv0, scene.colors):
        assert np.isfinite(array).all()
        assert array.dtype == np.float32
    tangents = scene.tangents[:, :3]
    np.testing.assert_allclose(np.linalg.norm(scene.normals, axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(tangents, axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose((scene.normals * tangents).sum(axis=1), 0.0, atol=1e-5)
    assert set(np.unique(scene.tangents[:, 3])) <= {-1.0, 1.0}


@pytest.mark.parametrize(("name", "detail"), SCENES)
def test_triangles_face_the_way_their_normals_do(name: str, detail: float) -> None:
    scene = shipped(name, detail)
    for mesh in scene.meshes:
        run = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].reshape(-1, 3).astype(np.int64)
        corners = scene.positions[run + mesh.base_vertex].astype(np.float64)
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        wrong = (face * scene.normals[run + mesh.base_vertex].sum(axis=1)).sum(axis=1) <= 0.0
        # Tightly gathered cloth may fold over itself between two vertices; nothing else may.
        allowed = 0.03 if scene.materials[mesh.material].double_sided else 0.0
        assert wrong.mean() <= allowed, (mesh.material, scene.materials[mesh.material].name)


@pytest.mark.parametrize(("name", "detail"), SCENES)
def test_ranges_of_the_pool_are_sound(name: str, detail: float) -> None:
    scene = shipped(name, detail)
    for mesh in scene.meshes:
        run = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count]
        used = scene.positions[run.astype(np.int64) + mesh.base_vertex]
        assert len(run) == mesh.index_count > 0
        assert 0 <= mesh.material < len(scene.materials)
        assert (used >= np.array(mesh.bounds_min) - 1e-5).all()
        assert (used <= np.array(mesh.bounds_max) + 1e-5).all()
    for instance in scene.instances:
        assert np.linalg.det(instance.world[:3, :3]) > 0.0
        assert 0 <= instance.mesh < len(scene.meshes)
    drawn = {instance.mesh for instance in scene.instances}
    shared = {scene.meshes[m].first_index for m in drawn}
    assert {mesh.first_index for mesh in scene.meshes} == shared, "geometry that nothing draws"


def test_the_atrium_shows_every_kind_of_material() -> None:
    features = shipped("atrium").features()
    for flag in ("opaque", "masked", "blended", "double_sided", "emissive", "normal_mapped", "occlusion_mapped"):
        assert getattr(features, flag), flag
    assert features.sun
    assert features.ambient
    assert features.point_lights >= 8
    used = {scene_mesh.material for scene_mesh in shipped("atrium").meshes}
    materials = [shipped("atrium").materials[m] for m in used]
    assert any(m.metallic == 1.0 for m in materials)
    for material in materials:
        masked = material.alpha is Alpha.MASKED
        assert masked == (material.double_sided)
        if masked:
            assert material.base_color_texture is not None
            alpha = shipped("atrium").images[material.base_color_texture.image].pixels[..., 3]
            assert (alpha < 32).mean() > 0.005, "a mask that cuts nothing"
            assert (alpha > 223).mean() > 0.2, "a mask that leaves nothing"


def test_images_are_of_one_size_and_normal_maps_point_out_of_the_surface() -> None:
    scene = shipped("atrium", 0.2)
    assert len({image.pixels.shape for image in scene.images}) == 1
    normal_maps = {m.normal_texture.image for m in scene.materials if m.normal_texture is not None}
    base_colors = {m.base_color_texture.image for m in scene.materials if m.base_color_texture is not None}
    assert len(normal_maps) >= 8
    for index, image in enumerate(scene.images):
        assert image.srgb == (index in base_colors)
        if index in normal_maps:
            vector = image.pixels[..., :3] / 127.5 - 1.0
            np.testing.assert_allclose(np.linalg.norm(vector, axis=-1), 1.0, atol=0.02)
            assert vector[..., 2].min() > 0.0
            assert vector[..., :2].std() > 0.01, f"{image.name} is flat"


@pytest.mark.parametrize("pattern", ["limestone", "plaster", "brick", "marble_tiles", "weave", "hammered"])
def test_patterns_tile(pattern: str) -> None:
    from rendergraph.scene.procedural import patterns

    base = getattr(patterns, pattern)(np.random.default_rng(1), 256).base.pixels[..., :3].astype(float)
    for axis in (0, 1):
        steps = np.abs(np.diff(base, axis=axis)).mean(axis=(1 - axis, 2))
        seam = np.abs(base.take(0, axis) - base.take(-1, axis)).mean()
        assert seam <= steps.max() * 1.2 + 1.0


def test_the_seam_check_tells_an_image_that_does_not_tile() -> None:
    ramp = np.linspace(0.0, 255.0, 256)
    assert abs(ramp[0] - ramp[-1]) > np.abs(np.diff(ramp)).max() * 1.2 + 1.0


@pytest.mark.parametrize("name", procedural.SHIPPED)
def test_cameras_stand_in_the_open_and_see_the_scene(name: str) -> None:
    scene = shipped(name, 0.0)
    assert scene.cameras[0].name == "main"
    low, high = scene.bounds()
    for camera in scene.cameras:
        target = np.array(camera.target)
        assert (target >= low).all()
        assert (target <= high).all()
        assert np.linalg.norm(target - camera.position) > 1.0


def test_the_sun_reaches_the_courtyard_floor_and_the_arcade() -> None:
    scene = shipped("atrium", 0.0)
    assert scene.sun is not None
    direction = np.array(scene.sun.direction)
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    # From the middle of the sky opening down to the floor: inside the courtyard's 21 x 9 m.
    landing = direction * (9.0 / -direction[1])
    assert abs(landing[0]) < 10.5
    assert 0.5 < abs(landing[2]) < 9.0


@pytest.mark.parametrize("name", ["atrium", "cornell"])
def test_lights_hang_inside_the_room(name: str) -> None:
    scene = shipped(name, 0.0)
    low, high = scene.bounds()
    for light in scene.lights:
        assert (np.array(light.position) > low).all()
        assert (np.array(light.position) < high).all()
        assert light.radius > 0.0


def test_cornell_is_the_size_of_the_original_and_open_in_front() -> None:
    scene = shipped("cornell")
    low, high = scene.bounds()
    np.testing.assert_allclose(high - low, 5.55, atol=1e-9)
    names = {i.name for i in scene.instances}
    assert {"floor", "ceiling", "back", "left", "right", "lamp", "short box", "tall box"} == names
    assert scene.features().emissive
    assert scene.features().spot_lights == 1


def test_spheres_cover_metallic_and_roughness() -> None:
    scene = shipped("spheres", 0.2)
    pairs = {(m.metallic, round(m.roughness, 3)) for m in scene.materials if m.name != "ground"}
    assert len(pairs) == 35
    assert {p[0] for p in pairs} == {0.0, 0.25, 0.5, 0.75, 1.0}
    assert min(p[1] for p in pairs) == 0.05
    assert max(p[1] for p in pairs) == 1.0


def test_unknown_names_and_details_are_refused() -> None:
    with pytest.raises(KeyError):
        procedural.build("cathedral")
    with pytest.raises(ValueError, match="detail"):
        procedural.build("atrium", detail=1.5)
