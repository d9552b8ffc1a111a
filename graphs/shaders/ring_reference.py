"""What ring.vert and ring.frag must draw: the cubes' faces, rasterised one by one in float64."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rendergraph.measure.truth.storage import step
from rendergraph.node.reference import PassRun, Truth

F64 = npt.NDArray[np.float64]

#: Where samples lie in a pixel (GL leaves it open; these are Direct3D's standard patterns, which renderers use, upright
#: or mirrored).
SAMPLES = {
    1: [(8, 8)],
    2: [(12, 12), (4, 4)],
    4: [(6, 2), (14, 6), (2, 10), (10, 14)],
    8: [(9, 5), (7, 11), (13, 9), (5, 3), (3, 13), (1, 7), (11, 15), (15, 1)],
}
NEAR = 0.1  # plane, in the shader's units
#: Pixels within which a sample may lie on either side of an edge: vertices are snapped to 256 places a pixel.
SNAP = 0.01
CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class Face(NamedTuple):
    """A face seen from the front: window positions float64[4, 2] and 1 / w float64[4] of its corners, its colour."""

    corners: F64
    nearness: F64
    color: F64


class Drawn(NamedTuple):
    """By pixel and sample: colour, 1 / w (0 where nothing is), and whether both are sure."""

    color: F64
    nearness: F64
    sure: npt.NDArray[np.bool_]


def judge(run: PassRun) -> Mapping[str, Truth]:
    """Means of the samples; a pixel with a sample on an edge is not judged. Depth, of which one sample is read back, is
    judged where one face covers the pixel.
    """
    desc = run.descs["color"]
    start = np.array(run.params.clear["color"])  # type: ignore[attr-defined]
    # A texture has at least as many samples as were asked for.
    patterns = [np.array(p, np.float64) / 16.0 for n, p in SAMPLES.items() if n in possible(desc.samples)]  # type: ignore[union-attr]
    drawn = [draw(run, placed, start) for p in patterns for placed in (p, p * [1, -1] + [0, 1])]
    judged = np.asarray(run.outputs["color"], np.float64)
    truths = [(one.color.mean(axis=2), one.sure.all(axis=2)) for one in drawn]
    errors = [np.abs(judged - value)[sure].sum() for value, sure in truths]
    fits = int(np.argmin(errors))
    value, sure = truths[fits]
    # Each sample is rounded, and their mean once more.
    rounded = 2 * 0.56 / 255 + 2e-5
    return {"color": Truth(value, mask=np.asarray(sure), tolerance=rounded), **_depth(run, drawn[fits])}


def possible(asked: int) -> tuple[int, ...]:
    """Numbers of samples that a request may be given: llvmpipe knows one and four."""
    return (1,) if asked == 1 else tuple({asked, max(asked, 4)})


def _depth(run: PassRun, drawn: Drawn) -> Mapping[str, Truth]:
    if "depth" not in run.outputs:
        return {}
    near = NEAR * drawn.nearness
    depth = near if run.frame.depth == "reversed" else 1.0 - near
    spread = np.ptp(depth, axis=2)
    within = drawn.sure.all(axis=2) & (np.ptp(drawn.color, axis=2).max(axis=-1) == 0.0)
    tolerance = float(spread[within].max(initial=0.0)) + _depth_step(run) + 1e-6
    return {"depth": Truth(depth.mean(axis=2)[..., None], mask=within, tolerance=tolerance)}


def draw(run: PassRun, places: F64, start: F64) -> Drawn:
    """Every face over what is there, by the nearest; ``places`` float64[samples, 2] within a pixel."""
    height, width = run.outputs["color"].shape[:2]
    shape = (height, width, len(places))
    color = np.broadcast_to(start, (*shape, 4)).copy()
    nearest, second, doubtful = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for face in faces(run, width, height):
        low = np.clip(np.floor(face.corners.min(axis=0) - 1).astype(int), 0, (width, height))
        high = np.clip(np.ceil(face.corners.max(axis=0) + 1).astype(int), 0, (width, height))
        if (high <= low).any():
            continue
        here = np.s_[low[1] : high[1], low[0] : high[0]]
        x = np.arange(low[0], high[0])[None, :, None] + places[:, 0]
        y = np.arange(low[1], high[1])[:, None, None] + places[:, 1]
        inside = _distance(face.corners, x, y)
        plane = np.linalg.solve(np.column_stack([face.corners[:3], np.ones(3)]), face.nearness[:3])
        nearness = plane[0] * x + plane[1] * y + plane[2]
        wins = (inside >= 0.0) & (nearness > nearest[here])
        loses = (inside >= 0.0) & ~wins
        second[here] = np.where(wins, nearest[here], np.where(loses, np.maximum(second[here], nearness), second[here]))
        nearest[here] = np.where(wins, nearness, nearest[here])
        color[here] = np.where(wins[..., None], face.color, color[here])
        doubtful[here] = np.maximum(doubtful[here], np.where(np.abs(inside) < SNAP, nearness, 0.0))
    below = nearest * (1 - 1e-5) - _depth_step(run) / NEAR
    sure = ((doubtful < below) | (doubtful == 0.0)) & ((second < below) | (second == 0.0))
    return Drawn(color, nearest, sure)


def _depth_step(run: PassRun) -> float:
    """Depths within it may come out equal: two codes of a whole-number format."""
    format = run.descs["depth"].format if "depth" in run.descs else "d32f"  # type: ignore[union-attr]
    return 2.0 * float(step(format)[0])


def _distance(corners: F64, x: F64, y: F64) -> F64:
    """Pixels from the nearest edge's line of a convex outline, negative outside."""
    far = np.full(np.broadcast(x, y).shape, np.inf)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = b - a
        far = np.minimum(far, (along[0] * (y - a[1]) - along[1] * (x - a[0])) / np.hypot(*along))
    return far


