"""The light model in float64 numpy, from the textbook forms: the truth the shaders are measured against.

Shares nothing with ``shaders/brdf.glsl`` and ``lights.glsl`` but the constants of ``docs/conventions.md``. Sources:
Walter et al. 2007 (GGX), Heitz 2014 (height-correlated Smith), Schlick 1994 (Fresnel), Karis 2013 (window).

Arrays broadcast over their leading axes; vectors are ``float64[..., 3]``, in world space, unit length where directions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]

MIN_ALPHA = 0.002
MIN_NOV = 1e-4
DIELECTRIC_F0 = 0.04
MAX_RADIANCE = 65504.0

# Quotients of quadratics in NoV (x) and roughness (r); terms 1, x, r, xr, xx, rr, xxr, xrr.
_A_ABOVE = np.array([-0.069, 3.392, 1.849, -20.789, 39.548, 0.031, -39.706, 19.731])
_A_BELOW = np.array([1.0, 4.867, -0.626, -25.981, 35.452, 1.719, -28.935, 26.371])
_B_ABOVE = np.array([1.029, 0.489, -0.071, -2.120, -2.407, -0.650, 2.220, 2.379])
_B_BELOW = np.array([1.0, 3.994, 2.312, -57.420, 45.577, 7.051, -3.433, 158.247])


def dot(a: F64, b: F64) -> F64:
    """Inner product over the last axis."""
    product: F64 = np.sum(a * b, axis=-1)
    return product


def normalize(v: F64) -> F64:
    """Unit vectors; the zero vector stays zero."""
    length = np.sqrt(dot(v, v))[..., None]
    unit: F64 = np.divide(v, length, out=np.zeros_like(v), where=length > 0)
    return unit


def alpha_of(roughness: F64) -> F64:
    """GGX width of a perceptual roughness."""
    return np.maximum(roughness * roughness, MIN_ALPHA)


def reflectance_at_normal(base_color: F64, metallic: F64) -> F64:
    """Specular reflectance at normal incidence, ``float64[..., 3]``."""
    blend: F64 = DIELECTRIC_F0 + (base_color - DIELECTRIC_F0) * metallic[..., None]
    return blend


def _smith_lambda(cosine: F64, alpha: F64) -> F64:
    tangent2 = (1.0 - cosine * cosine) / (cosine * cosine)
    value: F64 = 0.5 * (np.sqrt(1.0 + alpha * alpha * tangent2) - 1.0)
    return value


def brdf_cosine(normal: F64, view: F64, light: F64, base_color: F64, roughness: F64, metallic: F64) -> F64:
    """``f(L, V) max(N.L, 0)`` in 1/sr, ``float64[..., 3]``: Fresnel-weighted Lambert plus GGX."""
    alpha = alpha_of(roughness)
    nol = np.clip(dot(normal, light), 0.0, 1.0)
    nov = np.clip(dot(normal, view), MIN_NOV, 1.0)
    half = normalize(light + view)
    # 1 - NoH^2 as the squared sine of the angle, by the cross product: exact where the cosine has no digits left.
    cross = np.cross(np.broadcast_to(normal, half.shape), half)
    sine2 = dot(cross, cross)
    cosine2 = dot(normal, half) ** 2  # negative where a shading normal faces away from the eye: no peak there
    distribution = alpha**2 / (np.pi * (cosine2 * alpha**2 + sine2) ** 2)
    lit = nol > 0.0
    safe_nol = np.where(lit, nol, 1.0)
    shadowing = 1.0 / (1.0 + _smith_lambda(safe_nol, alpha) + _smith_lambda(nov, alpha))
    f0 = reflectance_at_normal(base_color, metallic)
    grazing = np.clip(1.0 - dot(light, half), 0.0, 1.0)[..., None] ** 5
    fresnel = f0 + (1.0 - f0) * grazing
    specular = fresnel * (distribution * shadowing / (4.0 * safe_nol * nov))[..., None]
    diffuse = (1.0 - fresnel) * base_color * (1.0 - metallic[..., None]) / np.pi
    result: F64 = np.where(lit[..., None], (diffuse + specular) * nol[..., None], 0.0)
    return result


def attenuation(distance: F64, radius: F64, minimum: float = 0.01) -> F64:
    """Irradiance per radiant intensity, 1/m^2, at a distance in metres; exactly zero at and beyond ``radius``."""
    inside = distance < radius
    ratio = np.divide(distance, radius, out=np.ones_like(distance), where=inside)
    window = np.clip(1.0 - ratio**4, 0.0, 1.0) ** 2
    value: F64 = np.where(inside, window / np.maximum(distance, minimum) ** 2, 0.0)
    return value


def cone(cosine: F64, inner: F64, outer: F64) -> F64:
    """Spot falloff between half angles (radians): smoothstep of the cosine, exactly zero at and outside ``outer``."""
    low, high = np.cos(outer), np.cos(inner)
    t = np.clip((cosine - low) / np.maximum(high - low, 1e-6), 0.0, 1.0)
    value: F64 = np.where(cosine > low, t * t * (3.0 - 2.0 * t), 0.0)
    return value


def ambient(normal: F64, view: F64, base_color: F64, roughness: F64, metallic: F64, sky: F64, ground: F64) -> F64:
    """Radiance reflected from the hemisphere of constant ``sky`` and ``ground`` radiance, ``float64[..., 3]``."""

    def radiance(direction: F64, width: F64) -> F64:
        share = np.clip(0.5 + 0.5 * direction[..., 1] / width, 0.0, 1.0)[..., None]
        mixed: F64 = ground * (1.0 - share) + sky * share
        return mixed

    nov = np.clip(dot(normal, view), MIN_NOV, None)
    reflected = environment_fit(nov, roughness, reflectance_at_normal(base_color, metallic))
    mirror = 2.0 * dot(normal, view)[..., None] * normal - view
    diffuse = base_color * (1.0 - metallic[..., None])
    specular: F64 = reflected * radiance(mirror, 0.05 + 0.95 * roughness)
    return specular + (1.0 - reflected) * diffuse * radiance(normal, np.ones_like(roughness))


def environment_fit(nov: F64, roughness: F64, f0: F64) -> F64:
    """The fit of the specular lobe's directional albedo that the shaders use; see :func:`directional_albedo`."""
    x, r = np.broadcast_arrays(nov, roughness)
    terms = np.stack([np.ones_like(x), x, r, x * r, x * x, r * r, x * x * r, x * r * r], axis=-1)
    a = (terms @ _A_ABOVE) / (terms @ _A_BELOW)
    b = (terms @ _B_ABOVE) / (terms @ _B_BELOW)
    fitted: F64 = f0 * np.clip(a, 0.0, 1.0)[..., None] + np.clip(b, 0.0, 1.0)[..., None]
    return np.minimum(fitted, 1.0)


