"""Generated tangents against surfaces whose tangents are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.scene.tangents import _weld, any_tangents, generate_tangents, orthonormal_tangents


def grid(columns, rows):
    """Parameters of a grid of vertices float32[n, 2] in 0..1, and its triangles, counter-clockwise seen from +z."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    corner = (np.arange(columns) + (columns + 1) * np.arange(rows)[:, None]).reshape(-1, 1)
    quads = corner + np.array([0, 1, columns + 2, columns + 1])
    triangles = quads[:, [0, 1, 2, 0, 2, 3]].astype(np.uint32)
    return np.stack([u.ravel(), v.ravel()], axis=1).astype(np.float32), triangles.reshape(-1)


def sphere(columns=96, rows=48):
    """A unit sphere without its poles; u runs east, v north. Positions are normals. Also the analytic dP/du."""
    uv, indices = grid(columns, rows)
    longitude, latitude = 2 * np.pi * uv[:, 0], np.pi * (0.05 + 0.9 * uv[:, 1]) - np.pi / 2
    points = np.stack(
        [np.cos(latitude) * np.cos(longitude), np.sin(latitude), -np.cos(latitude) * np.sin(longitude)], 1
    )
    east = np.stack([-np.sin(longitude), np.zeros_like(longitude), -np.cos(longitude)], axis=1)
    return points.astype(np.float32), uv, indices, east


def worst_angle(space, expected):
    cosines = (space.tangents[:, :3] * expected[space.vertices]).sum(axis=1)
    return float(np.degrees(np.arccos(np.clip(cosines, -1, 1)).max()))


def test_sphere():
    """Tangents run east to within the angle of one column; w is -1, since v as stored runs up the surface."""
    points, uv, indices, east = sphere()
    space = generate_tangents(points, points, uv, indices)
    assert worst_angle(space, east) < 360 / 96
    assert (space.tangents[:, 3] == -1).all()
    north = np.cross(points, east)
    assert worst_angle(space, north) > 80  # the known-bad twin: dP/dv instead of dP/du


def test_error_falls_with_refinement():
    errors = []
    for columns in (24, 48, 96):
        points, uv, indices, east = sphere(columns, columns // 2)
        errors.append(worst_angle(generate_tangents(points, points, uv, indices), east))
    assert errors[0] > 1.8 * errors[1] > 1.8**2 * errors[2]


def test_bitangent_points_up_the_image():
    """glTF: v grows downward, a normal map's green points up. A wall with an upright image has w = +1."""
    uv, indices = grid(1, 1)
    wall = np.pad(uv, ((0, 0), (0, 1)))
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    upright = uv * [1, -1] + [0, 1]
    space = generate_tangents(wall, normals, upright.astype(np.float32), indices)
    np.testing.assert_allclose(space.tangents, [[1, 0, 0, 1]] * 4, atol=1e-6)
    bitangents = np.cross(normals, space.tangents[:, :3]) * space.tangents[:, 3:]
    np.testing.assert_allclose(bitangents, [[0, 1, 0]] * 4, atol=1e-6)


def test_mirrored_uvs_split_the_seam():
    """The right half of a strip repeats the left half mirrored: vertices on the seam become two, with opposite w."""
    uv, indices = grid(2, 1)
    points = np.pad(uv, ((0, 0), (0, 1)))
    mirrored = np.stack([0.5 - np.abs(uv[:, 0] - 0.5), uv[:, 1]], axis=1)
    normals = np.tile(np.float32([0, 0, 1]), (len(points), 1))
    space = generate_tangents(points, normals, mirrored, indices)
    assert len(space.tangents) == len(points) + 2
    left = points[space.vertices][:, 0] < 0.25
    right = points[space.vertices][:, 0] > 0.75
    np.testing.assert_allclose(space.tangents[left], [[1, 0, 0, -1]] * 2, atol=1e-6)
    np.testing.assert_allclose(space.tangents[right], [[-1, 0, 0, 1]] * 2, atol=1e-6)
    np.testing.assert_array_equal(points[space.vertices][space.indices], points[indices])


def test_equal_vertices_are_averaged_although_not_shared():
    """Unindexed triangles of a sphere get the same tangents as indexed ones."""
    points, uv, indices, _ = sphere(24, 12)
    shared = generate_tangents(points, points, uv, indices)
    unshared = generate_tangents(
        points[indices], points[indices], uv[indices], np.arange(len(indices), dtype=np.uint32)
    )
    np.testing.assert_allclose(unshared.tangents[unshared.indices], shared.tangents[shared.indices], atol=1e-6)


def test_corners_are_weighted_by_angle():
    """A vertex with a 90 degree corner whose u runs +x and a 45 degree corner whose u runs +y."""
    points = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 1, 0]])
    normals = np.tile(np.float32([0, 0, 1]), (7, 1))
    corners = points[[0, 1, 2, 0, 2, 3]]
    # Triangle 2: dP/du = +y with the same handedness: u = y, v = -x.
    uv = np.float32([[0, 0], [1, 0], [0, 1], [0, 0], [1, 0], [1, 1]])
    space = generate_tangents(corners, normals[:6], uv, np.arange(6, dtype=np.uint32))
    expected = np.array([90.0, 45.0, 0.0]) / np.hypot(90, 45)
    np.testing.assert_allclose(space.tangents[0, :3], expected, atol=1e-6)
    np.testing.assert_array_equal(space.tangents[0], space.tangents[3])
    assert abs(space.tangents[0, 0] - np.sqrt(0.5)) > 0.1  # the known-bad twin: unweighted


