"""The truth of a lit G-buffer: its own texels through the textbook's light model in float64, and the sun by rays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS
from rendergraph.node.reference import PassRun, Truth
from rendergraph.nodes.deferred_lighting.textbook import MAX_RADIANCE, shade
from rendergraph.nodes.gbuffer.reference import unpack_normals, view_z
from rendergraph.nodes.shadow_map.lookup import Cascades, look_up
from rendergraph.nodes.shadow_map.reference import map_layers, sun_visible
from rendergraph.plan.graph import TextureDesc
from rendergraph.scene.scene import Scene

if TYPE_CHECKING:
    from rendergraph.measure.truth.surfaces import Surfaces

F64 = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

#: Relative MSE that a target's rounding (or truncation) leaves, and float32 shading.
_TARGET_ERROR = {"r11g11b10f": 1e-3, "rgba16f": 1e-6, "rgba32f": 1e-8}
#: The same of sRGB texels, which a renderer may decode by an approximation (llvmpipe: off by up to 0.0012), and of the
#: eight bits with which texture units may weigh the taps of a shadow's filter.
_SRGB_ERROR, _SHADOW_ERROR = 1e-5, 1e-6


@dataclass(frozen=True, slots=True)
class Points:
    """Surface points to light, world space: float64[n, 3] position, unit normal, base colour, emission; float64[n]
    roughness, metallic, occlusion; bool[n] unlit.
    """

    position: F64
    normal: F64
    base_color: F64
    roughness: F64
    metallic: F64
    occlusion: F64
    emissive: F64
    unlit: Bools


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The image against the float64 light model at the G-buffer's own points: once with the shadow map that the pass
    reads, once with the sun traced. Nothing is known of the second without a map: the sun casts no shadow then.
    """
    assert run.trace is not None
    seen: Surfaces = run.trace()
    points, drawn = stored_points(run, seen)
    view_depth = -(points.position @ seen.view.view[2, :3] + seen.view.view[2, 3])
    sun, sure = mapped_sun(run, points.position, points.normal, view_depth)
    color = radiance(run, points, sun)
    base_color = run.descs["base_color"]
    assert isinstance(base_color, TextureDesc)
    tolerance = color_tolerance(run, srgb=FORMATS[base_color.format].srgb)
    return {
        "color": image_truth(run, drawn, color, sure, tolerance),
        "traced": _traced(run, seen, points, drawn, view_depth),
    }


def invariants(run: PassRun) -> Iterable[str]:
    """Nothing is negative, infinite or no number, and where nothing was drawn no light comes from."""
    yield from finite_light(run)
    far = 0.0 if run.frame.depth == "reversed" else 1.0
    if run.outputs["color"][run.inputs["depth"][..., 0] == far][..., :3].any():
        yield "light comes from where there is no surface"


def finite_light(run: PassRun) -> Iterable[str]:
    """What must hold of radiance, whatever lit it."""
    color = run.outputs["color"][..., :3]
    if not np.isfinite(color).all():
        yield "a radiance is infinite or no number"
    elif color.min() < 0.0:
        yield "a radiance is negative"
    elif color.max() > MAX_RADIANCE:
        yield f"a radiance is above {MAX_RADIANCE:g}"


def stored_points(run: PassRun, seen: Surfaces) -> tuple[Points, Bools]:
    """The surfaces that a G-buffer holds, float64[n, ...], and the pixels bool[h, w] that hold one."""
    depth = run.inputs["depth"].astype(np.float64)[..., 0]
    drawn = depth != (0.0 if run.frame.depth == "reversed" else 1.0)
    height, width = depth.shape
    row, column = np.nonzero(drawn)
    z = view_z(depth[drawn], seen.view.projection)
    p = seen.view.projection
    x = -z * ((column + 0.5) / width * 2.0 - 1.0 + p[0, 2]) / p[0, 0]
    y = -z * ((row + 0.5) / height * 2.0 - 1.0 + p[1, 2]) / p[1, 1]
    to_world = np.linalg.inv(seen.view.view)
    normal_format = run.descs["normal"]
    assert isinstance(normal_format, TextureDesc)
    material = run.inputs["material"].astype(np.float64)[drawn]
    emissive = run.inputs["emissive"][drawn][:, :3] if "emissive" in run.inputs else np.zeros((len(z), 3))
    arriving = (
        bilinear(run.inputs["occlusion"].astype(np.float64)[..., 0], height, width)[drawn]
        if "occlusion" in run.inputs
        else 1.0
    )
    points = Points(
        position=np.stack([x, y, z], axis=1) @ to_world[:3, :3].T + to_world[:3, 3],
        normal=unpack_normals(run.inputs["normal"].astype(np.float64)[drawn], normal_format.format),
        base_color=run.inputs["base_color"].astype(np.float64)[drawn][:, :3],
        roughness=material[:, 0],
        metallic=material[:, 1],
        occlusion=material[:, 2] * arriving,
        emissive=emissive.astype(np.float64),
        unlit=material[:, 3] > 0.5,
    )
    return points, drawn


