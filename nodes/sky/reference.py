"""The sky's radiance in float64, written from the paper's formulas; one direction or many."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.measure.truth.storage import storage_error
from rendergraph.node.reference import PassRun, Truth
from rendergraph.scene.cameras import view_matrix

if TYPE_CHECKING:
    from rendergraph.nodes.sky import SkyParams

F64 = npt.NDArray[np.float64]

TWILIGHT = math.sin(math.radians(-6.0))
CEILING = 64512.0

#: Preetham 1999, appendix A.2: slope and intercept over turbidity of A..E, for luminance and the two chromaticities.
_PEREZ = {
    "Y": [(0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)],
    "x": [(-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)],
    "y": [(-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)],
}
#: Rows: turbidity squared, turbidity, one; columns: theta cubed, squared, theta, one.
_ZENITH = {
    "x": [
        (0.00166, -0.00375, 0.00209, 0.0),
        (-0.02903, 0.06377, -0.03202, 0.00394),
        (0.11693, -0.21196, 0.06052, 0.25886),
    ],
    "y": [
        (0.00275, -0.00610, 0.00317, 0.0),
        (-0.04214, 0.08970, -0.04153, 0.00516),
        (0.15346, -0.26756, 0.06670, 0.26688),
    ],
}
_XYZ_OF_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
_REC709 = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True, slots=True)
class Light:
    """The scene's light: ``sun`` the unit vector towards it, irradiance, ambient radiances; all rgb linear."""

    sun: tuple[float, float, float]
    irradiance: tuple[float, float, float]
    ambient_sky: tuple[float, float, float]
    ambient_ground: tuple[float, float, float]


