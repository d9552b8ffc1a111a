"""The truth of shadows: depths and visibility by rays; cascades, splits and frustum slices in float64 numpy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rendergraph.node.reference import PassRun, Truth
from rendergraph.nodes.shadow_map.light_view import LightView
from rendergraph.nodes.shadow_map.lookup import ARITHMETIC, Cascades, look_up
from rendergraph.plan.graph import TextureDesc

if TYPE_CHECKING:
    from rendergraph.measure.truth.rays import Rays
    from rendergraph.measure.truth.surfaces import Surfaces

F64 = npt.NDArray[np.float64]


def world_triangles(scene: Any) -> F64:
    """Triangles of a ``rendergraph.scene.scene.Scene`` in world space, ``float64[triangles, 3, 3]``."""
    parts = []
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        indices = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count].astype(np.int64)
        corners = scene.positions[indices + mesh.base_vertex].astype(np.float64)
        parts.append((corners @ instance.world[:3, :3].T + instance.world[:3, 3]).reshape(-1, 3, 3))
    return np.concatenate(parts)


def visible(triangles: F64, points: F64, towards: F64, offset: float = 1e-4) -> npt.NDArray[np.bool_]:
    """Whether each point (``float64[k, 3]``, metres) sees light from direction ``towards`` (``float64[3]``, unit).

    Moeller and Trumbore 1997, both sides of a triangle blocking; hits closer than ``offset`` metres do not count.
    """
    a, edge_1, edge_2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(towards, edge_2)
    determinant = np.sum(edge_1 * p, axis=1)
    usable = np.abs(determinant) > 1e-14
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=usable)
    lit = np.ones(len(points), dtype=bool)
    for row, point in enumerate(points):
        s = point - a
        u = np.sum(s * p, axis=1) * inverse
        q = np.cross(s, edge_1)
        v = (q @ towards) * inverse
        t = np.sum(edge_2 * q, axis=1) * inverse
        lit[row] = not np.any(usable & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > offset))
    return lit


def splits(near: float, far: float, count: int, blend: float) -> F64:
    """View depths, metres, at which the cascades end: uniform (``blend`` 0) to logarithmic (1), ``float64[count]``."""
    fraction = np.arange(1, count + 1) / count
    uniform = near + (far - near) * fraction
    logarithmic = near * (far / near) ** fraction
    return uniform * (1.0 - blend) + logarithmic * blend


def slice_corners(inverse_view_projection: F64, view: F64, near: float, far: float) -> F64:
    """The eight world-space corners of the view frustum between two view depths, ``float64[8, 3]``."""
    corners = []
    eye = np.linalg.inv(view)[:3, 3]
    forward = -view[2, :3]
    for x in (-1.0, 1.0):
        for y in (-1.0, 1.0):
            clip = inverse_view_projection @ np.array([x, y, 0.5, 1.0])
            ray = clip[:3] / clip[3] - eye
            ray /= ray @ forward
            corners += [eye + ray * near, eye + ray * far]
    return np.array(corners)


# ---------------------------------------------------------------- judging

Bools = npt.NDArray[np.bool_]
#: Texels judged a side of each layer, spread evenly: rays for all of them would take minutes.
SIDE = 64
#: Texels off a centre, as far as the same caster must be seen, and the steepest one whose depth a texel tells.
_AROUND, _STEEP = 1.0 / 16.0, 0.01
#: Largest error of a stored depth: a rasteriser's vertices on a grid of 1/256 texel, and slopes in float32.
MAP_ERROR = 2e-6
#: Taps a side of the filter that visibility is judged with: shadow_taps of the lighting nodes.
TAPS = 3


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The map against rays along the light, and what it makes of the surfaces that the camera sees against rays to the
    sun. Nothing is known where the sun is missing.
    """
    assert run.trace is not None
    assert run.scene is not None
    seen: Surfaces = run.trace()
    cascades = Cascades.of(np.asarray(run.outputs["cascades"], dtype=np.uint32))
    if run.scene.sun is None or cascades.count == 0:
        nothing = Truth(np.zeros((1, 1, 1)), np.zeros((1, 1, 1)), mask=np.zeros((1, 1), dtype=bool))
        return {"map": nothing, "visibility": nothing}
    towards = -np.array(run.scene.sun.direction, dtype=np.float64)
    towards /= np.linalg.norm(towards)
    return {
        "map": _map_truth(run, seen.rays, cascades, towards),
        "visibility": _visibility_truth(run, seen, cascades, towards),
    }


