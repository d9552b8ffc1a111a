"""The chamfered block: what masonry, beams and boxes are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
import numpy.typing as npt

from rendergraph.scene.procedural.geometry import F64, I64, Geometry, unit


@dataclass(frozen=True, slots=True)
class _Template:
    """Any block's vertices: position = ``sign * where(outer, half, half - bevel)``, uv = position . u_axis, v_axis."""

    sign: F64
    outer: npt.NDArray[np.bool_]
    normals: F64
    tangents: F64
    u_axis: F64
    v_axis: F64
    indices: I64


def block(size: Sequence[float], centre: Sequence[float] = (0.0, 0.0, 0.0), bevel: float = 0.0) -> Geometry:
    """A closed box whose edges are chamfered by ``bevel`` and shaded round: 44 triangles, or 12 without a bevel.

    Chamfers carry the normals of the faces they join, so light rolls over the edge; their tangent runs along the edge,
    the one direction both faces share. uv in metres, about the centre.
    """
    half = np.asarray(size, float) / 2.0
    bevel = min(bevel, float(half.min()) * 0.9)
    shape = _template(bevel > 0.0)
    positions = shape.sign * np.where(shape.outer, half, half - bevel)
    uv = np.stack([(positions * shape.u_axis).sum(1), (positions * shape.v_axis).sum(1)], axis=1)
    return Geometry(positions + np.asarray(centre, float), shape.normals, shape.tangents, uv, shape.indices)


def _face_axes(axis: int, side: float) -> tuple[F64, F64]:
    """Right and up of a box face seen from outside; up is the world's up on the four vertical faces."""
    up = np.array([0.0, 1.0, 0.0]) if axis != 1 else np.array([0.0, 0.0, -side])
    return np.cross(up, np.eye(3)[axis] * side), up


@cache
def _template(chamfered: bool) -> _Template:
    axes = np.eye(3)
    # A vertex: sign, reach, normal, tangent, u axis, v axis. Points are tried at half = 2, half - bevel = 1.
    vertices: list[tuple[F64, F64, F64, F64, F64, F64]] = []
    triangles: list[tuple[int, ...]] = []

    def polygon(points: list[F64], normals: list[F64], tangents: list[F64]) -> None:
        facing = np.sum(normals, axis=0)
        if np.dot(np.cross(points[1] - points[0], points[2] - points[0]), facing) < 0.0:
            points, normals, tangents = points[::-1], normals[::-1], tangents[::-1]
        first = len(vertices)
        right = unit(np.sum(tangents, axis=0))
        down = -np.cross(unit(facing), right)
        for point, normal, tangent in zip(points, normals, tangents, strict=True):
            vertices.append((np.sign(point), np.abs(point), normal, tangent, right, down))
        triangles.extend((first, first + k, first + k + 1) for k in range(1, len(points) - 1))

    for axis, side in product(range(3), (-1.0, 1.0)):
        right, up = _face_axes(axis, side)
        normal = axes[axis] * side
        points = [2.0 * normal + s * right + t * up for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        polygon(points, [normal] * 4, [right] * 4)
    if chamfered:
        for axis, s, t in product(range(3), (-1.0, 1.0), (-1.0, 1.0)):
            n_a, n_b = axes[(axis + 1) % 3] * s, axes[(axis + 2) % 3] * t
            a, b, along = 2.0 * n_a + n_b, n_a + 2.0 * n_b, axes[axis]
            polygon([a - along, a + along, b + along, b - along], [n_a, n_a, n_b, n_b], [along] * 4)
        for corner in product((-1.0, 1.0), repeat=3):
            sign = np.array(corner)
            # Orthogonal to the corner's diagonal, so that no interpolated tangent meets its normal.
            flat = np.array([sign[0], -sign[1], 0.0])
            normals = [axes[k] * sign for k in range(3)]
            tangents = [unit(flat - n * (n @ flat)) for n in normals]
            polygon([sign + n for n in normals], normals, tangents)

    sign, reach, normal, tangent, across, down = (np.array(column) for column in zip(*vertices, strict=True))
    # Without chamfers the faces' corners are the box's: every coordinate reaches out.
    outer = reach > 1.5 if chamfered else np.ones_like(reach, dtype=bool)
    with_sign = np.column_stack([tangent, np.ones(len(tangent))])
    return _Template(sign, outer, normal, with_sign, across, down, np.array(triangles).ravel())
