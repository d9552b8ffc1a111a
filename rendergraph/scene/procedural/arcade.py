"""Stone parts of an arcade: columns, arches of voussoirs, vaults, ribs. Each stands at the origin of its own space.

One bay is ``BAY`` wide. Arches spring at ``y = 0`` of their own space and face +z and -z.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.geometry import F64, Geometry, merge, surface, unit
from rendergraph.scene.procedural.shapes import lathe
from rendergraph.scene.procedural.tessellation import even_segments, segments

BAY = 3.0
ARCH_RADIUS = 1.2
RING = 0.26  # depth of the voussoirs
THICKNESS = 0.5  # of the wall above the arches
_FLUTES = 20


def column(height: float, radius: float, detail: float, *, fluted: bool) -> Geometry:
    """A column of the given total height: plinth, Attic base, tapering shaft, leaved capital, abacus."""
    r, wide = radius, radius * 2.9
    top = height
    base = [
        _bulge(r * 1.36, r * 1.36, 0.14, 0.25, 0.055, detail),
        _hollow(r * 1.26, r * 1.16, 0.25, 0.31, detail),
        _bulge(r * 1.18, r * 1.12, 0.31, 0.37, 0.03, detail),
        [(r * 1.06, 0.37), (r * 1.06, 0.40)],
        [(r * 0.9, 0.40)],  # inside the shaft
    ]
    neck, bell_top, abacus = top - 0.52, top - 0.14, 0.14
    collar = [
        [(r * 0.8, neck - 0.02)],  # inside the shaft
        _bulge(r * 0.86, r * 0.86, neck - 0.02, neck + 0.03, 0.025, detail),
        [(r * 0.8, neck + 0.03)],  # inside the bell
    ]
    around = even_segments(detail, 6, 36)
    solid = [
        block((wide, 0.14, wide), (0.0, 0.07, 0.0), 0.012 if detail > 0.15 else 0.0),
        lathe(_joined(base), around),
        _shaft(r, 0.40, neck, detail, fluted),
        lathe(_joined(collar), around),
        _capital(r * 0.84, neck + 0.02, bell_top, detail),
        block((wide, abacus, wide), (0.0, top - abacus / 2.0, 0.0), 0.02 if detail > 0.15 else 0.0),
    ]
    return merge(solid)


def _joined(runs: list[list[tuple[float, float]]]) -> list[list[tuple[float, float]]]:
    """The runs of two points or more, with a straight run wherever one ends elsewhere than the next starts."""
    joined = []
    for k, run in enumerate(runs):
        if k > 0 and runs[k - 1][-1] != run[0]:
            joined.append([runs[k - 1][-1], run[0]])
        if len(run) > 1:
            joined.append(run)
    return joined


def _bulge(low: float, high: float, y0: float, y1: float, out: float, detail: float) -> list[tuple[float, float]]:
    """A torus moulding's half round profile."""
    t = np.linspace(0.0, 1.0, segments(detail, 2, 7))
    r = low + (high - low) * t + out * np.sin(np.pi * t)
    y = (y0 + y1) / 2.0 - (y1 - y0) / 2.0 * np.cos(np.pi * t)
    return list(zip(r.tolist(), y.tolist(), strict=True))


def _hollow(low: float, high: float, y0: float, y1: float, detail: float) -> list[tuple[float, float]]:
    """A scotia: a concave quarter between two radii."""
    t = np.linspace(0.0, 1.0, segments(detail, 2, 6))
    r = low + (high - low) * t - 0.12 * low * np.sin(np.pi * t)
    return list(zip(r.tolist(), (y0 + (y1 - y0) * t).tolist(), strict=True))


def _shaft(radius: float, y0: float, y1: float, detail: float, fluted: bool) -> Geometry:
    """A shaft with entasis; flutes run out near both ends, where the grid can show them."""
    around = even_segments(detail, 6, 32)
    per_flute = segments(detail, 0, 5)
    if not fluted or per_flute < 3:
        return lathe([_tapering(radius, y0, y1, np.linspace(0.0, 1.0, segments(detail, 2, 11)))], around)
    ends = np.array([0.0, 0.03, 0.06])
    t = np.unique(np.concatenate([ends, 1.0 - ends, np.linspace(0.06, 0.94, segments(detail, 2, 6))]))

    def flutes(angle: F64, y: F64) -> F64:
        place = angle * _FLUTES / (2.0 * np.pi) % 1.0
        scoop = np.sqrt(np.maximum(0.0, 1.0 - (2.2 * (place - 0.5)) ** 2))
        depth = np.clip((np.minimum(y - y0, y1 - y) / (y1 - y0) - 0.02) / 0.035, 0.0, 1.0)
        return 1.0 - 0.085 * scoop * depth

    return lathe([_tapering(radius, y0, y1, t)], per_flute * _FLUTES, flutes)


