"""Rooms are seen from inside, solid things from outside."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rendergraph.scene import procedural
from rendergraph.scene.cameras import frame_scene
from rendergraph.scene.gltf import load_gltf
from rendergraph.scene.interior import interior_camera
from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.geometry import Geometry
from rendergraph.scene.procedural.mesh_builder import SceneBuilder, placement
from rendergraph.scene.procedural.shapes import sphere
from rendergraph.scene.rays import cast, world_triangles
from rendergraph.scene.scene import Camera, Material, Scene

FOV = math.radians(60.0)
SIZE = (6.0, 2.8, 4.0)


def inward(geometry: Geometry) -> Geometry:
    """The same surface, seen from its inside."""
    return replace(geometry, normals=-geometry.normals, indices=geometry.indices[::-1].copy())


def room(*furniture: Geometry, shell: Geometry | None = None, scale: float = 1.0, double_sided: bool = False) -> Scene:
    """A closed room of 6 x 2.8 x 4 m whose floor is at y = 10, away from the origin."""
    builder = SceneBuilder("room")
    material = builder.material(Material(double_sided=double_sided))
    place = placement(20.0, 10.0 + SIZE[1] / 2.0, -7.0)
    larger = np.diag([scale, scale, scale, 1.0])
    for part in (shell or inward(block(SIZE)), *furniture):
        builder.place(builder.mesh(part, material), larger @ place)
    return builder.build()


def table() -> Geometry:
    """A massive block in the middle of the room, 0.9 m high."""
    return block((1.6, 0.9, 1.0), (0.0, 0.45 - SIZE[1] / 2.0, 0.0))


@pytest.mark.parametrize("scene", [
    room(), room(table()), room(shell=block(SIZE), double_sided=True), room(table(), scale=100.0), room(scale=0.01),
], ids=["empty", "table", "double-sided", "centimetres", "doll's house"])  # fmt: skip
def test_a_room_is_seen_from_a_corner_across_its_middle(scene: Scene) -> None:
    camera = frame_scene(scene, FOV)
    low, high = scene.bounds()
    eye, target, middle = np.array(camera.position), np.array(camera.target), (low + high) / 2.0
    assert ((eye > low) & (eye < high)).all()
    assert 0.3 < (eye[1] - low[1]) / (high[1] - low[1]) < 0.7
    assert np.linalg.norm((eye - middle)[[0, 2]]) > 0.5 * np.linalg.norm((high - middle)[[0, 2]])
    assert target[[0, 2]] == pytest.approx(middle[[0, 2]])
    free = cast(world_triangles(scene), eye, (target - eye)[None] / np.linalg.norm(target - eye)).distance[0]
    assert free > 0.3 * np.linalg.norm((high - low)[[0, 2]])
    assert 0.0 < camera.near < 0.05 * np.linalg.norm(high - low)


def test_a_metric_rooms_camera_is_at_eye_height() -> None:
    assert frame_scene(room(table()), FOV).position[1] - 10.0 == pytest.approx(1.6)


def test_furniture_in_the_corners_keeps_the_camera_away() -> None:
    """Wardrobes stand where the camera of the empty room does."""
    x, z = SIZE[0] / 2.0 - 0.6, SIZE[2] / 2.0 - 0.6
    wardrobes = [block((1.2, 2.2, 1.2), (sx * x, -0.3, sz * z)) for sx in (-1, 1) for sz in (-1, 1)]
    scene = room(*wardrobes)
    camera = frame_scene(scene, FOV)
    low, high = scene.bounds()
    eye = np.array(camera.position)
    assert ((eye > low) & (eye < high)).all()
    for sx in (-1, 1):
        for sz in (-1, 1):
            away = np.abs(eye - (20.0 + sx * x, 0.0, -7.0 + sz * z))[[0, 2]]
            assert away.max() > 0.6


def framed_from_outside(camera: Camera, scene: Scene) -> bool:
    low, high = scene.bounds()
    return bool(np.linalg.norm(np.array(camera.position) - (low + high) / 2.0) > np.linalg.norm(high - low) / 2.0)


def roofless() -> Scene:
    walls = inward(block(SIZE))
    corners = walls.positions[walls.indices.reshape(-1, 3)]
    roof = (corners[:, :, 1] > SIZE[1] / 2.0 - 1e-9).all(axis=1)
    return room(shell=replace(walls, indices=walls.indices.reshape(-1, 3)[~roof].ravel()))


@pytest.mark.parametrize("scene", [
    room(shell=block(SIZE)), room(shell=sphere(1.0, 24, 12)), roofless(), procedural.build("spheres", detail=0.2),
    procedural.build("cornell", detail=0.1),
], ids=["solid block", "ball", "roofless", "spheres", "open box"])  # fmt: skip
def test_what_does_not_enclose_its_middle_is_seen_from_outside(scene: Scene) -> None:
    assert interior_camera(scene, FOV) is None
    assert framed_from_outside(frame_scene(scene, FOV), scene)


@pytest.mark.assets
def test_the_fireplace_room_is_seen_from_inside(assets: Path) -> None:
    scene = load_gltf(assets / "fireplace_room" / "fireplace_room.glb")
    started = time.process_time()
    camera = frame_scene(scene, FOV)
    assert time.process_time() - started < 1.0  # 0.1 s on an idle core
    assert not framed_from_outside(camera, scene)
    assert camera.position[1] == pytest.approx(1.6, abs=0.01)


@pytest.mark.assets
@pytest.mark.parametrize("file", ["flight_helmet/FlightHelmet.gltf", "fox/Fox.glb", "knight/Knight.glb"])
def test_solid_assets_are_seen_from_outside(assets: Path, file: str) -> None:
    scene = load_gltf(assets / file)
    assert framed_from_outside(frame_scene(scene, FOV), scene)
