"""Vertex tangents in the manner of MikkTSpace, vectorised.

After M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited" (2008), and his mikktspace reference: a corner's tangent
is dP/du of its triangle projected into the plane of the vertex normal; corners with equal position, normal and texture
coordinate and equal handedness are averaged, weighted by the corner's angle. Where the two handednesses meet (mirrored
uvs) the vertex is split. Unlike the reference, corners that share a vertex but no edge are averaged too.

The bitangent is ``cross(normal, tangent.xyz) * tangent.w``. glTF's v grows downward while a normal map's green points
up, so w is +1 where the uvs run clockwise on the surface as stored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import F32, F64, U32


@dataclass(frozen=True, slots=True)
class TangentSpace:
    """A mesh with its vertices split where needed.

    ``tangents``: float32[m, 4]; ``vertices``: uint32[m], the vertex each was made from (unused ones are dropped);
    ``indices``: uint32[3t] into the new vertices.
    """

    tangents: F32
    vertices: U32
    indices: U32


def generate_tangents(positions: F32, normals: F32, uv: F32, indices: U32) -> TangentSpace:
    """Tangents of a triangle list. positions float32[n, 3], unit normals float32[n, 3], uv float32[n, 2],
    indices uint32[3t]. Triangles without area, in space or in uv, take their neighbours' tangent; a vertex that has no
    other gets some tangent perpendicular to its normal. Everything returned is finite and orthonormal.
    """
    corners = indices.reshape(-1, 3).astype(np.int64)
    welded, count = _weld(positions, normals, uv)
    along_u, clockwise, sound = _triangle_tangents(
        positions[corners].astype(np.float64), uv[corners].astype(np.float64)
    )
    corner_normals = normals[corners].astype(np.float64)
    projected = _unit(_reject(np.broadcast_to(along_u[:, None, :], corner_normals.shape), corner_normals))
    weights = _corner_angles(positions[corners].astype(np.float64), corner_normals) * sound[:, None]

    groups = welded[corners] * 2 + clockwise[:, None]
    # A triangle without area has no handedness of its own: its corners join the heavier group of their vertex.
    mass = np.bincount(groups.ravel(), weights.ravel(), minlength=2 * count)
    joined = welded[corners] * 2 + (mass[1::2] > mass[::2])[welded[corners]]
    groups = np.where(sound[:, None], groups, joined)

    weighted = (projected * weights[:, :, None]).reshape(-1, 3)
    sums = np.stack([np.bincount(groups.ravel(), weighted[:, axis], minlength=2 * count) for axis in range(3)], axis=1)

    splits = corners * 2 + (groups & 1)
    used = np.zeros(2 * len(positions), dtype=bool)
    used[splits] = True
    kept = np.flatnonzero(used)
    vertices = kept >> 1
    tangents = np.empty((len(kept), 4), dtype=np.float32)
    tangents[:, :3] = _orthonormal(sums[welded[vertices] * 2 + (kept & 1)], normals[vertices].astype(np.float64))
    tangents[:, 3] = np.where(kept & 1, 1.0, -1.0)
    new_indices = (np.cumsum(used) - 1)[splits].reshape(-1)
    return TangentSpace(tangents, vertices.astype(np.uint32), new_indices.astype(np.uint32))


def orthonormal_tangents(tangents: F32, normals: F32) -> F32:
    """Given tangents float32[n, 4] made perpendicular to the unit normals and of unit length, w exactly -1 or 1.

    A tangent that is zero or parallel to the normal is replaced by some perpendicular one.
    """
    fixed = np.empty((len(tangents), 4), dtype=np.float32)
    fixed[:, :3] = _orthonormal(tangents[:, :3].astype(np.float64), normals.astype(np.float64))
    fixed[:, 3] = np.where(tangents[:, 3] < 0, -1.0, 1.0)
    return fixed


def any_tangents(normals: F32) -> F32:
    """Some unit tangent perpendicular to each unit normal, float32[n, 4], w = 1: for surfaces without uv or normal map.

    Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    """
    x, y, z = normals.T
    sign = np.where(z < 0, np.float32(-1), np.float32(1))
    a = -1 / (sign + z)
    tangents = np.empty((len(normals), 4), dtype=np.float32)
    tangents[:, 0] = 1 + sign * x * x * a
    tangents[:, 1] = sign * x * y * a
    tangents[:, 2] = -sign * x
    tangents[:, 3] = 1
    return tangents


# ---------------------------------------------------------------- steps


def _weld(positions: F32, normals: F32, uv: F32) -> tuple[npt.NDArray[np.int64], int]:
    """A number for each vertex, equal where position, normal and uv are; and how many numbers there are."""
    rows = np.ascontiguousarray(np.hstack([positions, normals, uv]) + np.float32(0))  # -0 becomes 0
    _, first, number = np.unique(_hash(rows.view(np.uint32)), return_index=True, return_inverse=True)
    if not np.array_equal(rows[first][number], rows):  # two different rows with one 64-bit hash
        _, number = np.unique(rows, axis=0, return_inverse=True)
    number = number.reshape(-1).astype(np.int64)
    return number, int(number.max()) + 1 if len(number) else 0


def _hash(rows: U32) -> npt.NDArray[np.uint64]:
    """A 64-bit hash of each row: multiply and shift, column by column. Unsigned arithmetic wraps by design."""
    mixed = np.zeros(len(rows), dtype=np.uint64)
    for column in rows.T:
        mixed = (mixed ^ column.astype(np.uint64)) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed


def _triangle_tangents(points: F64, uv: F64) -> tuple[F64, npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Of each triangle: unit dP/du, whether its uvs run clockwise (as stored), whether it has area in both spaces."""
    edge_1, edge_2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    step_1, step_2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = step_1[:, 0] * step_2[:, 1] - step_2[:, 0] * step_1[:, 1]
    along_u = _unit((edge_1 * step_2[:, 1:] - edge_2 * step_1[:, 1:]) * np.sign(area)[:, None])
    sound = (area != 0) & along_u.any(axis=1) & np.cross(edge_1, edge_2).any(axis=1)
    return along_u, area < 0, sound


def _corner_angles(points: F64, normals: F64) -> F64:
    """The angle of each corner between its edges projected into the plane of its normal, float64[t, 3], radians."""
    angles = np.empty(points.shape[:2])
    for corner in range(3):
        normal = normals[:, corner]
        ahead = _unit(_reject(points[:, (corner + 1) % 3] - points[:, corner], normal))
        behind = _unit(_reject(points[:, (corner + 2) % 3] - points[:, corner], normal))
        angles[:, corner] = np.arccos(np.clip((ahead * behind).sum(axis=1), -1.0, 1.0))
    return angles


def _orthonormal(vectors: F64, normals: F64) -> F64:
    """Unit vectors perpendicular to the normals; some perpendicular one where there is nothing to keep."""
    result = _unit(_reject(_unit(vectors), normals))
    result = _unit(_reject(result, normals))  # twice is enough: cancels the rounding of nearly parallel ones
    lost = ~result.any(axis=1) | (np.abs((result * normals).sum(axis=1)) > 1e-3)
    if lost.any():
        result[lost] = any_tangents(normals[lost].astype(np.float32))[:, :3]
    return result


def _reject(vectors: F64, normals: F64) -> F64:
    result: F64 = vectors - normals * (vectors * normals).sum(axis=-1, keepdims=True)
    return result


def _unit(vectors: F64) -> F64:
    """Rows scaled to length 1; zero rows stay zero."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    result: F64 = vectors / np.where(lengths > 1e-300, lengths, np.inf)
    return result
