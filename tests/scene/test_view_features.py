"""What is claimed of a view is so; what is near the limit is not claimed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rendergraph.scene.cameras import projection_matrix, view_matrix
from rendergraph.scene.coverage import covers_view
from rendergraph.scene.features import ViewFeatures
from rendergraph.scene.scene import Alpha, Ambient, Camera, Light, Material, Scene, Sun
from rendergraph.scene.view_features import box_corners, frustum_planes, view_features
from tests.nodes.scene_render import Quad, quad_scene

EYE = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov=math.radians(90), near=0.1)
PLAIN = Material()
GLASS = Material(alpha=Alpha.BLENDED)


def wall(z: float = 0.0, reach: float = 30.0, material: int = 0) -> Quad:
    """A square that faces +z."""
    return Quad((-reach, -reach, z), (2 * reach, 0, 0), (0, 2 * reach, 0), material)


def small(x: float, y: float, z: float, material: int = 0) -> Quad:
    """A decimetre."""
    return Quad((x, y, z), (0.1, 0, 0), (0, 0.1, 0), material)


def view(scene: Scene, *cameras: Camera, aspect: float = 1.0) -> ViewFeatures:
    found = view_features(scene, cameras or (EYE,), aspect)
    assert found is not None
    return found


# ---- in view


@pytest.mark.parametrize(
    ("quad", "seen"),
    [
        (small(0, 0, 0), True),
        (small(3.85, 0, 0), True),  # the edge of a view of 90 degrees, 4 m away
        (small(4.01, 0, 0), True),  # nearer than the slack
        (small(4.3, 0, 0), False),
        (small(-4.5, 0, 0), False),
        (small(0, 4.3, 0), False),
        (small(0, -4.5, 0), False),
        (small(0, 0, 5), False),  # behind
        (small(0, 0, 3.95), False),  # before the near plane
        (small(0, 0, -1e6), True),  # there is no far plane
    ],
)
def test_what_is_in_view(quad: Quad, seen: bool) -> None:
    scene = quad_scene([wall(-50.0), replace(quad, material=1)], [PLAIN, GLASS])
    assert ("blended" not in view(scene).unseen) == seen


def test_a_wider_frame_sees_more_at_its_sides() -> None:
    scene = quad_scene([small(6, 0, 0, 1)], [PLAIN, GLASS])
    assert "blended" in view(scene, aspect=1.0).unseen
    assert "blended" not in view(scene, aspect=2.0).unseen


def test_a_far_plane_ends_the_view() -> None:
    scene = quad_scene([small(0, 0, -20, 1)], [PLAIN, GLASS])
    assert "blended" in view(scene, replace(EYE, far=10.0)).unseen
    assert "blended" not in view(scene, replace(EYE, far=30.0)).unseen


def test_what_any_camera_sees_is_seen() -> None:
    scene = quad_scene([wall(-50.0), small(0, 0, 8, 1)], [PLAIN, GLASS])
    turned = replace(EYE, target=(0.0, 0.0, 8.0))
    assert "blended" in view(scene, EYE).unseen
    assert "blended" not in view(scene, EYE, turned).unseen


def test_features_are_of_instances_not_of_their_neighbours() -> None:
    lamp = Material(emissive=(1.0, 0.0, 0.0), double_sided=True, unlit=True)
    scene = quad_scene([wall(), small(0, 0, 9, 1)], [PLAIN, lamp])
    assert view(scene).unseen == {"emissive", "double_sided", "unlit"}


def test_nothing_is_unseen_that_is_not_there() -> None:
    assert view(quad_scene([], [])).unseen == frozenset()


def test_too_many_cameras_claim_nothing() -> None:
    scene = quad_scene([wall()] * 4, [PLAIN])
    cameras = [replace(EYE, near=0.1 + 1e-7 * n) for n in range(1_000_001)]
    assert view_features(scene, cameras, 1.0) is None


@pytest.mark.parametrize("scale", [np.inf, np.nan])
def test_bounds_that_are_no_numbers_claim_nothing(scale: float) -> None:
    world = np.diag([scale, 1.0, 1.0, 1.0])
    with np.errstate(invalid="ignore"):
        assert view_features(quad_scene([replace(wall(), world=world)], [PLAIN]), [EYE], 1.0) is None


@pytest.mark.parametrize("scale", [1e-30, 1e30])
@pytest.mark.parametrize("offset", [0.0, 1e6, 1e30])
@pytest.mark.parametrize("fov", [0.01, 3.1])
def test_extremes_are_looked_at_without_a_warning(scale: float, offset: float, fov: float) -> None:
    world = np.diag([scale, scale, scale, 1.0])
    world[:3, 3] = offset
    scene = quad_scene([replace(wall(), world=world)], [PLAIN], sun=DOWN, lights=[Light((0, 0, 0), (1, 1, 1), 1e30)])
    camera = Camera((offset, offset, offset + 4.0), (offset, offset, 0.0), fov=fov, near=1e-3, far=1e6)
    assert view_features(scene, [camera], 1e-4) is not None


@pytest.mark.parametrize("seed", range(20))
def test_a_point_that_is_drawn_is_inside_of_all_planes(seed: int) -> None:
    """Against the projection that the shaders use."""
    chance = np.random.default_rng(seed)
    camera = Camera(
        tuple(chance.uniform(-5, 5, 3)), tuple(chance.uniform(-5, 5, 3)), fov=float(chance.uniform(0.2, 2.8)),
        near=0.1, far=float(chance.uniform(5, 50)),
    )  # fmt: skip
    aspect = float(chance.uniform(0.3, 3.0))
    points = chance.uniform(-30, 30, (4000, 3))
    clip = np.c_[points, np.ones(4000)] @ (projection_matrix(camera, aspect) @ view_matrix(camera)).T
    w = clip[:, 3:]
    drawn = ((np.abs(clip[:, :2]) <= w).all(axis=1)) & (clip[:, 2] >= 0) & (clip[:, 2] <= w[:, 0])
    planes = frustum_planes(camera, aspect)
    inside = (points @ planes[:, :3].T + planes[:, 3] >= 0).all(axis=1)
    assert inside[drawn].all()
    assert inside.sum() <= drawn.sum() * 1.3 + 12, "no wider than needed"


def test_corners_hold_the_transformed_box() -> None:
    world = np.array([[0, -2, 0, 5], [1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1]], dtype=float)
    scene = quad_scene([replace(wall(reach=1.0), world=world)], [PLAIN])
    corners = box_corners(scene)[0]
    assert corners.shape == (8, 3)
    exact = np.array([[x, y, 0, 1] for x in (-1, 1) for y in (-1, 1)], dtype=float) @ world.T
    assert np.allclose(corners.min(axis=0), exact[:, :3].min(axis=0))
    assert np.allclose(corners.max(axis=0), exact[:, :3].max(axis=0))


# ---- lights


@pytest.mark.parametrize(
    ("light", "lit"),
    [
        (Light((0, 0, 0), (1, 1, 1), 1.0), True),
        (Light((0, 0, 6), (1, 1, 1), 1.5), False),
        (Light((0, 0, 6), (1, 1, 1), 2.5), True),
        (Light((0, 0, 6), (1, 1, 1), 1.0, circle=-1.5), True),
        (Light((0, 0, 0), (0, 0, 0), 1.0), False),
        (Light((0, 0, 0), (1, 1, 1), 0.0), False),
    ],
)
def test_lights_that_reach_the_view(light: Light, lit: bool) -> None:
    assert view(quad_scene([wall()], [PLAIN], lights=[light])).lit == lit


# ---- shadows


DOWN = Sun((0.0, -1.0, 0.0), (1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("quads", "casters"),
    [
        ([small(0, 0, 0)], True),  # it may shade itself
        ([small(0, 0, 0, 1)], False),  # glass throws no shadow
        ([small(0, 0, 0, 1), small(40, 3, 0)], True),  # above, though far beside
        ([small(0, 0, 0, 1), small(40, -3, 0)], False),  # below
        ([small(0, 0, 9)], False),  # nothing to be shaded in view
        ([], False),
    ],
)
def test_casters(quads: list[Quad], casters: bool) -> None:
    assert view(quad_scene(quads, [PLAIN, GLASS], sun=DOWN)).casters == casters


def test_without_a_sun_nothing_is_cast() -> None:
    assert not view(quad_scene([wall()], [PLAIN], ambient=Ambient((1, 1, 1), (1, 1, 1)))).casters


# ---- depth


def test_depths_in_view_are_bounded_in_octaves() -> None:
    scene = quad_scene([small(0, 0, 0), small(0, 0, -16), small(0, 0, 100)], [PLAIN])
    assert view(scene).depth_range == (2.0, 32.0)  # 4 m, less rounding, and 20 m
    assert view(scene, replace(EYE, position=(0.0, 0.0, 4.5))).depth_range == (4.0, 32.0)
    assert view(quad_scene([small(0, 0, 9)], [PLAIN])).depth_range is None


def test_the_near_plane_bounds_depth() -> None:
    assert view(quad_scene([Quad((0, -1, 8), (1, 0, 0), (0, 0, -9))], [PLAIN])).depth_range == (0.0625, 8.0)


# ---- coverage


def grid(n: int, reach: float, material: int = 0, hole: int | None = None) -> list[Quad]:
    """A wall of n x n tiles whose corners coincide, less one."""
    step = 2.0 * reach / n
    tiles = [Quad((-reach + step * x, -reach + step * y, 0), (step, 0, 0), (0, step, 0), material)
             for y in range(n) for x in range(n)]  # fmt: skip
    return [tile for index, tile in enumerate(tiles) if index != hole]


@pytest.mark.parametrize(
    ("quads", "covered"),
    [
        ([wall()], True),
        ([wall(reach=4.0)], False),  # exactly the view: too near to call
        ([wall(reach=4.2)], True),
        ([wall(reach=3.0)], False),
        (grid(4, 32.0), True),
        (grid(5, 32.0, hole=12), False),  # in the middle
        (grid(5, 8.0, hole=6), False),  # beside it, and in view
        (grid(9, 32.0, hole=0), True),  # out of view
        ([wall(material=1)], False),  # glass
        ([Quad((30, -30, 0), (-60, 0, 0), (0, 60, 0))], False),  # its back, which is not drawn
        ([wall(3.95)], False),  # before the near plane
        ([], False),
    ],
)
def test_covered_views(quads: list[Quad], covered: bool) -> None:
    scene = quad_scene(quads, [PLAIN, GLASS])
    assert covers_view(scene, EYE, 1.0) == covered
    assert view(scene).covered == covered


def test_backs_of_double_sided_walls_cover() -> None:
    back = Quad((30, -30, 0), (-60, 0, 0), (0, 60, 0))
    assert covers_view(quad_scene([back], [Material(double_sided=True)]), EYE, 1.0)


def test_a_mirrored_wall_shows_its_front() -> None:
    mirrored = np.diag([-1.0, 1.0, 1.0, 1.0])
    back = Quad((30, -30, 0), (-60, 0, 0), (0, 60, 0), world=mirrored)
    assert not covers_view(quad_scene([back], [PLAIN]), EYE, 1.0), "a mirror in x turns no normal along z"
    assert covers_view(quad_scene([replace(wall(), world=mirrored)], [PLAIN]), EYE, 1.0)


def test_tiles_of_different_transforms_may_leave_cracks() -> None:
    moved = np.eye(4)
    moved[0, 3] = 1.0
    halves = [Quad((-30, -30, 0), (30, 0, 0), (0, 60, 0)), Quad((-1, -30, 0), (31, 0, 0), (0, 60, 0), world=moved)]
    assert not covers_view(quad_scene(halves, [PLAIN]), EYE, 1.0)


def test_a_wall_near_the_far_plane_is_not_relied_on() -> None:
    scene = quad_scene([wall(reach=300.0)], [PLAIN])
    assert covers_view(scene, replace(EYE, far=100.0), 1.0)
    assert not covers_view(scene, replace(EYE, far=4.001), 1.0)
    assert not covers_view(scene, replace(EYE, near=1e-5), 1.0), "16 bits of depth could not tell it from the sky"


def test_every_camera_must_be_covered() -> None:
    scene = quad_scene([wall(reach=5.0)], [PLAIN])
    assert view(scene, EYE).covered
    assert not view(scene, EYE, replace(EYE, target=(3.0, 0.0, 0.0))).covered