def preetham(directions: F64, sun: F64, turbidity: float) -> F64:
    """Clear-sky radiance in kcd/m2, linear Rec. 709, ``float64[..., 3]``, of unit ``directions`` above the horizon."""
    theta_sun = math.acos(min(max(float(sun[1]), 0.0), 1.0))
    cos_theta = np.maximum(directions[..., 1], 1e-3)
    gamma = np.arccos(np.clip(directions @ sun, -1.0, 1.0))

    def perez(name: str, cosine: F64 | float, angle: F64 | float) -> F64:
        a, b, c, d, e = (slope * turbidity + intercept for slope, intercept in _PEREZ[name])
        return np.asarray((1 + a * np.exp(b / cosine)) * (1 + c * np.exp(d * angle) + e * np.cos(angle) ** 2))

    powers = np.array([theta_sun**3, theta_sun**2, theta_sun, 1.0])
    haze = np.array([turbidity**2, turbidity, 1.0])
    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * theta_sun)
    zenith = {name: float(haze @ np.array(rows) @ powers) for name, rows in _ZENITH.items()}
    zenith["Y"] = max((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192, 0.0)
    seen = {name: zenith[name] * perez(name, cos_theta, gamma) / perez(name, 1.0, theta_sun) for name in "xyY"}
    x, y, luminance = seen["x"], seen["y"], seen["Y"]
    xyz = np.stack([x / y * luminance, luminance, (1 - x - y) / y * luminance], axis=-1)
    return np.maximum(xyz @ np.linalg.inv(_XYZ_OF_RGB).T, 0.0)


def smoothstep(low: float, high: float, value: F64 | float) -> F64:
    """GLSL's, for ``low < high``."""
    t = np.clip((np.asarray(value) - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def sky(
    directions: F64,
    light: Light,
    *,
    turbidity: float | None = 3.0,
    sun_illuminance: float = 100.0,
    sun_radius: float = 0.0,
    horizon: float = 0.02,
    pixel: float = 1e-3,
) -> F64:
    """Radiance of unit ``directions``, ``float64[..., 3]``. No ``turbidity``: the gradient.

    ``sun_radius`` and ``pixel``, the angle over which the disc's edge is smoothed, are in radians.
    """
    sun, irradiance = np.array(light.sun), np.array(light.irradiance)
    above = np.broadcast_to(np.array(light.ambient_sky), directions.shape)
    disc = np.zeros_like(directions)
    strength = float(irradiance @ _REC709)
    if turbidity is not None and strength > 0.0 and sun[1] > TWILIGHT:
        day = float(smoothstep(TWILIGHT, 0.0, float(sun[1])))
        above = (1 - day) * above + day * preetham(directions, sun, turbidity) * strength / sun_illuminance
        if sun_radius > 0.0:
            angle = np.arctan2(np.linalg.norm(np.cross(directions, sun), axis=-1), directions @ sun)
            radius = max(sun_radius, pixel / 2)
            covered = np.clip((radius - angle) / pixel + 0.5, 0.0, 1.0) * (directions[..., 1] >= 0.0)
            covered *= sun_radius**2 / (radius**2 + pixel**2 / 12)  # the ramp's own share of the light
            disc = covered[..., None] * irradiance / (math.pi * math.sin(sun_radius) ** 2)
    share = smoothstep(-horizon, horizon, directions[..., 1])[..., None]
    ground = np.array(light.ambient_ground)
    return np.asarray(np.minimum((1 - share) * ground + share * above + disc, CEILING))


# ---------------------------------------------------------------- judging

#: Relative, of float32 arithmetic: the model's exponentials of up to ten (measured: 2e-5).
ARITHMETIC = 5e-5
#: A pixel of which the disc covers less has its last digits decided by those of an angle: not judged.
LEAST_COVERED = 0.02


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``radiance``: of the model asked for where the sky is seen, what was there before elsewhere. ``daylight``: the
    same of the analytic model, whatever was asked for.
    """
    params: SkyParams = run.params  # type: ignore[assignment]
    out = np.asarray(run.outputs["color"], np.float64)
    before = np.asarray(run.before["color"], np.float64)
    rays, pixel = view_rays(run), _pixel(run)
    seen, sure = where_far(run)
    format = run.descs["color"].format  # type: ignore[union-attr]
    stored = ARITHMETIC + float(np.max(storage_error(format, np.ones(3))))
    light = scene_light(run)
    asked = _sky(params, rays, light, pixel, params.model)
    value = np.where(seen[..., None], asked, before[..., :3])
    mask = sure & ~(seen & _on_the_discs_edge(params, rays, light, pixel))
    analytic = _sky(params, rays, light, pixel, "analytic")
    return {
        "radiance": Truth(value, judged=out[..., :3], mask=mask, tolerance=stored**2),
        "daylight": Truth(
            np.where(seen[..., None], analytic, before[..., :3]),
            judged=out[..., :3],
            mask=mask,
            tolerance=stored**2 if params.model == "analytic" else 1.0,
        ),
    }


def invariants(run: PassRun) -> Iterator[str]:
    """Radiance is no less than nothing, alpha is one, and what geometry covers is left as it was, to the last bit."""
    out = np.asarray(run.outputs["color"], np.float64)
    before = np.asarray(run.before["color"], np.float64)
    seen, sure = where_far(run)
    drawn, kept = out[seen & sure], sure & ~seen
    if drawn.size and not (np.isfinite(drawn).all() and drawn.min() >= 0.0):
        yield "the sky's radiance is negative or no number"
    if drawn.size and drawn[:, :3].max() > CEILING:
        yield f"the sky's radiance exceeds {CEILING:g}"
    if out.shape[-1] == 4 and not (drawn[:, 3] == 1.0).all():
        yield "the sky's alpha is not 1"
    if not np.array_equal(out[kept], before[kept], equal_nan=True):
        yield "texels in front of the far plane were changed"


def view_rays(run: PassRun) -> F64:
    """World-space unit directions through the pixels' centres, ``float64[h, w, 3]``; the camera's place has no part."""
    assert run.camera is not None
    frame, camera = run.frame, run.camera
    half = math.tan(camera.fov / 2)
    x = ((np.arange(frame.width) + 0.5) / frame.width * 2 - 1) * half * frame.width / frame.height
    y = ((np.arange(frame.height) + 0.5) / frame.height * 2 - 1) * half
    rays = np.stack([*np.meshgrid(x, y), -np.ones((frame.height, frame.width))], axis=-1) @ view_matrix(camera)[:3, :3]
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))


def where_far(run: PassRun) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """(where the depth is at the far plane, where that is sure), both bool[h, w]: of several samples a pixel's edges
    are not.
    """
    height, width = np.asarray(run.outputs["color"]).shape[:2]
    if "depth" not in run.inputs:
        return np.ones((height, width), bool), np.ones((height, width), bool)
    depth = np.asarray(run.inputs["depth"], np.float64)[..., 0]
    far = depth == (0.0 if run.frame.depth == "reversed" else 1.0)
    sure = np.ones_like(far)
    if run.descs["color"].samples > 1:  # type: ignore[union-attr]
        padded = np.pad(far, 1, mode="edge")
        around = [padded[i : i + height, j : j + width] for i in range(3) for j in range(3)]
        sure = np.logical_and.reduce(around) | ~np.logical_or.reduce(around)
    return far, sure


def scene_light(run: PassRun) -> Light:
    """The scene's light as shaders/frame.glsl states it; a scene without a sun has none from straight above."""
    assert run.scene is not None
    sun, ambient = run.scene.sun, run.scene.ambient
    towards = -np.asarray(sun.direction, np.float64) if sun else np.array([0.0, 1.0, 0.0])
    x, y, z = (float(v) for v in towards / np.linalg.norm(towards))
    return Light(
        (x, y, z),
        sun.irradiance if sun else (0.0, 0.0, 0.0),
        ambient.sky if ambient else (0.0, 0.0, 0.0),
        ambient.ground if ambient else (0.0, 0.0, 0.0),
    )


def _pixel(run: PassRun) -> float:
    assert run.camera is not None
    return 2.0 / run.frame.height * math.tan(run.camera.fov / 2)


def _sky(params: SkyParams, rays: F64, light: Light, pixel: float, model: str) -> F64:
    return sky(
        rays,
        light,
        turbidity=params.turbidity if model == "analytic" else None,
        sun_illuminance=params.sun_illuminance,
        sun_radius=math.radians(params.sun_radius),
        horizon=params.horizon,
        pixel=pixel,
    )


def _on_the_discs_edge(params: SkyParams, rays: F64, light: Light, pixel: float) -> npt.NDArray[np.bool_]:
    """Pixels of which the disc covers hardly anything, or that lie on the horizon, which cuts it off."""
    sun = np.array(light.sun)
    angle = np.arctan2(np.linalg.norm(np.cross(rays, sun), axis=-1), rays @ sun)
    covered = (max(math.radians(params.sun_radius), pixel / 2) - angle) / pixel + 0.5
    level = (np.abs(rays[..., 1]) < 1e-6) & (covered > 0.0)
    return np.asarray(((np.abs(covered) < LEAST_COVERED) | level) & (params.sun_radius > 0.0))