def _tapering(radius: float, y0: float, y1: float, t: F64) -> F64:
    """The profile of a shaft at shares ``t`` of its height: float64[k, 2]."""
    return np.stack([radius * (1.0 - 0.16 * t**1.8), y0 + (y1 - y0) * t], axis=1)


def _capital(radius: float, y0: float, y1: float, detail: float) -> Geometry:
    """A bell with two tiers of eight leaves that curl outwards."""
    around, rows = even_segments(detail, 6, 64), segments(detail, 1, 13)
    t = np.linspace(0.0, 1.0, rows + 1)
    bell = radius * (1.0 + 0.62 * t**2.2)
    profile = np.stack([bell, y0 + (y1 - y0) * t], axis=1)
    # The bell is wider than the bevelled underside of the abacus: a flat rim closes the gap.
    runs = [profile, np.array([[bell[-1], y1], [bell[-1] * 0.7, y1]])]
    if around < 32:
        return lathe(runs, around)

    def leaves(angle: F64, y: F64) -> F64:
        t = (y - y0) / (y1 - y0)
        lower = np.abs(np.cos(4.0 * angle)) ** 0.8 * _curl(t, 0.05, 0.50)
        upper = np.abs(np.sin(4.0 * angle)) ** 0.8 * _curl(t, 0.35, 0.93)
        return 1.0 + 0.27 * lower + 0.30 * upper

    return lathe(runs, around, leaves)


def _curl(t: F64, start: float, end: float) -> F64:
    """Rises slowly from ``start`` and drops just before ``end``: the overhang of a leaf's tip."""
    s = np.clip((t - start) / (end - start), 0.0, 1.0)
    return np.asarray(s**1.5 * np.sqrt(np.clip((1.0 - s) / 0.15, 0.0, 1.0)))


def arch_ring(detail: float) -> Geometry:
    """Voussoirs with chamfered joints around a semicircle, and a keystone that stands proud."""
    count = even_segments(detail, 4, 14) + 1
    step = np.pi / count
    bevel = 0.014 if detail > 0.15 else 0.0
    stones = []
    for k in range(count):
        key = k == count // 2
        inner, outer = ARCH_RADIUS - (0.05 if key else 0.0), ARCH_RADIUS + RING + (0.10 if key else 0.0)
        stone = block((step * ARCH_RADIUS, outer - inner, THICKNESS + (0.16 if key else 0.06)), bevel=bevel)
        if bevel == 0.0 and not key:
            stone = _without_joints(stone)
        # A stone's own piece of the texture: neighbours are not cut from one slab.
        stones.append(_bent(stone, np.pi - (k + 0.5) * step, (inner + outer) / 2.0).mapped(offset=(0.37 * k, 0.61 * k)))
    return merge(stones)


def _without_joints(stone: Geometry) -> Geometry:
    """A block without its faces along x, which touch the neighbours'."""
    triangles = stone.indices.reshape(-1, 3)
    keep = np.abs(stone.normals[triangles[:, 0], 0]) < 0.5
    return replace(stone, indices=triangles[keep].ravel())


def _bent(stone: Geometry, angle: float, radius: float) -> Geometry:
    """A block wrapped around the arch: x becomes falling angle, y radius, so that it keeps its handedness."""
    turn = angle - stone.positions[:, 0] / ARCH_RADIUS
    c, s = np.cos(turn), np.sin(turn)
    reach = radius + stone.positions[:, 1]

    def turned(v: F64) -> F64:
        return np.stack([v[:, 0] * s + v[:, 1] * c, v[:, 1] * s - v[:, 0] * c, v[:, 2]], axis=1)

    return replace(
        stone,
        positions=np.stack([reach * c, reach * s, stone.positions[:, 2]], axis=1),
        normals=turned(stone.normals),
        tangents=np.column_stack([turned(stone.tangents[:, :3]), stone.tangents[:, 3]]),
    )


