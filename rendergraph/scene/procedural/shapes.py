"""Primitive shapes with exact normals and tangents: sheets, lathed solids, spheres, discs, bars.

Texture coordinates are in metres unless said otherwise; ``Geometry.mapped`` scales them. v falls as y rises, so that
textures stand upright.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from rendergraph.scene.procedural.geometry import F64, Geometry, merge, surface, unit


def sheet(
    corner: Sequence[float], right: Sequence[float], up: Sequence[float], cells: tuple[int, int] = (1, 1)
) -> Geometry:
    """A flat parallelogram facing ``cross(right, up)``, with ``cells`` quads along right and up."""
    r, u = np.asarray(right, float), np.asarray(up, float)
    s, t = np.meshgrid(np.linspace(0.0, 1.0, cells[0] + 1), np.linspace(0.0, 1.0, cells[1] + 1))
    points = np.asarray(corner, float) + s[..., None] * r + t[..., None] * u
    return surface(points, np.stack([s * np.linalg.norm(r), -t * np.linalg.norm(u)], axis=-1))


Modulation = Callable[[F64, F64], F64]


def lathe(
    profile: Sequence[Sequence[tuple[float, float]]] | Sequence[F64], around: int, modulation: Modulation | None = None
) -> Geometry:
    """A solid of revolution about y. ``profile``: smooth runs of (radius, y), bottom to top outside, creased between.

    ``modulation(angle, y)`` multiplies the radius (fluting, leaves); normals then come from differences.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1)
    ring = np.stack([np.cos(angle), np.zeros_like(angle), -np.sin(angle)], axis=-1)
    along = np.stack([-np.sin(angle), np.zeros_like(angle), -np.cos(angle)], axis=-1)
    parts = []
    travelled = 0.0
    for run in profile:
        points = np.asarray(run, float)
        step = np.linalg.norm(np.diff(points, axis=0), axis=1)
        length = travelled + np.concatenate([[0.0], np.cumsum(step)])
        travelled = float(length[-1])
        radius = np.broadcast_to(points[:, :1], (len(points), around + 1))
        if modulation is not None:
            radius = radius * modulation(angle[None, :], points[:, 1:])
        grid = radius[..., None] * ring
        grid[..., 1] = points[:, 1:]
        girth = 2.0 * np.pi * max(float(points[:, 0].max()), 1e-3)
        repeats = max(1, round(girth))  # whole, so that tiling textures meet at the seam
        u, v = np.meshgrid(angle / (2.0 * np.pi) * repeats, -length)
        normals = None
        if modulation is None:
            slope = unit(np.gradient(points, axis=0))
            normals = slope[:, None, 1:] * ring - slope[:, None, :1] * np.array([0.0, 1.0, 0.0])
        parts.append(
            surface(
                grid,
                np.stack([u, v], axis=-1),
                closed_columns=True,
                normals=normals,
                along=None if normals is None else along + 0.0 * grid,
            )
        )
    return merge(parts)


def sphere(radius: float, around: int, rings: int) -> Geometry:
    """A sphere about the origin; uv covers the texture twice around and once from pole to pole."""
    polar = np.linspace(-np.pi / 2.0, np.pi / 2.0, rings + 1)
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1)
    a, p = np.meshgrid(angle, polar)
    normals = np.stack([np.cos(p) * np.cos(a), np.sin(p), -np.cos(p) * np.sin(a)], axis=-1)
    normals[0], normals[-1] = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)
    along = np.stack([-np.sin(a), np.zeros_like(a), -np.cos(a)], axis=-1)
    uv = np.stack([a / np.pi, 0.5 - p / np.pi], axis=-1)
    points = normals * radius
    return surface(points, uv, closed_columns=True, normals=normals, along=along)


def disc(radius: float, around: int, rings: int, y: float = 0.0) -> Geometry:
    """A flat disc that faces up; planar uv."""
    r = np.linspace(radius, 0.0, rings + 1)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1)[None, :]
    points = np.stack([r * np.cos(angle), np.full((rings + 1, around + 1), y), -r * np.sin(angle)], axis=-1)
    flat = surface(points, points[..., [0, 2]] * 1.0, normals=np.broadcast_to([0.0, 1.0, 0.0], points.shape).copy())
    tangents = np.tile([1.0, 0.0, 0.0, 1.0], (len(flat.positions), 1))
    return Geometry(flat.positions, flat.normals, tangents, flat.uv, flat.indices)


def bar(start: Sequence[float], end: Sequence[float], radius: float, around: int) -> Geometry:
    """A closed round bar between two points."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(b - a))
    solid = lathe(
        [[(0.0, 0.0), (radius, 0.0)], [(radius, 0.0), (radius, length)], [(radius, length), (0.0, length)]], around
    )
    up = (b - a) / length
    side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    side /= np.linalg.norm(side)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = side, up, np.cross(side, up)
    matrix[:3, 3] = a
    return solid.placed(matrix)
