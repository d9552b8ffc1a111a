"""Whether opaque triangles fill a view without a hole: proven, or not claimed.

Take a connected piece of surface in front of the near plane. Where every edge inside the view is shared by two
triangles that run along it in opposite directions, the number of front faces less that of back faces over a pixel is
the same for all pixels: what one triangle stops covering at an edge, its neighbour begins to (GL's rule for shared
edges, with equal vertex positions and `invariant gl_Position`). So one count near the middle speaks for all of it.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
import numpy.typing as npt

from rendergraph.scene.cameras import projection_matrix, view_matrix
from rendergraph.scene.scene import F64, Alpha, Camera, Scene

I64 = npt.NDArray[np.int64]

#: Triangles beyond which nothing is claimed: planning must stay quick.
MOST_TRIANGLES = 20_000
#: How far beyond the view an edge must lie, as a factor of the view.
_BEYOND = 1.02
#: Least distance from the far plane in reversed depth: a 16-bit depth must tell it from the far plane.
_LEAST_DEPTH = 1e-4


def covers_view(scene: Scene, camera: Camera, aspect: float) -> bool:
    """Whether some connected piece of opaque surface is certain to cover every pixel; ``aspect``: width over height."""
    pieces: dict[bytes, list[int]] = defaultdict(list)  # instances of one transform: their vertices coincide exactly
    total = 0
    for index, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if scene.materials[mesh.material].alpha is Alpha.OPAQUE and instance.skin is None:
            pieces[instance.world.tobytes()].append(index)
            total += mesh.index_count // 3
    if total > MOST_TRIANGLES:
        return False
    matrix = projection_matrix(camera, aspect) @ view_matrix(camera)
    return any(_group_covers(scene, instances, matrix, camera) for instances in pieces.values())


def _group_covers(scene: Scene, instances: list[int], matrix: F64, camera: Camera) -> bool:
    world = scene.instances[instances[0]].world
    points, triangles, sided = _welded(scene, instances)
    if len(triangles) == 0:
        return False
    if np.linalg.det(world[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ (matrix @ world).T
    depth = clip[:, 3]
    usable = (depth > camera.near * _BEYOND) & (clip[:, 2] > _LEAST_DEPTH * depth)
    if camera.far is not None:
        usable &= depth * _BEYOND < camera.far
    inside = usable[triangles].all(axis=1)
    triangles, sided = triangles[inside], sided[inside]
    if len(triangles) == 0:
        return False
    labels = _pieces(triangles, len(points))[triangles[:, 0]]
    broken = _open_edges(triangles, clip)
    opened = set(np.unique(labels[broken]).tolist())
    middle = clip[:, :2] / np.where(usable, depth, 1.0)[:, None]
    count = _crossings(middle[triangles])
    for label in np.unique(labels[count != 0]).tolist():
        if label not in opened:
            mine = labels == label
            fronts = int(count[mine].sum())
            # Back faces alone cover only where both sides are drawn.
            if fronts > 0 or (fronts < 0 and bool(sided[mine].all())):
                return True
    return False


def _welded(scene: Scene, instances: list[int]) -> tuple[F64, I64, npt.NDArray[np.bool_]]:
    """Points float64[p, 3], triangles int64[t, 3] without degenerate ones, and which are double-sided."""
    corners, sided = [], []
    for index in instances:
        mesh = scene.meshes[scene.instances[index].mesh]
        at = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].astype(np.int64) + mesh.base_vertex
        corners.append(scene.positions[at])
        sided.append(np.full(len(at) // 3, scene.materials[mesh.material].double_sided))
    stacked = np.ascontiguousarray(np.concatenate(corners) + np.float32(0.0))  # -0 is 0
    _, first, inverse = np.unique(stacked.view(np.dtype((np.void, 12))).ravel(), return_index=True, return_inverse=True)
    triangles = inverse.reshape(-1, 3).astype(np.int64)
    kept = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return stacked[first].astype(np.float64), triangles[kept], np.concatenate(sided)[kept]


def _pieces(triangles: I64, points: int) -> I64:
    """A label for each point, int64[points]: equal for points that triangles connect."""
    label = np.arange(points)
    while True:
        least = label[triangles].min(axis=1)
        before = label.copy()
        for corner in range(3):
            np.minimum.at(label, triangles[:, corner], least)
        label = label[label]
        if (label == before).all():
            return label


def _open_edges(triangles: I64, clip: F64) -> npt.NDArray[np.bool_]:
    """Triangles with an edge in or near the view that no other runs along the opposite way, bool[t]."""
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    size = int(triangles.max()) + 1
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, place = np.unique(low * size + high, return_inverse=True)
    balance = np.zeros(int(place.max()) + 1, dtype=np.int64)
    np.add.at(balance, place, np.where(edges[:, 0] == low, 1, -1))
    single = balance[place] != 0
    ends = clip[edges]  # [e, 2, 4]
    x, y, w = ends[..., 0], ends[..., 1], ends[..., 3] * _BEYOND
    beyond = np.stack([x > w, -x > w, y > w, -y > w]).all(axis=2).any(axis=0)
    broken: npt.NDArray[np.bool_] = (single & ~beyond).reshape(-1, 3).any(axis=1)
    return broken


#: Where crossings are counted: near the middle, at no likely vertex or edge.
_PROBE = np.array([math.sqrt(2) - 1.4, math.sqrt(3) - 1.74])


def _crossings(corners: F64) -> I64:
    """+1 for triangles that show their front over the probe, -1 for their back, 0 for the rest; float64[t, 3, 2] in."""
    a, b, c = (corners[:, k] - _PROBE for k in range(3))

    def cross(p: F64, q: F64) -> F64:
        turned: F64 = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        return turned

    turns = np.stack([cross(a, b), cross(b, c), cross(c, a)])
    fronts, backs = (turns > 0).all(axis=0), (turns < 0).all(axis=0)
    signs: I64 = np.where(fronts, 1, np.where(backs, -1, 0)).astype(np.int64)
    return signs
