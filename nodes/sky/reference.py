"""The sky's radiance in float64, written from the paper's formulas; one direction or many."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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
            covered = np.clip((sun_radius - angle) / pixel + 0.5, 0.0, 1.0) * (directions[..., 1] >= 0.0)
            disc = covered[..., None] * irradiance / (math.pi * math.sin(sun_radius) ** 2)
    share = smoothstep(-horizon, horizon, directions[..., 1])[..., None]
    ground = np.array(light.ambient_ground)
    return np.asarray(np.minimum((1 - share) * ground + share * above + disc, CEILING))
