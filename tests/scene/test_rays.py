"""Rays against triangles whose place is known, and against a plain loop over random ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rendergraph.scene import procedural
from rendergraph.scene.rays import Triangles, cast, world_triangles
from rendergraph.scene.scene import Instance

ORIGIN = np.zeros(3)
FLAT = np.array([[[-1.0, -1.0, -2.0]], [[1.0, -1.0, -2.0]], [[0.0, 1.0, -2.0]]])  # its front faces +z
AHEAD = np.array([[0.0, 0.0, -1.0]])


def sided(corners: np.ndarray, double: bool = False) -> Triangles:
    return Triangles(corners, np.full(corners.shape[1], double))


def test_a_hit_has_its_distance_and_side() -> None:
    hits = cast(sided(FLAT), ORIGIN, np.concatenate([AHEAD, -AHEAD, [[1.0, 0.0, 0.0]]]))
    assert hits.distance.tolist() == [2.0, np.inf, np.inf]
    assert hits.faced.tolist() == [True, False, False]
    behind = cast(sided(FLAT), np.array([0.0, 0.0, -5.0]), -AHEAD)
    assert (behind.distance.tolist(), behind.faced.tolist()) == ([3.0], [False])
    assert cast(sided(FLAT, double=True), np.array([0.0, 0.0, -5.0]), -AHEAD).faced.tolist() == [True]


def test_the_nearest_of_many_wins_in_any_order() -> None:
    for z in ([-2.0, -1.0, -3.0], [-1.0, -3.0, -2.0]):
        corners = np.concatenate([FLAT + np.array([0.0, 0.0, 2.0 + depth]) for depth in z], axis=1)
        assert cast(sided(corners), ORIGIN, AHEAD).distance.tolist() == [1.0]


def test_random_triangles_against_a_plain_loop() -> None:
    """More triangles than are tested together, so that the nearest is found across the runs."""
    rng = np.random.default_rng(5)
    middle = rng.uniform(-5.0, 5.0, (1, 7000, 3))
    corners = middle + rng.normal(scale=0.3, size=(3, 7000, 3))
    directions = rng.normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = cast(sided(corners), ORIGIN, directions)
    assert np.isfinite(hits.distance).sum() > 20
    for direction, distance, faced in zip(directions, hits.distance, hits.faced, strict=True):
        expected, normal = _nearest(corners, direction)
        assert distance == pytest.approx(expected, rel=1e-3)
        if np.isfinite(expected):
            assert faced == (normal @ direction < 0.0)


def _nearest(corners: np.ndarray, direction: np.ndarray) -> tuple[float, np.ndarray]:
    """By solving t d = a + u (b - a) + v (c - a) for every triangle."""
    a, b, c = corners
    system = np.stack([np.broadcast_to(direction, a.shape), a - b, a - c], axis=-1)
    t, u, v = np.linalg.solve(system, a[..., None])[..., 0].T
    t = np.where((t > 0) & (u >= 0) & (v >= 0) & (u + v <= 1), t, np.inf)
    best = int(np.argmin(t))
    return float(t[best]), np.cross(b - a, c - a)[best]


def test_mirrored_instances_keep_their_fronts_outside() -> None:
    scene = procedural.build("cornell", detail=0.0)
    box = next(i for i in scene.instances if i.name == "tall box")
    for mirror in (1.0, -1.0):
        alone = replace(scene, instances=[Instance(box.mesh, np.diag([mirror, 1.0, 1.0, 1.0]))])
        triangles = world_triangles(alone)
        assert triangles.corners.shape[1] == alone.triangles
        assert cast(triangles, np.array([0.1, 0.2, 9.0]), AHEAD).faced.tolist() == [True]
        assert cast(triangles, np.array([0.1, 0.2, 0.0]), AHEAD).faced.tolist() == [False]  # from its inside


def test_nothing_is_hit_where_there_is_nothing() -> None:
    scene = replace(procedural.build("cornell", detail=0.0), instances=[])
    assert np.isinf(cast(world_triangles(scene), ORIGIN, AHEAD).distance).all()
