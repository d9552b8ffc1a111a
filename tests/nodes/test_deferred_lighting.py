"""The light model on the device against float64, over random inputs and where it could break."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shader_function import run_shader_function

from rendergraph.device.context import Device
from rendergraph.nodes.deferred_lighting import textbook

pytestmark = pytest.mark.gpu

BRDF = """
    vec3 n = vec3(inputs[i], inputs[i + 1u], inputs[i + 2u]);
    vec3 v = vec3(inputs[i + 3u], inputs[i + 4u], inputs[i + 5u]);
    vec3 l = vec3(inputs[i + 6u], inputs[i + 7u], inputs[i + 8u]);
    vec3 base = vec3(inputs[i + 9u], inputs[i + 10u], inputs[i + 11u]);
    Brdf b = make_brdf(n, v, base, inputs[i + 12u], inputs[i + 13u]);
    vec3 f = {call};
    outputs[o] = f.r; outputs[o + 1u] = f.g; outputs[o + 2u] = f.b;
"""

#: What evaluate_brdf would be with 1 - NoH^2 taken as a difference: digits cancel at the peak of sharp lobes.
CANCELLING = """
vec3 cancelling_brdf(Brdf b, vec3 light) {
    float nol = clamp(dot(b.normal, light), 0.0, 1.0);
    vec3 h = normalize(light + b.view);
    float noh = dot(b.normal, h), a2 = b.alpha * b.alpha;
    float q = noh * noh * (a2 - 1.0) + 1.0;
    float d = a2 / (PI * q * q);
    vec3 fresnel = schlick_fresnel(b.f0, dot(light, h));
    float v = 0.5 / (b.nov * smith_root(nol, b.alpha2) + nol * b.root);
    return ((1.0 - fresnel) * b.lambert + fresnel * d * v) * nol;
}
"""


def unit(rng: np.random.Generator, count: int) -> np.ndarray:
    v = rng.normal(size=(count, 3))
    return (v / np.linalg.norm(v, axis=1, keepdims=True)).astype(np.float32)


def brdf_rows(count: int = 200_000) -> np.ndarray:
    """Random directions, half of them near the mirror direction where sharp lobes live; roughness 0 and 1 included."""
    rng = np.random.default_rng(7)
    normal, view = unit(rng, count), unit(rng, count)
    view = np.where((normal * view).sum(1, keepdims=True) < 0, -view, view)
    mirror = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    spread = 10.0 ** rng.uniform(-5, 0, size=(count, 1))
    light = np.where(rng.random((count, 1)) < 0.5, unit(rng, count), mirror + spread * unit(rng, count))
    light = light / np.linalg.norm(light, axis=1, keepdims=True)
    roughness = rng.choice([0.0, 0.02, 0.05, 0.3, 1.0], size=(count, 1))
    roughness = np.where(rng.random((count, 1)) < 0.5, roughness, rng.random((count, 1)))
    metallic = np.where(rng.random((count, 1)) < 0.5, rng.integers(0, 2, (count, 1)), rng.random((count, 1)))
    return np.concatenate([normal, view, light, rng.random((count, 3)), roughness, metallic], axis=1).astype(np.float32)


def brdf_truth(rows: np.ndarray) -> np.ndarray:
    r = rows.astype(np.float64)
    return textbook.brdf_cosine(r[:, 0:3], r[:, 3:6], r[:, 6:9], r[:, 9:12], r[:, 12], r[:, 13])


def brdf_error(result: np.ndarray, truth: np.ndarray) -> float:
    """Largest difference, relative above 0.01 and absolute below."""
    return float((np.abs(result - truth) / np.maximum(np.abs(truth), 0.01)).max())


def test_brdf_matches_float64(device: Device, tmp_path: Path) -> None:
    rows = brdf_rows()
    truth = brdf_truth(rows)
    result = run_shader_function(
        device, tmp_path, BRDF.format(call="evaluate_brdf(b, l)"), rows, 3, includes=("brdf.glsl",)
    )
    assert np.isfinite(result).all()
    error = brdf_error(result, truth)
    bad = run_shader_function(
        device, tmp_path, BRDF.format(call="cancelling_brdf(b, l)"), rows, 3,
        includes=("brdf.glsl",), functions=CANCELLING,
    )  # fmt: skip
    assert error < 2e-3
    assert brdf_error(bad, truth) > 2e-2


def test_brdf_is_finite_and_not_negative_at_the_extremes(device: Device, tmp_path: Path) -> None:
    n = np.array([0.0, 0.0, 1.0])
    directions = [n, -n, np.array([1.0, 0, 0]), np.array([-1.0, 0, 0]), np.zeros(3)]
    for angle in (89.9, 89.99999, 90.0, 90.00001, 179.99999):
        a = np.radians(angle)
        directions += [np.array([np.sin(a), 0, np.cos(a)]), np.array([-np.sin(a), 0, np.cos(a)])]
    rows = np.array([
        [*n, *view, *light, 1.0, 0.5, 0.0, roughness, metallic]
        for view in directions for light in directions for roughness in (0.0, 1e-3, 0.5, 1.0) for metallic in (0.0, 1.0)
    ])  # fmt: skip
    result = run_shader_function(
        device, tmp_path, BRDF.format(call="evaluate_brdf(b, l)"), rows, 3, includes=("brdf.glsl",)
    )
    assert np.isfinite(result).all()
    assert (result >= 0).all()
    below = rows[:, 8] <= 0
    assert (result[below] == 0).all()
    assert result[~below].max() > 0


def test_brdf_reflects_no_more_than_it_receives(device: Device, tmp_path: Path) -> None:
    """White furnace: what a white surface sends out under light from all around. A metal loses what bounces between its
    facets; under a dielectric's coat the half-vector Fresnel weight of glTF's model lets grazing views gain a little.
    """
    side = 256
    u, v = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side) + 0.5) / side)
    radius, angle = np.sqrt(u.ravel()), 2 * np.pi * v.ravel()
    light = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - radius**2)], axis=1)
    for roughness in (0.35, 0.6, 1.0):
        for metallic in (0.0, 1.0):
            for cosine in (1.0, 0.6, 0.2):
                view = (np.sqrt(1 - cosine**2), 0.0, cosine)
                row = np.array([0, 0, 1, *view, 0, 0, 0, 1, 1, 1, roughness, metallic])
                rows = np.tile(row, (len(light), 1))
                rows[:, 6:9] = light
                result = run_shader_function(
                    device, tmp_path, BRDF.format(call="evaluate_brdf(b, l)"), rows, 3, includes=("brdf.glsl",)
                )
                # Cosine-weighted samples: the mean of f / pdf, with cos in f already and pdf = cos / pi.
                albedo = float((result[:, 0] / light[:, 2]).mean() * np.pi)
                limit = 1.005 if metallic else (1.01 if cosine > 0.5 else 1.2)
                assert 0.25 < albedo <= limit, (roughness, metallic, cosine, albedo)


# ---------------------------------------------------------------- attenuation

ATTENUATION = """
    float d = inputs[i];
    outputs[o] = distance_attenuation(d * d, inputs[i + 1u], 0.01);
    outputs[o + 1u] = cone_attenuation(inputs[i + 2u], inputs[i + 3u], inputs[i + 4u]);
