"""The document's scene: its source, its camera, its lights."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tiny_gltf import TinyGltf, full

from rendergraph.document.messages import RenderGraphError
from rendergraph.document.models import SceneModel
from rendergraph.plan.graph import Position
from rendergraph.scene.load import LoadedScene, light_volume, load_scene
from rendergraph.scene.scatter import scatter_lights
from rendergraph.scene.scene import Light

HERE = Position("graph.yaml", 7, 11)
THERE = Position("graph.yaml", 9, 3)


def load(source: str = "cornell", folder: Path = Path("/nonexistent"), **model: Any) -> LoadedScene:
    detail = model.pop("detail", 0.0)
    keywords = {key: model.pop(key) for key in ("source_override", "keep_camera", "frame_seed") if key in model}
    scene = SceneModel.model_validate({"source": source, "detail": detail, **model})
    return load_scene(scene, folder, position=HERE, camera_position=THERE, **{"frame_seed": 0, **keywords})


def error(*args: Any, **kwargs: Any) -> Any:
    with pytest.raises(RenderGraphError) as caught:
        load(*args, **kwargs)
    (found,) = caught.value.diagnostics
    return found


# ---------------------------------------------------------------- source


@pytest.mark.parametrize("name", ["atrium", "cornell", "spheres"])
def test_shipped_scenes_load_by_name(name: str) -> None:
    loaded = load(name)
    assert loaded.scene.name == name
    assert loaded.camera == loaded.scene.cameras[0]
    assert loaded.notes == ()


def test_an_unknown_name_is_told_its_nearest_neighbour() -> None:
    found = error("atriun")
    assert (found.code, found.position) == ("RG650", HERE)
    assert "atrium" in found.help


def test_an_unknown_file_type_is_no_scene() -> None:
    assert error("room.obj").code == "RG650"


@pytest.mark.parametrize("source", ["missing.glb", "folder.glb", "a\0b.glb", "x" * 4000 + ".gltf"])
def test_a_path_that_is_no_file_is_refused(tmp_path: Path, source: str) -> None:
    (tmp_path / "folder.glb").mkdir()
    found = error(source, tmp_path)
    assert (found.code, found.position) == ("RG651", HERE)


def test_a_missing_file_is_told_its_nearest_neighbour(tmp_path: Path) -> None:
    (tmp_path / "fireplace.glb").touch()
    assert "fireplace.glb" in error("fireplace_.glb", tmp_path).help


def test_a_broken_file_is_the_loaders_error(tmp_path: Path) -> None:
    (tmp_path / "bad.glb").write_bytes(b"not a scene")
    assert error("bad.glb", tmp_path).code.startswith("RG6")


def test_a_gltf_file_is_found_beside_the_graph(tmp_path: Path) -> None:
    loaded = _gltf(tmp_path)
    assert loaded.scene.instances
    assert math.isfinite(sum(loaded.camera.position))


def test_detail_and_seed_reach_the_procedural_scene() -> None:
    assert load("spheres", detail=1.0).scene.triangles > load("spheres", detail=0.0).scene.triangles
    first, other = load("atrium", seed=1), load("atrium", seed=2)
    assert not np.array_equal(first.scene.positions, other.scene.positions)


def test_the_frames_seed_stands_in_for_seeds_not_given() -> None:
    own = load("atrium", seed=5, frame_seed=1).scene.positions
    np.testing.assert_array_equal(own, load("atrium", seed=5, frame_seed=2).scene.positions)
    np.testing.assert_array_equal(own, load("atrium", frame_seed=5).scene.positions)
    assert not np.array_equal(own, load("atrium", frame_seed=6).scene.positions)


def test_an_override_is_relative_to_the_working_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.glb").write_bytes(full(TinyGltf(tmp_path)).glb())
    monkeypatch.chdir(tmp_path)
    assert load("cornell", source_override="scene.glb").scene.name != "cornell"
    assert load("cornell", source_override="spheres").scene.name == "spheres"


# ---------------------------------------------------------------- camera


def test_a_placed_camera_has_the_models_own_lens() -> None:
    camera = load(camera={"position": [1, 2, 3], "target": [0, 1, 0], "fov": 90, "near": 0.2, "far": 40}).camera
    assert camera.position == (1, 2, 3)
    assert camera.target == (0, 1, 0)
    assert camera.fov == pytest.approx(math.pi / 2)
    assert (camera.near, camera.far) == (0.2, 40)
    assert load(camera={"position": [1, 2, 3]}).camera.fov == pytest.approx(math.radians(60))


def test_a_position_alone_looks_at_the_middle_of_the_scene() -> None:
    assert load(camera={"position": [0, 1, 20]}).camera.target == pytest.approx((0, 2.775, 0))


def test_a_named_camera_keeps_what_the_model_leaves_open() -> None:
    gallery = load("atrium", camera={"name": "gallery"}).camera
    assert gallery.name == "gallery"
    assert gallery.fov == pytest.approx(math.radians(60))
    narrow = load("atrium", camera={"name": "gallery", "fov": 30}).camera
    assert narrow.position == gallery.position
    assert narrow.fov == pytest.approx(math.radians(30))
    assert narrow.near == gallery.near


def test_an_unknown_camera_is_told_its_nearest_neighbour() -> None:
    found = error("atrium", camera={"name": "galery"})
    assert (found.code, found.position) == ("RG652", THERE)
    assert "gallery" in found.help


def test_a_camera_that_looks_at_its_own_place_is_refused() -> None:
    position = load("atrium").camera.position
    assert error("atrium", camera={"target": list(position)}).code == "RG653"


def test_a_scene_without_cameras_is_framed(tmp_path: Path) -> None:
    tiny = TinyGltf(tmp_path)
    tiny.triangle()
    (tmp_path / "scene.glb").write_bytes(tiny.glb())
    loaded = load("scene.glb", tmp_path)
    assert [note.code for note in loaded.notes] == ["RG654"]
    assert loaded.camera.name == "framing"
    low, high = loaded.scene.bounds()
    assert loaded.camera.target == pytest.approx(tuple((low + high) / 2))


def test_a_lens_that_would_put_far_before_near_has_no_far_plane() -> None:
    camera = load("spheres", camera={"name": "main", "near": 0.3}).camera
    assert (camera.near, camera.far) == (0.3, None)


def test_orbits_are_passed_on() -> None:
    assert load(camera={"orbit": {"turns": 0.5}}).orbit_turns == 0.5
    assert load().orbit_turns == 0.0


def test_another_scene_does_not_get_the_first_ones_camera() -> None:
    placed = {"position": [1, 2, 3], "target": [0, 0, 0], "fov": 30}
    loaded = load("cornell", camera=placed, source_override="spheres")
    assert [note.code for note in loaded.notes] == ["RG655"]
    assert loaded.camera.position == loaded.scene.cameras[0].position
    assert loaded.camera.fov == pytest.approx(math.radians(30))
    same = load("cornell", camera=placed, source_override="cornell")
    kept = load("cornell", camera=placed, source_override="spheres", keep_camera=True)
    assert same.camera.position == kept.camera.position == (1, 2, 3)
    assert same.notes == kept.notes == ()


# ---------------------------------------------------------------- lights


def test_the_scenes_own_lights_stay_unless_switched_off() -> None:
    own = load("cornell").scene
    assert len(own.lights) == 1
    lights = {"from_scene": False, "list": [{"position": [0, 1, 0], "color": [1, 0.5, 0], "intensity": 4}]}
    only = load("cornell", lights=lights).scene
    assert [light.intensity for light in only.lights] == [(4.0, 2.0, 0.0)]
    assert only.ambient is None
    assert only.sun is None
    both = load("cornell", lights={"list": lights["list"]}).scene
    assert len(both.lights) == 2
    assert both.ambient == own.ambient


def test_the_models_sun_and_sky_replace_the_scenes() -> None:
    sun = {"direction": [0, -3, 4], "illuminance": 2, "color": [1, 0.5, 0.25]}
    scene = load("atrium", lights={"sun": sun, "ambient": {"sky": [1, 2, 3], "ground": [0, 0, 0]}}).scene
    assert scene.sun is not None
    assert scene.sun.direction == pytest.approx((0, -0.6, 0.8))
    assert scene.sun.irradiance == pytest.approx((2, 1, 0.5))
    assert scene.ambient is not None
    assert scene.ambient.sky == (1, 2, 3)


def test_a_tiny_or_huge_direction_is_normalised() -> None:
    for size in (1e-300, 1e300):
        sun = load("cornell", lights={"sun": {"direction": [0, -size, 0]}}).scene.sun
        assert sun is not None
        assert sun.direction == (0, -1, 0)


def test_spots_are_in_radians_with_a_unit_axis() -> None:
    spot = {"position": [0, 1, 0], "direction": [0, -2, 0], "inner": 30, "outer": 45, "radius": 3}
    light = load(lights={"from_scene": False, "list": [spot]}).scene.lights[0]
    assert light.axis == (0, -1, 0)
    assert (light.inner, light.outer) == pytest.approx((math.pi / 6, math.pi / 4))
    assert light.radius == 3


def test_a_scene_without_any_light_gets_a_sun_and_a_note() -> None:
    loaded = load("cornell", lights={"from_scene": False})
    assert [note.code for note in loaded.notes] == ["RG654"]
    assert loaded.scene.sun is not None
    assert loaded.scene.ambient is not None


def test_a_sun_alone_gets_a_default_sky_and_a_note() -> None:
    sun = {"direction": [0, -1, 0], "illuminance": 3}
    loaded = load("cornell", lights={"from_scene": False, "sun": sun})
    assert [note.code for note in loaded.notes] == ["RG657"]
    assert loaded.scene.ambient is not None
    assert min(loaded.scene.ambient.sky + loaded.scene.ambient.ground) > 0
    assert loaded.scene.sun is not None
    assert max(loaded.scene.sun.irradiance) == pytest.approx(3)
    black = {"sky": [0, 0, 0], "ground": [0, 0, 0]}
    dark = load("cornell", lights={"from_scene": False, "sun": sun, "ambient": black})
    assert dark.notes == ()
    assert not dark.scene.features().ambient
    kept = load("cornell", lights={"sun": sun})  # the scene brings its own
    assert kept.notes == ()
    assert kept.scene.ambient == load("cornell").scene.ambient


def test_lights_that_are_asked_to_be_dark_stay_dark() -> None:
    loaded = load("cornell", lights={"from_scene": False, "points": {"count": 0}})
    assert loaded.notes == ()
    assert loaded.scene.sun is None
    assert loaded.scene.lights == []


@pytest.mark.parametrize("name", ["atrium", "cornell", "spheres"])
def test_scattered_lights_lie_within_the_scene(name: str) -> None:
    scene = load(name, lights={"from_scene": False, "points": {"count": 300, "seed": 3}}).scene
    positions = np.array([light.position for light in scene.lights])
    low, high = light_volume(scene)
    assert len(positions) == 300
    assert (positions >= low).all()
    assert (positions <= high).all()
    outer_low, outer_high = scene.bounds()
    assert (low >= outer_low).all()
    assert (high <= outer_high).all()
    # Spread out: every octant of the volume gets its share of 300 / 8.
    octant = ((positions - low) / (high - low) > 0.5) @ [1, 2, 4]
    assert np.bincount(octant, minlength=8).min() > 20


def test_scattered_lights_follow_their_seed() -> None:
    def positions(frame_seed: int, **points: int) -> list[Any]:
        lights = {"from_scene": False, "points": {"count": 8, **points}}
        return [light.position for light in load(lights=lights, frame_seed=frame_seed).scene.lights]

    assert positions(0, seed=3) == positions(1, seed=3)
    assert positions(3) == positions(0, seed=3)
    assert positions(0, seed=3) != positions(0, seed=4)
    assert positions(0, seed=3, count=20)[:8] == positions(0, seed=3)


def test_scattered_lights_end_where_their_irradiance_meets_the_cutoff() -> None:
    low, high = np.zeros(3), np.ones(3)
    lights = scatter_lights(64, low, high, seed=1, intensity=2.0, radius=None, cutoff=0.02)
    assert {light.radius for light in lights} == {10.0}  # sqrt(2 / 0.02)
    given = scatter_lights(2, low, high, seed=1, intensity=2.0, radius=3.5, cutoff=0.02)
    assert {light.radius for light in given} == {3.5}
    dark = scatter_lights(2, low, high, seed=1, intensity=0.0, radius=None, cutoff=0.02)
    assert all(light.radius > 0.0 for light in dark)


def test_scattered_lights_are_saturated_and_distinct() -> None:
    lights = scatter_lights(64, np.zeros(3), np.ones(3), seed=1, intensity=2.0, radius=None, cutoff=0.02)
    colors = np.array([light.intensity for light in lights])
    np.testing.assert_allclose(colors.max(axis=1), 2.0)
    assert (colors.min(axis=1) <= 0.3 * 2.0 + 1e-9).all()
    assert len(np.unique(colors.argmax(axis=1))) == 3
    near = np.linalg.norm(colors[1:] - colors[:-1], axis=1)
    assert near.min() > 0.3, "neighbours in number differ in hue"


def test_a_scene_with_nothing_to_draw_is_noted(tmp_path: Path) -> None:
    (tmp_path / "empty.gltf").write_text('{"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "scene": 0}')
    assert "RG656" in {note.code for note in load("empty.gltf", tmp_path).notes}


def _gltf(folder: Path) -> LoadedScene:
    (folder / "scene.glb").write_bytes(full(TinyGltf(folder)).glb())
    return load("scene.glb", folder)


def test_a_moving_light_runs_its_circle_and_comes_back() -> None:
    light = Light((1.0, 2.0, 3.0), (1.0, 1.0, 1.0), 5.0, circle=2.0, phase=0.25)
    assert np.allclose(light.position_at(0.0), (1.0, 2.0, 5.0))
    assert np.allclose(light.position_at(0.25), (-1.0, 2.0, 3.0))
    assert np.allclose(light.position_at(1.0), light.position_at(0.0))
    backwards = replace(light, circle=-2.0)
    assert np.allclose(backwards.position_at(0.25), (3.0, 2.0, 3.0))
    assert replace(light, circle=0.0).position_at(0.4) == (1.0, 2.0, 3.0)
