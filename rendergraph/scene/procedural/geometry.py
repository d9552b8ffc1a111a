"""Triangle geometry before it joins a scene: arrays, placing, merging, and parametric surfaces.

Counter-clockwise triangles face outwards. Tangents follow glTF: xyz points along growing u, and
``w * cross(normal, tangent)`` along *falling* v, because v grows downward in glTF images.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]
I64 = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Geometry:
    """positions, normals float64[n, 3]; tangents float64[n, 4]; uv float64[n, 2]; indices int64[3 * triangles]."""

    positions: F64
    normals: F64
    tangents: F64
    uv: F64
    indices: I64

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        return len(self.indices) // 3

    def placed(self, matrix: F64) -> Geometry:
        """The same geometry moved by an affine float64[4, 4]; a mirroring matrix is refused with ``ValueError``."""
        linear = matrix[:3, :3]
        if np.linalg.det(linear) <= 0.0:
            raise ValueError("a mirroring matrix would turn the triangles inside out")
        normals = unit(self.normals @ np.linalg.inv(linear))
        tangents = orthonormal(self.tangents[:, :3] @ linear.T, normals)
        return replace(
            self,
            positions=self.positions @ linear.T + matrix[:3, 3],
            normals=normals,
            tangents=np.concatenate([tangents, self.tangents[:, 3:]], axis=1),
        )

    def moved(self, x: float, y: float, z: float) -> Geometry:
        """The same geometry translated."""
        return replace(self, positions=self.positions + np.array([x, y, z]))

    def mapped(self, scale: float = 1.0, offset: tuple[float, float] = (0.0, 0.0)) -> Geometry:
        """The same geometry with other texture coordinates."""
        return replace(self, uv=self.uv * scale + np.array(offset))

    def signed_volume(self) -> float:
        """Volume by the divergence theorem: positive when a closed surface's triangles face outwards."""
        a, b, c = (self.positions[self.indices[k::3]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def merge(parts: Sequence[Geometry]) -> Geometry:
    """One geometry out of several."""
    starts = np.cumsum([0, *(len(p.positions) for p in parts)])
    return Geometry(
        np.concatenate([p.positions for p in parts]),
        np.concatenate([p.normals for p in parts]),
        np.concatenate([p.tangents for p in parts]),
        np.concatenate([p.uv for p in parts]),
        np.concatenate([p.indices + start for p, start in zip(parts, starts, strict=False)]),
    )


def unit(vectors: F64) -> F64:
    """Vectors scaled to length one along the last axis; zero vectors stay zero."""
    length = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))[..., None]
    return vectors / np.where(length > 0.0, length, 1.0)


def orthonormal(tangents: F64, normals: F64) -> F64:
    """Unit tangents made orthogonal to unit normals; any orthogonal direction where a tangent vanishes."""
    flat = tangents - normals * np.einsum("...i,...i->...", tangents, normals)[..., None]
    lost = np.einsum("...i,...i->...", flat, flat) < 1e-16
    if lost.any():
        axis = np.eye(3)[np.argmin(np.abs(normals[lost]), axis=-1)]
        flat[lost] = np.cross(normals[lost], axis)
    return unit(flat)


def surface(
    points: F64,
    uv: F64,
    *,
    closed_columns: bool = False,
    normals: F64 | None = None,
    along: F64 | None = None,
) -> Geometry:
    """A grid of quads through ``points`` float64[rows, columns, 3], with ``uv`` float64[rows, columns, 2].

    The front side is the one of ``cross(d/dcolumn, d/drow)``: seen from it, columns run right and rows run up.
    Normals (unless given) and tangents are the grid's central differences; ``closed_columns`` says that the first and
    the last column are the same place, so that no seam shows. ``along``: d/dcolumn, where known exactly (poles).
    Triangles without area, as at the poles of a sphere, are left out.
    """
    rows, columns = points.shape[:2]
    d_column = _difference(points, 1, closed_columns)
    d_row = _difference(points, 0, False)
    if normals is None:
        normals = unit(np.cross(d_column, d_row))
    if along is not None:
        d_column = along
    uv_column, uv_row = _difference(uv, 1, False), _difference(uv, 0, False)
    # dP/du and dP/dv from the chain rule: [dP/dcolumn, dP/drow] = [dP/du, dP/dv] J.
    determinant = uv_column[..., :1] * uv_row[..., 1:] - uv_column[..., 1:] * uv_row[..., :1]
    sign = np.where(determinant < 0.0, -1.0, 1.0)
    d_u = (d_column * uv_row[..., 1:] - d_row * uv_column[..., 1:]) * sign
    d_v = (d_row * uv_column[..., :1] - d_column * uv_row[..., :1]) * sign
    tangents = orthonormal(d_u, normals)
    hand = np.where(np.einsum("rci,rci->rc", np.cross(normals, tangents), d_v) > 0.0, -1.0, 1.0)
    quad = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    corners = np.stack([quad, quad + 1, quad + columns + 1, quad, quad + columns + 1, quad + columns], axis=1)
    triangles = corners.reshape(-1, 3)
    flat = points.reshape(-1, 3)
    a, b, c = (flat[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    triangles = triangles[np.einsum("ij,ij->i", cross, cross) > 1e-20]
    return Geometry(
        flat,
        normals.reshape(-1, 3),
        np.concatenate([tangents, hand[..., None]], axis=-1).reshape(-1, 4),
        uv.reshape(-1, 2),
        triangles.ravel(),
    )


def _difference(values: F64, axis: int, closed: bool) -> F64:
    """Central differences along an axis of a grid, one-sided at its ends unless ``closed``."""
    result = np.gradient(values, axis=axis)
    if closed:
        wrapped = (values[:, 1] - values[:, -2]) / 2.0
        result[:, 0] = wrapped
        result[:, -1] = wrapped
    return np.asarray(result)
