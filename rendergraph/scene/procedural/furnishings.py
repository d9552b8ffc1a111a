"""What fills a courtyard: curtains, potted plants, lanterns, a fountain. Each has its own space and origin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rendergraph.scene.procedural.geometry import F64, Geometry, merge, surface
from rendergraph.scene.procedural.shapes import bar, disc, lathe, sphere
from rendergraph.scene.procedural.tessellation import even_segments, segments


def drape(rng: np.random.Generator, width: float, drop: float, tie: float | None, detail: float) -> Geometry:
    """A curtain hung from ``y = 0`` down to ``-drop`` along +x from the origin, facing +z, in soft folds.

    ``tie``: distance below the rail where it is gathered to x = 0; ``None`` hangs straight. v is 0 at the rail, 1 at
    the hem.
    """
    folds = max(3, round(width * 4.0))
    across, down = folds * segments(detail, 2, 11), segments(detail, 3, 28)
    s = np.linspace(0.0, 1.0, across + 1)[None, :]
    y = np.linspace(1.0, 0.0, down + 1)[:, None]  # rows run up: the hem first; y is the share of the drop
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    # Folds keep their place at the rail and wander a little on the way down.
    wander = 0.35 * y * np.sin(3.0 * np.pi * s + phase[0]) + 0.18 * y * np.sin(7.0 * s + 4.0 * y + phase[1])
    fold = 2.0 * np.pi * folds * s + wander * 2.0
    narrowing = np.ones_like(y)
    if tie is not None:
        t = y * drop / tie
        gathered, hem = 0.22, 0.62
        above = gathered + (1.0 - gathered) * (1.0 - np.clip(t, 0.0, 1.0) ** 2.2)
        below = gathered + (hem - gathered) * (1.0 - np.exp(-3.0 * np.clip(y * drop - tie, 0.0, None)))
        narrowing = np.where(t < 1.0, above, below)
    depth = (0.055 + 0.03 * y) * (1.0 + 0.5 * (1.0 - narrowing))
    sway = 0.03 * y**2 * np.sin(2.0 * np.pi * s + phase[2])
    x = width * narrowing * (s + 0.05 / folds * np.sin(2.0 * fold) / (2.0 * np.pi))
    z = depth * np.sin(fold) + sway
    points = np.stack([x, np.broadcast_to(-y * drop, x.shape), z], axis=-1)
    # The cloth is half as wide again as the opening; a texture width is 1.6 m.
    uv = np.stack([np.broadcast_to(s * width * 1.5 / 1.6, x.shape), np.broadcast_to(y, x.shape)], axis=-1)
    return surface(points, uv)


def tie_band(detail: float) -> Geometry:
    """The bronze clasp around a gathered curtain, about the origin."""
    t = np.linspace(0.0, 2.0 * np.pi, 2 * segments(detail, 2, 5) + 1)
    profile = np.stack([0.165 - 0.012 * np.cos(t), -0.03 * np.sin(t)], axis=1)
    return lathe([profile], even_segments(detail, 4, 24))


def curtain_rail(length: float, detail: float) -> Geometry:
    """A round rail along x, centred."""
    return bar((-length / 2.0, 0.0, 0.0), (length / 2.0, 0.0, 0.0), 0.022, segments(detail, 3, 14))


def pot(detail: float) -> Geometry:
    """A terracotta pot 0.62 m tall with a rolled rim."""
    outside = (
        [(0.0, 0.0), (0.21, 0.0)],
        [(0.21, 0.0), (0.25, 0.12), (0.30, 0.32), (0.32, 0.48)],
        [(0.32, 0.48), (0.35, 0.49), (0.375, 0.53), (0.37, 0.59), (0.34, 0.62)],
    )
    inside = [(0.34, 0.62), (0.30, 0.60), (0.28, 0.52)], [(0.28, 0.52), (0.0, 0.52)]
    return lathe(_refined([*outside, *inside], detail, 2), even_segments(detail, 6, 32))


def soil(detail: float) -> Geometry:
    """The earth in a pot, slightly heaped."""
    profile = [(0.285, 0.53), (0.18, 0.56), (0.0, 0.575)]
    return lathe([profile], even_segments(detail, 6, 20))


def palm(rng: np.random.Generator, detail: float) -> Geometry:
    """Arching fronds that rise from the middle of a pot."""
    count = segments(detail, 7, 26)
    blades = []
    for k in range(count):
        age = k / count
        length = rng.uniform(1.25, 1.65) * (1.0 - 0.25 * age)
        lean = 0.25 + 0.75 * age + rng.uniform(-0.08, 0.08)
        blades.append(_blade(rng, 2.399963 * k + rng.uniform(-0.2, 0.2), length, 0.46 * length**0.5, lean, 1.5, detail))
    return merge(blades).moved(0.0, 0.55, 0.0)


def shrub(rng: np.random.Generator, detail: float) -> Geometry:
    """Broad leaves on short stalks, densest at the top."""
    count = segments(detail, 12, 74)
    blades = []
    for k in range(count):
        height = 0.55 * (k / count) ** 0.8
        lean = rng.uniform(0.35, 1.1) + 0.3 * (1.0 - k / count)
        blade = _blade(
            rng, 2.399963 * k + rng.uniform(-0.3, 0.3), rng.uniform(0.30, 0.46), 0.2, lean, 1.1, detail * 0.4
        )
        angle = 2.399963 * k
        blades.append(blade.moved(0.05 * np.cos(angle), height, -0.05 * np.sin(angle)))
    return merge(blades).moved(0.0, 0.55, 0.0)


def _blade(
    rng: np.random.Generator, heading: float, length: float, width: float, lean: float, droop: float, detail: float
) -> Geometry:
    """A leaf: a strip that leaves the origin at ``lean`` radians from the vertical and bends down by ``droop`` more."""
    steps = segments(detail, 2, 9)
    t = np.linspace(0.0, 1.0, steps + 1)
    bend = lean + droop * t**1.6
    ds = length / steps
    out = np.concatenate([[0.0], np.cumsum(np.sin((bend[1:] + bend[:-1]) / 2.0) * ds)])
    up = np.concatenate([[0.0], np.cumsum(np.cos((bend[1:] + bend[:-1]) / 2.0) * ds)])
    forward = np.array([np.cos(heading), 0.0, -np.sin(heading)])
    side = np.array([np.sin(heading), 0.0, np.cos(heading)])
    twist = rng.uniform(-0.35, 0.35)
    spine = out[:, None] * forward + up[:, None] * np.array([0.0, 1.0, 0.0])
    normal = -np.cos(bend)[:, None] * forward + np.sin(bend)[:, None] * np.array([0.0, 1.0, 0.0])
    cross = np.cos(twist) * side + np.sin(twist) * normal
    # The halves of a leaf fold up along its rib.
    columns = np.array([-1.0, 0.0, 1.0])
    lift = np.abs(columns)[None, :, None] * normal[:, None, :] * 0.12
    points = spine[:, None, :] + (columns[None, :, None] * cross[:, None, :] + lift) * width / 2.0
    uv = np.stack(np.broadcast_arrays((columns[None, :] + 1.0) / 2.0, 1.0 - t[:, None]), axis=-1)
    return surface(points, np.ascontiguousarray(uv))


def lantern_frame(chain: float, detail: float) -> Geometry:
    """The bronze of a hanging lantern: chain, crown and foot around the glass at the origin."""
    around = even_segments(detail, 4, 24)
    crown = (
        [(0.0, 0.13), (0.13, 0.13)],
        [(0.13, 0.13), (0.15, 0.15), (0.12, 0.19)],
        [(0.12, 0.19), (0.05, 0.24), (0.015, 0.30), (0.0, 0.31)],
    )
    foot = (
        [(0.0, -0.22), (0.03, -0.20), (0.06, -0.155)],
        [(0.06, -0.155), (0.10, -0.15), (0.115, -0.12)],
        [(0.115, -0.12), (0.0, -0.12)],
    )
    posts = [
        bar(
            (0.115 * np.cos(a), -0.13, 0.115 * np.sin(a)),
            (0.125 * np.cos(a), 0.14, 0.125 * np.sin(a)),
            0.009,
            segments(detail, 3, 8),
        )
        for a in np.arange(6) * np.pi / 3.0
    ]
    hanger = bar((0.0, 0.29, 0.0), (0.0, chain, 0.0), 0.009, segments(detail, 3, 8))
    return merge(
        [
            lathe(_refined(crown, detail, 2), around),
            lathe(_refined(foot, detail, 2), around),
            hanger,
            *(posts if detail > 0.1 else []),
        ]
    )


def lantern_glass(detail: float) -> Geometry:
    """The glowing globe of a lantern."""
    around = even_segments(detail, 4, 24)
    return sphere(0.105, around, around // 2)


def fountain(detail: float) -> Geometry:
    """A stone fountain: a wide basin, a stem, a bowl."""
    around = even_segments(detail, 12, 72)
    basin = [
        [(1.62, 0.0), (1.62, 0.10)],
        [(1.62, 0.10), (1.52, 0.12), (1.46, 0.18), (1.46, 0.40), (1.50, 0.46)],
        [(1.50, 0.46), (1.60, 0.48), (1.64, 0.53), (1.60, 0.58)],
        [(1.60, 0.58), (1.34, 0.58)],
        [(1.34, 0.58), (1.32, 0.30), (1.25, 0.16)],
        [(1.25, 0.16), (0.0, 0.16)],
    ]
    stem = [
        [(0.34, 0.16), (0.34, 0.30), (0.26, 0.34)],
        [(0.26, 0.34), (0.15, 0.46), (0.13, 0.70), (0.19, 0.86), (0.13, 0.98), (0.15, 1.06)],
        [(0.15, 1.06), (0.40, 1.10), (0.66, 1.22), (0.74, 1.32)],
        [(0.74, 1.32), (0.76, 1.36), (0.71, 1.37)],
        [(0.71, 1.37), (0.58, 1.26), (0.30, 1.19), (0.10, 1.18)],
        [(0.10, 1.18), (0.08, 1.30), (0.10, 1.42), (0.05, 1.52), (0.0, 1.56)],
    ]
    return merge([lathe(_refined(basin, detail, 4), around), lathe(_refined(stem, detail, 4), around)])


def _refined(profile: Sequence[Sequence[tuple[float, float]]], detail: float, fine: int) -> list[F64]:
    """Smooth runs resampled through a Catmull-Rom spline; at the lowest detail, their ends alone."""
    cuts = segments(detail, 0, fine)
    runs = []
    for run in profile:
        p = np.asarray(run, float)
        if len(p) < 3 or cuts < 2:
            runs.append(p if cuts else p[[0, -1]])
            continue
        padded = np.concatenate([2.0 * p[:1] - p[1:2], p, 2.0 * p[-1:] - p[-2:-1]])
        t = np.linspace(0.0, len(p) - 1.0, (len(p) - 1) * cuts + 1)
        k = np.minimum(t.astype(int), len(p) - 2)
        f = (t - k)[:, None]
        a, b, c, d = (padded[k + offset] for offset in range(4))
        curve = 0.5 * (
            2.0 * b + (c - a) * f + (2.0 * a - 5.0 * b + 4.0 * c - d) * f**2 + (3.0 * b - a - 3.0 * c + d) * f**3
        )
        curve[:, 0] = np.maximum(curve[:, 0], 0.0)
        runs.append(curve)
    return runs


def fountain_water(detail: float) -> Geometry:
    """The two surfaces of the fountain's water."""
    around = even_segments(detail, 12, 48)
    return merge([disc(1.33, around, 2, 0.46), disc(0.66, around, 2, 1.31)])