"""


def attenuate(device: Device, folder: Path, rows: np.ndarray) -> np.ndarray:
    lights = {"Lights": bytes(64)}
    return run_shader_function(device, folder, ATTENUATION, rows, 2, includes=("lights.glsl",), blocks=lights)


def test_attenuation_matches_float64(device: Device, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    radius = 10.0 ** rng.uniform(-2, 4, 100_000)
    distance = radius * np.where(rng.random(100_000) < 0.5, rng.random(100_000), 10.0 ** rng.uniform(-6, 0.2, 100_000))
    outer = rng.uniform(0.01, 1.5, 100_000)
    inner = outer * rng.random(100_000)
    cosine = rng.uniform(-1, 1, 100_000)
    rows = np.stack([distance, radius, cosine, np.cos(inner), np.cos(outer)], axis=1).astype(np.float32)
    result = attenuate(device, tmp_path, rows)
    r = rows.astype(np.float64)
    truth = textbook.attenuation(r[:, 0], r[:, 1])
    peak = 1.0 / np.maximum(r[:, 0], 0.01) ** 2
    assert (np.abs(result[:, 0] - truth) / peak).max() < 2e-6
    spot = textbook.cone(r[:, 2], np.arccos(r[:, 3]), np.arccos(r[:, 4]))
    assert np.abs(result[:, 1] - spot).max() < 1e-2  # a cosine's last digit against the narrowest cones' width
    assert np.median(np.abs(result[:, 1] - spot)) < 1e-6
    wrong_window = np.clip(1 - (r[:, 0] / r[:, 1]) ** 2, 0, 1) ** 2 / np.maximum(r[:, 0], 0.01) ** 2
    assert (np.abs(wrong_window - truth) / peak).max() > 0.1


def test_a_light_is_exactly_dark_at_its_radius_and_outside_its_cone(device: Device, tmp_path: Path) -> None:
    reach = np.float32([0.001, 0.1, 1.0, 3.3, 7.0, 1e3, 1e6])
    at = [[r, r, 0.5, 0.9, 0.5] for r in reach]
    beyond = [
        [np.nextafter(r, np.float32(np.inf)) * 1.01, r, np.nextafter(np.float32(0.5), np.float32(0)), 0.9, 0.5]
        for r in reach
    ]
    inside = [[r * np.float32(0.9), r, 0.51, 0.9, 0.5] for r in reach]
    result = attenuate(device, tmp_path, np.array(at + beyond))
    assert (result == 0).all()
    assert (attenuate(device, tmp_path, np.array(inside)) > 0).all()


def test_attenuation_extremes_are_finite(device: Device, tmp_path: Path) -> None:
    rows = np.array(
        [[0, 1, 1, 1, 1], [0, 0, 1, 1, 1], [1e-20, 1e-20, 1, 0.5, 0.5], [1e18, 1e19, -1, 1, 1], [0, 1e6, 1, 1, 0.999]]
    )
    result = attenuate(device, tmp_path, rows)
    assert np.isfinite(result).all()
    assert result[0, 0] == pytest.approx(1e4)  # the light at the surface: 1 / d0^2
    assert result[1, 0] == 0  # no reach


# ---------------------------------------------------------------- ambient

ENVIRONMENT = """
    float c = inputs[i];
    Brdf b = make_brdf(vec3(0.0, 0.0, 1.0), vec3(sqrt(1.0 - c * c), 0.0, c), vec3(inputs[i + 2u]), inputs[i + 1u], 1.0);
    outputs[o] = environment_reflectance(b, inputs[i + 1u]).r;
"""


def test_environment_fit_is_close_to_the_integral(device: Device, tmp_path: Path) -> None:
    rows = np.array([[c, r, f] for c in (0.1, 0.3, 0.6, 1.0) for r in (0.1, 0.3, 0.6, 1.0) for f in (0.04, 0.5, 1.0)])
    result = run_shader_function(device, tmp_path, ENVIRONMENT, rows, 1, includes=("brdf.glsl",))[:, 0]
    truth = np.array([textbook.directional_albedo(*row) for row in rows])
    assert np.abs(result - truth).max() < 0.06
    assert np.abs(rows[:, 2] - truth).max() > 0.3  # f0 alone, without the fit
