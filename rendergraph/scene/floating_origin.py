"""Scenes far from the world's origin, moved near it for the device, whose float32 positions would be steps apart.

At 1000 km float32 is a grid of 6 cm: transforms, depth, shadow cascades and distances to lights would all be made of
the differences of such numbers. Nothing on the device needs to know where the world's origin is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from rendergraph.scene.scene import Camera, Scene

Vector = tuple[float, float, float]

ORIGIN: Final[Vector] = (0.0, 0.0, 0.0)
#: Metres: as long as the cameras stay this near, positions are the world's own.
REACH: Final = 1024.0


def device_origin(cameras: Sequence[Camera]) -> Vector:
    """The world position that is the origin on the device: the world's own, or whole metres near the first camera where
    that is farther than ``REACH`` from it along an axis.
    """
    if not cameras or max(map(abs, cameras[0].position)) <= REACH:
        return ORIGIN
    x, y, z = np.round(cameras[0].position).tolist()
    return x, y, z


def scene_from(scene: Scene, origin: Vector) -> Scene:
    """The scene as placed from ``origin``; itself where that is the world's."""
    if origin == ORIGIN:
        return scene
    instances = []
    for instance in scene.instances:
        world = instance.world.copy()
        world[:3, 3] -= origin
        instances.append(replace(instance, world=world))
    lights = [replace(light, position=_from(light.position, origin)) for light in scene.lights]
    return replace(scene, instances=instances, lights=lights)


def camera_from(camera: Camera, origin: Vector) -> Camera:
    """The camera as placed from ``origin``."""
    return replace(camera, position=_from(camera.position, origin), target=_from(camera.target, origin))


def _from(point: Vector, origin: Vector) -> Vector:
    return point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