def invariants(run: PassRun) -> Iterable[str]:
    """Cascades end one behind the other, and the map holds depths."""
    cascades = Cascades.of(np.asarray(run.outputs["cascades"], dtype=np.uint32))
    if not (np.diff(cascades.far[: cascades.count]) > 0.0).all():
        yield "a cascade does not end behind the one before it"
    if not np.isfinite(cascades.to_clip).all():
        yield "a cascade's matrix holds a value that is no number"
    layers = run.outputs["map"]
    if not (np.isfinite(layers).all() and layers.min() >= 0.0 and layers.max() <= 1.0):
        yield "the map holds a depth outside 0..1"


def map_layers(content: npt.NDArray[Any]) -> F64:
    """A shadow map as ``PassRun`` shows it, float64[h, w, 1] or [layers, h, w, 1], as float64[layers, h, w]."""
    layers = content.astype(np.float64)[..., 0]
    return layers if layers.ndim == 3 else layers[None]


def sun_visible(rays: Rays, points: F64, normals: F64, towards: F64) -> Bools:
    """Whether points on surfaces with unit geometric normals float64[n, 3] see the sun: nothing solid, front or back,
    in between; alpha-tested surfaces let light through their holes.
    """
    directions = np.broadcast_to(towards, points.shape)
    return ~rays.occluded(rays.leave(points, normals, directions), directions)


def _visibility_truth(run: PassRun, seen: Surfaces, cascades: Cascades, towards: F64) -> Truth:
    shading, geometric = seen.image(seen.shading.normal), seen.geometric_normal
    # Where a facet faces away and its interpolated normal does not, the mesh is at fault, whatever shadows it has.
    facing = seen.hit & (shading @ towards > 0.0) & (geometric @ towards > 0.0)
    points = seen.position[facing]
    reversed = run.frame.depth == "reversed"
    layers = map_layers(run.outputs["map"])
    found = look_up(layers, cascades, points, shading[facing], seen.view_depth[facing], towards, TAPS, reversed)
    lit = sun_visible(seen.rays, points, geometric[facing], towards)
    value, judged, mask = np.zeros(seen.hit.shape), np.zeros(seen.hit.shape), np.zeros(seen.hit.shape, dtype=bool)
    value[facing], judged[facing], mask[facing] = lit, found.lit, ~found.faded
    return Truth(value[..., None], judged[..., None], mask=mask)


def _map_truth(run: PassRun, rays: Rays, cascades: Cascades, towards: F64) -> Truth:
    layers, reversed = map_layers(run.outputs["map"]), run.frame.depth == "reversed"
    size = layers.shape[-1]
    at = ((np.arange(min(SIDE, size)) + 0.5) * size / min(SIDE, size)).astype(np.int64)
    row, column = (x.ravel() for x in np.meshgrid(at, at, indexing="ij"))
    slope_bias = float(getattr(run.params, "slope_bias", 0.0))
    values, known = [], []
    for layer in range(cascades.count):
        light = LightView(rays, cascades.to_clip[layer], towards, size, slope_bias, reversed)
        depth, slope, sure = light.trace(column + 0.5, row + 0.5)
        for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            # Where a caster ends, or meets another, a rasteriser may see it elsewhere.
            near, _, still = light.trace(column + 0.5 + x * _AROUND, row + 0.5 + y * _AROUND)
            sure &= still & (np.abs(near - depth) <= 2.0 * _AROUND * slope + ARITHMETIC)
        values.append(depth)
        known.append(sure & (slope < _STEEP))
    shape = (cascades.count * len(at), len(at))
    judged = layers[: cascades.count, row, column]
    quantum = {"d16": 2.0**-16, "d24": 2.0**-24}.get(_format(run), 0.0)
    return Truth(
        np.concatenate(values).reshape(*shape, 1), judged.reshape(*shape, 1), mask=np.concatenate(known).reshape(shape),
        tolerance=quantum + MAP_ERROR,
    )  # fmt: skip


def _format(run: PassRun) -> str:
    desc = run.descs["map"]
    assert isinstance(desc, TextureDesc)
    return desc.format