def spandrels(top: float, detail: float) -> Geometry:
    """Both faces of the wall between the arch ring and a straight cornice ``top`` above the springing."""
    half, inner = BAY / 2.0, ARCH_RADIUS + RING - 0.02
    corner = float(np.arctan2(top, half))
    n = segments(detail, 2, 9)
    angle = np.unique(np.concatenate([np.linspace(0.0, corner, n), np.linspace(corner, np.pi / 2.0, n)]))
    angle = np.concatenate([angle, np.pi - angle[-2::-1]])
    c, s = np.cos(angle), np.sin(angle)
    with np.errstate(divide="ignore"):
        reach = np.minimum(half / np.abs(c), top / np.maximum(s, 1e-12))
    points = np.zeros((2, len(angle), 3))
    points[0, :, 0], points[0, :, 1] = inner * c, inner * s
    points[1, :, 0], points[1, :, 1] = reach * c, reach * s
    points = points[:, ::-1]  # left to right: columns right, rows up, so the front faces +z
    points[..., 2] = THICKNESS / 2.0
    front = surface(
        points,
        np.stack([points[..., 0], -points[..., 1]], axis=-1),
        normals=np.broadcast_to([0.0, 0.0, 1.0], points.shape).copy(),
    )
    turned = np.diag([-1.0, 1.0, -1.0, 1.0])
    return merge([front, front.placed(turned)])


def rib(detail: float) -> Geometry:
    """A plain arched band that carries a vault: its underside and two flanks; spans along z, from spring to spring."""
    n = even_segments(detail, 4, 24)
    angle = np.linspace(0.0, np.pi, n + 1)
    out = np.stack([np.zeros_like(angle), np.sin(angle), np.cos(angle)], axis=-1)
    half, inner, outer = 0.19, ARCH_RADIUS, BAY / 2.0 + 0.02
    x = np.array([half, 0.0, 0.0])
    arc = angle * ARCH_RADIUS

    def band(first: F64, second: F64, normal: F64, v: float) -> Geometry:
        points = np.stack([first, second])
        uv = np.stack([np.stack([arc, np.zeros_like(arc)], axis=-1), np.stack([arc, np.full_like(arc, v)], axis=-1)])
        return surface(points, uv, normals=np.broadcast_to(normal, points.shape).copy())

    under = band(out * inner - x, out * inner + x, -out, 2.0 * half)
    left = band(out * outer - x, out * inner - x, -x / half, outer - inner)
    right = band(out * inner + x, out * outer + x, x / half, outer - inner)
    return merge([under, left, right])


def vault(rise: float, detail: float) -> Geometry:
    """The underside of a groin vault over one bay: two crossing tunnels, four webs, springing at ``y = 0``."""
    around, rows = even_segments(detail, 4, 20), segments(detail, 1, 8)
    half = BAY / 2.0
    theta = np.linspace(-np.pi / 2.0, np.pi / 2.0, around + 1)
    spread = np.sin(np.linspace(0.0, np.pi / 2.0, rows + 1))[:, None]
    # In one web the tunnel runs along x: height depends on q = z / half alone, |q| <= p = x / half.
    q = spread * np.sin(theta)[None, :]
    height = np.sqrt(np.maximum(0.0, 1.0 - q * q))
    p = np.broadcast_to(spread, q.shape)
    points = np.stack([p * half, height * rise, -q * half], axis=-1)
    normals = unit(np.stack([np.zeros_like(q), -height / rise, q / half], axis=-1))
    arc = np.arcsin(np.clip(q, -1.0, 1.0)) * half
    web = surface(points, np.stack([arc, -p * half], axis=-1), normals=normals)
    webs = []
    for turn in range(4):
        cos, sin = [1.0, 0.0, -1.0, 0.0][turn], [0.0, 1.0, 0.0, -1.0][turn]
        matrix = np.eye(4)
        matrix[0, 0], matrix[0, 2], matrix[2, 0], matrix[2, 2] = cos, sin, -sin, cos
        webs.append(web.placed(matrix))
    return merge(webs)
