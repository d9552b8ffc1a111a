"""The truth of forward shading: surfaces by rays, the light model in float64, and compositing of transparent layers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.node.reference import PassRun, Truth
from rendergraph.nodes.deferred_lighting.reference import (
    Points,
    color_tolerance,
    finite_light,
    mapped_sun,
    radiance,
    sun_direction,
)
from rendergraph.nodes.deferred_lighting.textbook import shade
from rendergraph.nodes.forward_shading.layers import Layers, blend, blended_layers
from rendergraph.nodes.shadow_map.reference import sun_visible
from rendergraph.scene.scene import Scene

if TYPE_CHECKING:
    from rendergraph.measure.truth.materials import Shading
    from rendergraph.measure.truth.surfaces import Surfaces

__all__ = ["composite", "invariants", "judge", "shade"]

F64 = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


def judge(run: PassRun) -> Mapping[str, Truth]:
    """The image against the float64 light model at what rays hit, with the shadow map that the pass reads and with the
    sun traced; known where the rays' surfaces are, and no texture is minified.
    """
    assert run.trace is not None
    assert run.scene is not None
    seen: Surfaces = run.trace()
    queues = getattr(run.params, "queues", "all")
    shadowed = run.scene.sun is not None and "shadow_map" in run.inputs
    judged = run.outputs["color"].astype(np.float64)[..., :3]
    before = run.before["color"].astype(np.float64)[..., :3] if queues == "transparent" else np.zeros_like(judged)
    known = np.ones_like(seen.hit) if queues == "transparent" else seen.known & (seen.magnified | ~seen.hit)
    # What is as it was, and must be, is left out: it would thin the error out.
    drawn = (judged != before).any(axis=2) | (seen.hit & (queues != "transparent"))
    layers = None
    if queues != "opaque":
        layers, clear = blended_layers(seen)
        covered = np.zeros(seen.hit.size, dtype=bool)
        covered[layers.pixel] = True
        # What is in front of a solid surface that is not known is not known either, nor whether anything is.
        known = known & clear & seen.known
        drawn |= covered.reshape(clear.shape)
    value, sure = _image(run, seen, before, layers, traced=False)
    ideal, _ = _image(run, seen, before, layers, traced=True)
    known = known & drawn
    return {
        "color": Truth(
            value, judged, mask=known & sure, tolerance=color_tolerance(run, srgb=_srgb_textured(run.scene))
        ),
        "traced": Truth(ideal, judged, mask=known & shadowed),
    }


def invariants(run: PassRun) -> Iterable[str]:
    """Nothing is negative, infinite or no number."""
    yield from finite_light(run)


def composite(background: F64, layers: list[tuple[F64, float]]) -> F64:
    """``layers`` (radiance ``float64[..., 3]`` and coverage 0..1), farthest first, over ``background``."""
    result = background
    for radiance_, coverage in layers:
        result = radiance_ * coverage + result * (1.0 - coverage)
    return np.asarray(result, dtype=np.float64)


def _srgb_textured(scene: Scene) -> bool:
    return any(m.base_color_texture is not None or m.emissive_texture is not None for m in scene.materials)


def _image(run: PassRun, seen: Surfaces, before: F64, layers: Layers | None, *, traced: bool) -> tuple[F64, Bools]:
    """Radiance float64[h, w, 3], and where no comparison with the shadow map is in doubt."""
    value, sure = before.copy(), np.ones(seen.hit.shape, dtype=bool)
    if getattr(run.params, "queues", "all") != "transparent":
        value[seen.hit], sure[seen.hit] = _lit(
            run, seen, seen.position[seen.hit], seen.shading, seen.geometric_normal[seen.hit], traced=traced
        )
    if layers is not None and len(layers.pixel):
        # Glass is lit by its shading normal alone: its panes are flat.
        color, certain = _lit(run, seen, layers.position, layers.shading, layers.shading.normal, traced=traced)
        value = blend(value, layers, color, lambda below, light, alpha: composite(below, [(light, float(alpha))]))
        doubtful = layers.pixel[~certain]
        sure.ravel()[doubtful] = False
    return value, sure


def _lit(
    run: PassRun, seen: Surfaces, position: F64, shading: Shading, geometric: F64, *, traced: bool
) -> tuple[F64, Bools]:
    assert run.scene is not None
    points = Points(
        position, shading.normal, shading.base_color, shading.roughness, shading.metallic, shading.occlusion,
        shading.emissive, shading.unlit,
    )  # fmt: skip
    view_depth = -(position @ seen.view.view[2, :3] + seen.view.view[2, 3])
    sun, sure = mapped_sun(run, position, shading.normal, view_depth)
    if traced and run.scene.sun is not None and "shadow_map" in run.inputs:
        towards = sun_direction(run.scene)
        sun = (sun_visible(seen.rays, position, geometric, towards) & (geometric @ towards > 0.0)).astype(np.float64)
    return radiance(run, points, sun), sure