def faces(run: PassRun, width: int, height: int) -> Iterator[Face]:
    """Front faces in the order of instances and faces."""
    params = run.params
    uniforms, count = params.uniforms, params.uniforms["u_count"]  # type: ignore[attr-defined]
    focal, aspect = 1.9, run.frame.width / run.frame.height
    for instance in range(params.instances):  # type: ignore[attr-defined]
        place = instance / count
        angle = 2.0 * np.pi * (place + uniforms["u_turn"] * run.index)
        turn = rotate_y(angle) @ rotate_x(3.0 * angle)
        middle = 2.0 * np.array([np.sin(angle), 0.0, np.cos(angle)])
        for axis in range(3):
            for side in (1.0, -1.0):
                normal = side * np.eye(3)[axis]
                view = (cube_face(axis, side) * 0.16 @ turn.T + middle) @ rotate_x(0.45).T - [0.0, 0.0, 4.2]
                w = -view[:, 2]
                ndc = view[:, :2] * [focal / aspect, focal] / w[:, None]
                window = (ndc + 1.0) / 2.0 * [width, height]
                first, last = window[1] - window[0], window[3] - window[0]
                if first[0] * last[1] - first[1] * last[0] > 0.0:
                    yield Face(window, 1.0 / w, shade(turn @ normal, place))


def cube_face(axis: int, side: float) -> F64:
    """Corners of a face, counter-clockwise seen from outside, float64[4, 3]."""
    mirrored = CORNERS * [side, 1.0]
    ahead = np.full((4, 1), side)
    if axis == 0:
        return np.concatenate([ahead, mirrored], axis=1)
    if axis == 1:
        return np.concatenate([mirrored[:, 1:], ahead, mirrored[:, :1]], axis=1)
    return np.concatenate([mirrored, ahead], axis=1)


def shade(normal: F64, place: float) -> F64:
    """Encoded rgba of a face."""
    albedo = 0.55 + 0.45 * np.cos(2.0 * np.pi * (place + np.array([0.0, 0.33, 0.67])))
    towards = np.array([0.4, 0.8, 0.45]) / np.linalg.norm([0.4, 0.8, 0.45])
    up = 0.5 + 0.5 * normal[1]
    light = (1.0 - up) * np.array([0.10, 0.09, 0.08]) + up * np.array([0.22, 0.26, 0.34])
    light = light + np.array([0.85, 0.8, 0.7]) * max(float(normal @ towards), 0.0)
    return np.append((albedo * light) ** (1.0 / 2.2), 1.0)


def rotate_y(a: float) -> F64:
    """Around y, counter-clockwise seen from above."""
    c, s = np.cos(a), np.sin(a)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rotate_x(a: float) -> F64:
    """Around x."""
    c, s = np.cos(a), np.sin(a)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