def radiance(run: PassRun, points: Points, sun: F64) -> F64:
    """Radiance towards the camera, float64[n, 3]; ``sun``: the share of the sun's light that arrives, float64[n]."""
    assert run.scene is not None
    assert run.camera is not None
    lit = shade(
        points.position, points.normal, points.base_color, points.roughness, points.metallic, points.occlusion,
        points.emissive, scene=lights_now(run, run.scene), eye=np.array(run.camera.position, dtype=np.float64),
        sun_visibility=sun,
    )  # fmt: skip
    return np.where(points.unlit[:, None], points.base_color, lit)


def lights_now(run: PassRun, scene: Scene) -> Scene:
    """The scene with the lights that run circles where they are in this frame."""
    turn = run.index / max(run.frame.count, 1)
    return replace(scene, lights=[replace(one, position=one.position_at(turn), circle=0.0) for one in scene.lights])


def mapped_sun(run: PassRun, position: F64, normal: F64, view_depth: F64) -> tuple[F64, Bools]:
    """The share of the sun at points by the shadow map that the pass reads, and where float32 cannot change it."""
    assert run.scene is not None
    if run.scene.sun is None or "shadow_map" not in run.inputs:
        return np.ones(len(position)), np.ones(len(position), dtype=bool)
    towards = sun_direction(run.scene)
    found = look_up(
        map_layers(run.inputs["shadow_map"]), Cascades.of(np.asarray(run.inputs["cascades"], dtype=np.uint32)),
        position, normal, view_depth, towards, int(getattr(run.params, "shadow_taps", 1)),
        run.frame.depth == "reversed",
    )  # fmt: skip
    return found.lit, found.sure | (normal @ towards < -1e-6)


def sun_direction(scene: Scene) -> F64:
    """Unit vector towards the sun."""
    assert scene.sun is not None
    towards = -np.array(scene.sun.direction, dtype=np.float64)
    return np.asarray(towards / np.linalg.norm(towards))


def image_truth(run: PassRun, drawn: Bools, color: F64, sure: Bools, tolerance: float | None) -> Truth:
    """Radiance of the drawn pixels float64[n, 3] over black, known where ``sure``. A background that is black, as it
    must be, is left out: it would thin the error out.
    """
    judged = run.outputs["color"].astype(np.float64)[..., :3]
    value, mask = np.zeros((*drawn.shape, 3)), np.asarray(judged.any(axis=2))
    value[drawn], mask[drawn] = color, sure
    return Truth(value, judged, mask=mask, tolerance=tolerance)


def color_tolerance(run: PassRun, *, srgb: bool) -> float:
    """Relative MSE allowed to a lit image of the target's format; ``srgb``: colours come from sRGB texels."""
    desc = run.descs["color"]
    assert isinstance(desc, TextureDesc)
    shadowed = "shadow_map" in run.inputs
    return _TARGET_ERROR[desc.format] + _SRGB_ERROR * srgb + _SHADOW_ERROR * shadowed


def bilinear(values: F64, height: int, width: int) -> F64:
    """A texture float64[h, w] sampled at the pixels' centres of an image of another size, clamped to its edge."""
    weights = []
    for size, count in zip(values.shape, (height, width), strict=True):
        place = (np.arange(count) + 0.5) / count * size - 0.5
        low = np.floor(place).astype(np.int64)
        weight = np.zeros((count, size))
        np.add.at(weight, (np.arange(count), np.clip(low, 0, size - 1)), 1.0 - (place - low))
        np.add.at(weight, (np.arange(count), np.clip(low + 1, 0, size - 1)), place - low)
        weights.append(weight)
    return np.asarray(weights[0] @ values @ weights[1].T)


def _traced(run: PassRun, seen: Surfaces, points: Points, drawn: Bools, view_depth: F64) -> Truth:
    assert run.scene is not None
    shadowed = run.scene.sun is not None and "shadow_map" in run.inputs
    # A pixel whose depth is another surface's than the ray's has no geometric normal to leave it by.
    sure = (np.abs(seen.view_depth[drawn] - view_depth) < 1e-3 * view_depth) & seen.hit[drawn] & shadowed
    sun = np.ones(len(view_depth))
    if shadowed:
        towards, geometric = sun_direction(run.scene), seen.geometric_normal[drawn]
        lit = sun_visible(seen.rays, seen.position[drawn][sure], geometric[sure], towards)
        sun[sure] = lit & (geometric[sure] @ towards > 0.0)
    truth = image_truth(run, drawn, radiance(run, points, sun), sure, None)
    return truth if shadowed else replace(truth, mask=np.zeros_like(drawn))