def directional_albedo(nov: float, roughness: float, f0: float, samples: int = 4096) -> float:
    """Share of constant light the specular lobe really reflects: midpoint rule over GGX half vectors."""
    alpha = float(alpha_of(np.array(roughness)))
    side = int(samples**0.5)
    u, v = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side) + 0.5) / side)
    cosine = np.sqrt((1.0 - u) / (1.0 + (alpha**2 - 1.0) * u))
    sine, angle = np.sqrt(1.0 - cosine**2), 2.0 * np.pi * v
    half = np.stack([sine * np.cos(angle), sine * np.sin(angle), cosine], axis=-1)
    view = np.array([np.sqrt(1.0 - nov**2), 0.0, nov])
    voh = half @ view
    nol = (2.0 * voh[..., None] * half - view)[..., 2]
    lit = (nol > 0.0) & (voh > 0.0)
    nol = np.where(lit, nol, 1.0)
    shadowing = 1.0 / (1.0 + _smith_lambda(nol, np.array(alpha)) + _smith_lambda(np.array(nov), np.array(alpha)))
    fresnel = f0 + (1.0 - f0) * np.clip(1.0 - voh, 0.0, 1.0) ** 5
    weight = fresnel * shadowing * np.abs(voh) / (cosine * nov)
    return float(np.where(lit, weight, 0.0).mean())


def shade(
    position: F64,
    normal: F64,
    base_color: F64,
    roughness: F64,
    metallic: F64,
    occlusion: F64,
    emissive: F64,
    *,
    scene: Any,
    eye: F64,
    sun_visibility: F64 | float = 1.0,
) -> F64:
    """Radiance towards ``eye`` of points of a ``rendergraph.scene.scene.Scene``'s surfaces, ``float64[..., 3]``.

    ``sun_visibility`` is the share of the sun each point sees. Local lights cast no shadows.
    """
    view = normalize(eye - position)
    total = emissive.astype(np.float64)
    if scene.ambient is not None:
        sky, ground = np.array(scene.ambient.sky), np.array(scene.ambient.ground)
        total = total + occlusion[..., None] * ambient(normal, view, base_color, roughness, metallic, sky, ground)
    if scene.sun is not None:
        towards = np.broadcast_to(normalize(-np.array(scene.sun.direction, dtype=np.float64)), normal.shape)
        irradiance = np.array(scene.sun.irradiance) * np.asarray(sun_visibility)[..., None]
        total = total + irradiance * brdf_cosine(normal, view, towards, base_color, roughness, metallic)
    for light in scene.lights:
        to_light = np.array(light.position) - position
        distance = np.sqrt(dot(to_light, to_light))
        if np.all(distance >= light.radius):
            continue  # exactly nothing arrives: of very many lights, most reach none of these points
        direction = normalize(to_light)
        strength = attenuation(distance, np.full_like(distance, light.radius))
        if light.outer is not None:
            axis = normalize(np.array(light.axis, dtype=np.float64))
            inner = np.array(min(light.inner, light.outer))
            strength = strength * cone(-direction @ axis, inner, np.array(light.outer))
        irradiance = np.array(light.intensity) * strength[..., None]
        total = total + irradiance * brdf_cosine(normal, view, direction, base_color, roughness, metallic)
    result: F64 = np.minimum(total, MAX_RADIANCE)
    return result
