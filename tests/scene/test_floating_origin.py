"""Far from the origin the device sees the scene as if it were near."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rendergraph.scene.floating_origin import ORIGIN, REACH, camera_from, device_origin, scene_from
from rendergraph.scene.procedural import build
from rendergraph.scene.scene import Camera


def test_near_the_origin_nothing_moves() -> None:
    scene = build("spheres", detail=0.0)
    near = Camera((REACH, -REACH, 3.0), (0.0, 0.0, 0.0))
    assert device_origin([near, Camera((9e9, 0.0, 0.0), (0.0, 0.0, 0.0))]) == ORIGIN == device_origin([])
    assert scene_from(scene, ORIGIN) is scene


def test_far_away_everything_moves_together_by_whole_metres() -> None:
    scene = build("spheres", detail=0.0)
    far = Camera((1e6 + 0.25, 2.0, -3e6 - 0.75), (1e6, 2.0, -3e6))
    origin = device_origin([far])
    assert origin == (1e6, 2.0, -3000001.0)
    camera = camera_from(far, origin)
    assert camera.position == (0.25, 0.0, 0.25)
    assert camera.target == (0.0, 0.0, 1.0)
    world = scene.instances[0].world.copy()
    moved = scene_from(scene, origin)
    assert np.array_equal(moved.instances[0].world[:3, 3], world[:3, 3] - origin)
    assert np.array_equal(moved.instances[0].world[:3, :3], world[:3, :3])
    assert np.array_equal(scene.instances[0].world, world)  # the first is untouched
    assert moved.lights[0].position == tuple(np.array(scene.lights[0].position) - origin)
    assert replace(moved.lights[0], position=scene.lights[0].position) == scene.lights[0]