def test_triangle_without_uv_area_takes_its_neighbours_tangent():
    points = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    uv = np.float32([[0, 0], [0, 1], [1, 0], [2, 0]])  # u runs +y; vertices 0, 2, 3 are in line
    space = generate_tangents(points, normals, uv, np.uint32([0, 1, 2, 0, 2, 3]))
    assert len(space.tangents) == 4
    np.testing.assert_allclose(space.tangents[:3], [[0, 1, 0, 1]] * 3, atol=1e-6)
    np.testing.assert_allclose((space.tangents[3, :3] ** 2).sum(), 1, rtol=1e-6)


def test_unused_vertices_are_dropped_and_no_triangles_is_fine():
    points = np.float32([[0, 0, 0], [9, 9, 9], [1, 0, 0], [0, 1, 0]])
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    space = generate_tangents(points, normals, points[:, :2], np.uint32([0, 2, 3]))
    assert space.vertices.tolist() == [0, 2, 3]
    assert generate_tangents(points, normals, points[:, :2], np.zeros(0, np.uint32)).tangents.shape == (0, 4)


def test_weld_survives_a_hash_that_collides(monkeypatch):
    rows = np.float32([[0, 0, 0], [1, 0, 0], [0, 0, 0], [-0.0, 0, 0]])
    expected = _weld(rows, rows, rows[:, :2])
    assert expected[1] == 2
    monkeypatch.setattr("rendergraph.scene.tangents._hash", lambda r: np.zeros(len(r), np.uint64))
    number, count = _weld(rows, rows, rows[:, :2])
    assert count == 2
    assert number[0] == number[2] == number[3] != number[1]


def is_orthonormal(tangents, normals):
    lengths = np.linalg.norm(tangents[:, :3].astype(np.float64), axis=1)
    across = (tangents[:, :3].astype(np.float64) * normals).sum(axis=1)
    return bool(
        (np.abs(lengths - 1) < 1e-5).all() and (np.abs(across) < 1e-5).all() and (np.abs(tangents[:, 3]) == 1).all()
    )


def test_any_tangents_are_orthonormal():
    normals = np.random.default_rng(1).normal(size=(1000, 3))
    normals = np.vstack([normals / np.linalg.norm(normals, axis=1)[:, None], np.eye(3), -np.eye(3), [[1e-9, 0, -1]]])
    tangents = any_tangents(normals.astype(np.float32))
    assert is_orthonormal(tangents, normals)
    assert not is_orthonormal(tangents * np.float32([1.001, 1, 1, 1]), normals)


def test_given_tangents_are_cleaned():
    normals = np.tile(np.float32([0, 0, 1]), (5, 1))
    given_tangents = np.float32([[2, 0, 1, 1], [0, 1, 0, -0.5], [0, 0, 0, 1], [0, 0, 1, 0], [0, 0, -3, 1]])
    tangents = orthonormal_tangents(given_tangents, normals)
    assert is_orthonormal(tangents, normals)
    np.testing.assert_allclose(tangents[:2], [[1, 0, 0, 1], [0, 1, 0, -1]], atol=1e-6)


EXTREMES = [0.0, 1.0, -1.0, 0.5, 1e-20, 1e18, -1e18, 1e-30, 3.0]


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    st.lists(st.sampled_from(EXTREMES), min_size=30, max_size=30), st.lists(st.integers(0, 5), min_size=3, max_size=12)
)
def test_always_finite_and_orthonormal(values, corners):
    table = np.float32(values).reshape(6, 5)
    normals = np.tile(np.float32([0, 0.6, 0.8]), (6, 1))
    indices = np.uint32(corners[: len(corners) // 3 * 3])
    space = generate_tangents(table[:, :3].copy(), normals, table[:, 3:].copy(), indices)
    assert is_orthonormal(space.tangents, normals[space.vertices])
    assert np.array_equal(space.vertices[space.indices], indices)


def test_the_orthonormality_check_can_fail():
    with pytest.raises(AssertionError):
        assert is_orthonormal(np.float32([[1, 0, 0, 0]]), np.float32([[0, 0, 1]]))
