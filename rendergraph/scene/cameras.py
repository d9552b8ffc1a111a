"""Camera matrices, orbits, and a camera that frames a scene. Everything in float64, matrices ``[row, column]``."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rendergraph.scene.interior import interior_camera
from rendergraph.scene.scene import F64, Camera, Scene

#: Where a framing camera looks from: a little to the right of and above the front.
_FRAMING_DIRECTION = (0.5, 0.35, 1.0)


def _unit(vector: F64) -> F64:
    """The vector scaled to length 1; zeros for the zero vector. Safe for tiny and huge components."""
    largest = np.abs(vector).max()
    if largest == 0:
        return np.zeros(3)
    scaled: F64 = vector / largest
    return scaled / np.linalg.norm(scaled)


def view_matrix(camera: Camera) -> F64:
    """World to view, ``float64[4, 4]``: the eye at the origin, looking down -z.

    An ``up`` that is zero or parallel to the line of sight is replaced by the world axis least aligned with it; a
    ``target`` equal to ``position`` looks down -z.
    """
    position = np.asarray(camera.position, dtype=np.float64)
    back = _unit(position - np.asarray(camera.target, dtype=np.float64))
    if not back.any():
        back = np.array([0.0, 0.0, 1.0])
    right = np.cross(_unit(np.asarray(camera.up, dtype=np.float64)), back)
    if np.linalg.norm(right) < 1e-6:
        right = np.cross(np.eye(3)[np.abs(back).argmin()], back)
    right = _unit(right)
    rotation = np.stack([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3] = rotation
    view[:3, 3] = -rotation @ position
    return view


def projection_matrix(camera: Camera, aspect: float, reversed: bool = True) -> F64:
    """View to clip with z in 0..1, ``float64[4, 4]``. ``aspect`` is width over height.

    ``reversed``: 1 at the near plane, 0 at the far plane or at infinity; else 0 near and 1 far.
    """
    focal = 1.0 / math.tan(camera.fov / 2)
    near, far = camera.near, camera.far
    if far is None:
        slope, offset = (0.0, near) if reversed else (-1.0, -near)
    elif reversed:
        slope, offset = near / (far - near), far * near / (far - near)
    else:
        slope, offset = far / (near - far), far * near / (near - far)
    return np.array(
        [
            [focal / aspect, 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, slope, offset],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def orbit(camera: Camera, turns: float) -> Camera:
    """The camera after ``turns`` of a circle around the vertical (y) axis through its target, seen from above
    counter-clockwise. Whole turns give the camera back exactly.
    """
    turns = math.fmod(turns, 1.0)
    if turns == 0.0:
        return camera
    cos, sin = math.cos(2 * math.pi * turns), math.sin(2 * math.pi * turns)

    def rotate(x: float, y: float, z: float) -> tuple[float, float, float]:
        return (cos * x + sin * z, y, cos * z - sin * x)

    tx, ty, tz = camera.target
    x, y, z = rotate(camera.position[0] - tx, camera.position[1] - ty, camera.position[2] - tz)
    return replace(camera, position=(tx + x, ty + y, tz + z), up=rotate(*camera.up))


def frame_scene(scene: Scene, fov: float = math.radians(60.0)) -> Camera:
    """A camera in a corner of the room that encloses the scene's middle, looking across; for any other scene, outside
    the bounding sphere, from where the whole sphere is visible in a frame no narrower than it is tall, the near plane
    at a thousandth of the distance. ``fov`` is vertical, radians. There is no far plane.
    """
    inside = interior_camera(scene, fov)
    if inside is not None:
        return inside
    low, high = scene.bounds()
    centre = (low + high) / 2
    radius = float(np.linalg.norm((high - low) / 2)) or 1.0
    distance = radius / math.sin(fov / 2)
    eye = centre + distance * _unit(np.array(_FRAMING_DIRECTION))
    x, y, z = (float(v) for v in eye)
    cx, cy, cz = (float(v) for v in centre)
    return Camera(position=(x, y, z), target=(cx, cy, cz), fov=fov, near=distance * 1e-3, name="framing")
