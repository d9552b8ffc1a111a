"""Cameras: matrices against points whose place is known."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from rendergraph.scene.cameras import frame_scene, orbit, projection_matrix, view_matrix
from rendergraph.scene.scene import Camera, Instance, Material, Mesh, Scene

EYE = Camera(position=(1.0, 2.0, 3.0), target=(1.0, 2.0, -7.0))


def apply(matrix, point):
    x, y, z, w = matrix @ [*point, 1.0]
    return np.array([x, y, z]) / w


def test_view_puts_the_eye_at_the_origin_and_the_target_ahead():
    np.testing.assert_allclose(apply(view_matrix(EYE), EYE.position), 0, atol=1e-12)
    np.testing.assert_allclose(apply(view_matrix(EYE), EYE.target), [0, 0, -10], atol=1e-12)
    np.testing.assert_allclose(apply(view_matrix(EYE), (2, 2, 3)), [1, 0, 0], atol=1e-12)


@pytest.mark.parametrize("target", [(0, 1, 0), (0, -1, 0), (1e-9, -5, 0), (0, 0, 0), (3e8, 1e-8, 2), (1e-200, 0, 0)])
@pytest.mark.parametrize("up", [(0, 1, 0), (0, 0, 0), (0, -7, 0), (1e-200, 0, 0)])
def test_view_is_a_rotation_wherever_it_looks(target, up):
    rotation = view_matrix(Camera((0, 0, 0), target, up))[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_up_is_up():
    assert apply(view_matrix(Camera((0, 0, 0), (1, -1, 2))), (0, 1, 0))[1] > 0


@pytest.mark.parametrize(("reversed", "near", "far"), [(True, 1.0, 0.0), (False, 0.0, 1.0)])
def test_depth_conventions(reversed, near, far):
    finite = projection_matrix(Camera((0, 0, 0), (0, 0, -1), near=0.1, far=50.0), 1.5, reversed)
    assert apply(finite, (0, 0, -0.1))[2] == pytest.approx(near, abs=1e-12)
    assert apply(finite, (0, 0, -50))[2] == pytest.approx(far, abs=1e-12)
    endless = projection_matrix(Camera((0, 0, 0), (0, 0, -1), near=0.1), 1.5, reversed)
    assert apply(endless, (0, 0, -0.1))[2] == pytest.approx(near, abs=1e-12)
    assert apply(endless, (0, 0, -1e12))[2] == pytest.approx(far, abs=1e-9)


def test_infinite_far_is_the_limit_of_finite():
    endless, finite = (Camera((0, 0, 0), (0, 0, -1), near=0.1, far=far) for far in (None, 1e9))
    for reversed in (True, False):
        difference = projection_matrix(endless, 1, reversed) - projection_matrix(finite, 1, reversed)
        assert np.abs(difference).max() < 1e-9


def test_field_of_view_is_vertical():
    camera = Camera((0, 0, 0), (0, 0, -1), fov=math.radians(90))
    projection = projection_matrix(camera, 2.0)
    np.testing.assert_allclose(apply(projection, (0, 3, -3))[:2], [0, 1], atol=1e-12)
    np.testing.assert_allclose(apply(projection, (6, 0, -3))[:2], [1, 0], atol=1e-12)


def test_orbit():
    camera = Camera((3.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    quarter = orbit(camera, 0.25)
    assert quarter.position == pytest.approx((1, 1, -2))
    assert (quarter.target, quarter.fov) == (camera.target, camera.fov)
    assert orbit(camera, 3.0) is camera
    assert orbit(camera, 0.5).position == pytest.approx((-1, 1, 0))
    assert orbit(camera, -0.25).position == pytest.approx(orbit(camera, 0.75).position)


def test_orbit_turns_up_too():
    tilted = Camera((1, 0, 0), (0, 0, 0), up=(1, 1, 0))
    assert orbit(tilted, 0.25).up == pytest.approx((0, 1, -1))


def box_scene(low, high):
    mesh = Mesh(0, 3, 0, 0, low, high)
    empty = {f"{name}": np.zeros((0, width), np.float32) for name, width in
             (("positions", 3), ("normals", 3), ("tangents", 4), ("uv0", 2), ("uv1", 2), ("colors", 4))}  # fmt: skip
    return Scene("box", **empty, indices=np.zeros(0, np.uint32), meshes=[mesh], instances=[Instance(0, np.eye(4))],
                 materials=[Material()])  # fmt: skip


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e9])
@pytest.mark.parametrize("aspect", [1.0, 16 / 9])
def test_framed_scene_is_wholly_visible(size, aspect):
    low, high = (-size, 0.0, size), (3 * size, size, 2 * size)
    camera = frame_scene(box_scene(low, high))
    to_clip = projection_matrix(camera, aspect) @ view_matrix(camera)
    corners = np.array([apply(to_clip, corner) for corner in product(*zip(low, high, strict=True))])
    assert (np.abs(corners[:, :2]) <= 1).all()
    assert np.abs(corners[:, :2]).max() > 0.4  # not lost in the distance
    assert (corners[:, 2] > 0).all()
    assert (corners[:, 2] < 1).all()


def test_framing_a_point_or_nothing():
    for scene in (box_scene((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)), box_scene((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))):
        camera = frame_scene(scene)
        assert math.dist(camera.position, camera.target) > 0
        assert camera.near > 0
