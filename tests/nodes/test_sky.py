"""The sky against float64 over cameras and suns, where it may be drawn, and what a scene without a sun leaves out."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from graph_run import build_node, paint, run_graph

from rendergraph.device.context import Device
from rendergraph.nodes.sky import reference
from rendergraph.plan.graph import TextureDesc, Usage
from rendergraph.scene.cameras import view_matrix
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.scene import Camera

if TYPE_CHECKING:
    from tests.conftest import Hardware

Vec3 = tuple[float, float, float]

WIDTH, HEIGHT = 96, 64
HDR = TextureDesc("rgba16f", 8, 8)
SUNS = {"noon": (0.1, 1.0, 0.1), "low": (0.2, 0.05, -1.0), "dusk": (0.0, -0.05, -1.0), "night": (0.0, -0.5, -1.0)}

#: Depth at the far plane on the left, a hair in front of it on the right.
HALF_DEPTH = """\
#version 450
uniform float u_far;
void main() { gl_FragDepth = gl_FragCoord.x < 48.0 ? u_far : mix(u_far, 0.5, 1.0e-3); }
"""
BLACK = """\
#version 450
out vec4 color;
void main() { color = vec4(0.0); }
"""


def drawn(
    folder: Path,
    sun: Vec3 | None,
    position: Vec3,
    settings: dict[str, Any],
    depth: str = "reversed",
    far: float | None = None,
    masked: bool = False,
    full: bool = False,
) -> np.ndarray:
    """The sky over black, as float32, seen from ``position`` a little upwards along -z."""
    lights: dict[str, Any] = {"from_scene": False, "ambient": {"sky": [0.1, 0.13, 0.18], "ground": [0.06, 0.055, 0.05]}}
    if sun is not None:
        lights["sun"] = {"direction": [-v for v in sun], "illuminance": 5, "color": [1.0, 0.96, 0.9]}
    target = [position[0], position[1] + 0.15, position[2] - 1]
    camera = {"position": list(position), "target": target, "fov": 60, **({"far": far} if far else {})}
    graph: dict[str, Any] = {
        "frame": {"size": [WIDTH, HEIGHT], "depth": depth},
        "scene": {"source": "spheres", "detail": 0.0, "camera": camera, "lights": lights},
        "resources": {"hdr": {"format": "rgba32f"}, "depth": {"format": "d32f"}},
        "passes": {
            "paint": paint("hdr", "black.frag"),
            "sky": {"node": "sky", "write": {"color": "hdr"}, "after": ["paint"], "set": settings},
        },
        "outputs": {"hdr": {"file": "hdr.npy"}},
    }
    if masked:
        graph["passes"]["mask"] = {
            "node": "fullscreen",
            "write": {"depth": "depth"},
            "set": {"shader": "depth.frag", "uniforms": {"u_far": 0.0 if depth == "reversed" else 1.0}},
        }
        graph["passes"]["sky"]["read"] = {"depth": "depth"}
    else:
        del graph["resources"]["depth"]
    return run_graph(folder, graph, {"black.frag": BLACK, "depth.frag": HALF_DEPTH}, full=full).images["hdr"]


def directions() -> np.ndarray:
    """Unit view directions in the world of ``drawn``'s camera, ``float64[height, width, 3]``."""
    x = ((np.arange(WIDTH) + 0.5) / WIDTH * 2 - 1) * math.tan(math.radians(30)) * WIDTH / HEIGHT
    y = ((np.arange(HEIGHT) + 0.5) / HEIGHT * 2 - 1) * math.tan(math.radians(30))
    rays = np.stack([*np.meshgrid(x, y), -np.ones((HEIGHT, WIDTH))], axis=-1)
    rays = rays @ view_matrix(Camera((0.0, 0.0, 0.0), (0.0, 0.15, -1.0)))[:3, :3]
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def light(sun: Vec3 | None) -> reference.Light:
    """The light of ``drawn``'s scene."""
    unit = np.array(sun or (0.0, 1.0, 0.0)) / np.linalg.norm(sun or (0.0, 1.0, 0.0))
    irradiance = (5.0, 4.8, 4.5) if sun else (0.0, 0.0, 0.0)
    return reference.Light((unit[0], unit[1], unit[2]), irradiance, (0.1, 0.13, 0.18), (0.06, 0.055, 0.05))


# ---------------------------------------------------------------- the sub-pass


def test_drawn_on_the_far_plane_without_writing_depth() -> None:
    depth = TextureDesc("d32f", 8, 8)
    (step,) = build_node("sky", {}, {"depth": depth}, {"color": HDR}, features=SceneFeatures(sun=True)).subpasses
    assert [(a.resource, a.usage, a.load) for a in step.accesses] == [
        ("out_color", Usage.COLOR, True),
        ("in_depth", Usage.DEPTH_READ, True),
    ]
    assert step.state.depth_test == "closer_equal"
    assert not step.state.depth_write


def test_without_depth_it_covers_everything() -> None:
    (step,) = build_node("sky", {}, {}, {"color": HDR}, features=SceneFeatures(sun=True)).subpasses
    assert step.state.depth_test is None


@pytest.mark.parametrize(
    ("features", "full", "shader"),
    [
        (SceneFeatures(sun=True), False, "analytic.frag"),
        (SceneFeatures(), False, "gradient.frag"),
        (SceneFeatures(), True, "analytic.frag"),
    ],
)
def test_a_scene_without_a_sun_gets_the_gradient(features: SceneFeatures, full: bool, shader: str) -> None:
    b = build_node("sky", {}, {}, {"color": HDR}, features=features, full=full)
    assert b.subpasses[0].program is not None
    assert dict(b.subpasses[0].program.stages)["fragment"].name == shader
    reasons = [(d.reason, d.evidence["feature"]) for d in b.decisions]
    assert reasons == ([("scene_lacks_feature", "sun")] if shader == "gradient.frag" else [])


# ---------------------------------------------------------------- the model


def test_zenith_of_the_paper() -> None:
    # Straight up both Perez functions are the same, so what is left is the zenith's luminance: turbidity 3, sun at the
    # zenith, chi = (4/9 - 3/120) pi.
    up = np.array([[0.0, 1.0, 0.0]])
    rgb = reference.preetham(up, up[0], 3.0)[0]
    luminance = (4.0453 * 3 - 4.9710) * math.tan((4 / 9 - 0.025) * math.pi) - 0.2155 * 3 + 2.4192
    assert float(rgb @ [0.2126729, 0.7151522, 0.0721750]) == pytest.approx(luminance, rel=1e-4)
    assert rgb[2] > rgb[1] > rgb[0]  # a clear sky is blue


@pytest.mark.gpu
@pytest.mark.parametrize("sun", SUNS)
@pytest.mark.parametrize(
    ("position", "depth", "far", "turbidity"),
    [
        ((0.0, 0.0, 0.0), "reversed", None, 2.0),
        ((1e4, 2.0, -1e4), "standard", 100.0, 6.0),
    ],
)
def test_equals_float64(
    device: Device,
    tmp_path: Path,
    sun: str,
    position: Vec3,
    depth: str,
    far: float | None,
    turbidity: float,
) -> None:
    settings = {"turbidity": turbidity, "sun_radius": 0.0, "sun_illuminance": 80.0}
    got = drawn(tmp_path, SUNS[sun], position, settings, depth, far)[..., :3]

    def error(turbidity: float) -> float:
        want = reference.sky(directions(), light(SUNS[sun]), turbidity=turbidity, sun_illuminance=80.0)
        return float((np.abs(got - want) / np.maximum(want, 0.01)).max())

    assert np.isfinite(got).all()
    assert error(turbidity) < 5e-5
    if sun != "night":
        assert error(turbidity + 0.1) > 5e-3  # the twin


@pytest.mark.gpu
@pytest.mark.parametrize("radius", [0.5, 3.0, 10.0])
def test_disc_equals_float64(device: Device, tmp_path: Path, radius: float) -> None:
    sun = (0.05, 0.2, -1.0)
    got = drawn(tmp_path, sun, (0.0, 0.0, 0.0), {"sun_radius": radius})[..., :3]
    pixel = 2.0 / HEIGHT * math.tan(math.radians(30))

    def error(radius: float) -> float:
        want = reference.sky(directions(), light(sun), sun_radius=math.radians(radius), pixel=pixel)
        return float(np.abs(got - want).max() / want.max())

    assert error(radius) < 2e-4  # of the disc: the last bits of an angle decide how much of a pixel is covered
    assert error(radius * 2.0) > 2e-3  # the twin; below a pixel, a slightly larger disc is as bright


@pytest.mark.gpu
@pytest.mark.parametrize("sun", [None, SUNS["noon"]])
def test_gradient_equals_float64(device: Device, tmp_path: Path, sun: Vec3 | None) -> None:
    settings = {"model": "gradient"} if sun else {}
    got = drawn(tmp_path, sun, (0.0, 0.0, 0.0), settings)[..., :3]
    want = reference.sky(directions(), light(sun), turbidity=None)
    np.testing.assert_allclose(got, want, rtol=1e-4)
    assert np.ptp(want[..., 2]) > 0.1


@pytest.mark.gpu
def test_unspecialised_run_gives_the_same_image(device: Device, hardware: Hardware, tmp_path: Path) -> None:
    plain = drawn(tmp_path, None, (0.0, 0.0, 0.0), {})
    full = drawn(tmp_path, None, (0.0, 0.0, 0.0), {}, full=True)
    np.testing.assert_allclose(full, plain, rtol=hardware.arithmetic, atol=0.0)
    assert not np.allclose(full * (1.0 + 2.0**-20), plain, rtol=hardware.arithmetic, atol=0.0)  # the twin


@pytest.mark.gpu
@pytest.mark.parametrize(("radius", "within"), [(6.0, 0.01), (0.7, 0.06), (0.2665, 0.12)])
def test_the_disc_carries_the_suns_irradiance(device: Device, tmp_path: Path, radius: float, within: float) -> None:
    # Towards a low sun: the sum of radiance times solid angle. A disc of 6 degrees spans 9 pixels; the sun's own is
    # half a pixel wide, and what the pixel centres sample of its ramp depends on where it lies between them.
    sun = (0.0, 0.2, -1.0)
    with_disc = drawn(tmp_path, sun, (0.0, 0.0, 0.0), {"sun_radius": radius})[..., :3]
    without = drawn(tmp_path, sun, (0.0, 0.0, 0.0), {"sun_radius": 0.0})[..., :3]
    rays = directions()
    forward = np.array([0.0, 0.15, -1.0]) / math.hypot(1.0, 0.15)
    solid_angle = (2.0 / HEIGHT * math.tan(math.radians(30))) ** 2 * (rays @ forward) ** 3
    facing = rays @ (np.array(sun) / np.linalg.norm(sun))
    irradiance = ((with_disc - without) * (solid_angle * facing)[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(irradiance, (5.0, 4.8, 4.5), rtol=within)


@pytest.mark.gpu
def test_a_tiny_disc_stays_finite_in_a_half_float(device: Device, tmp_path: Path) -> None:
    got = drawn(tmp_path, (0.0, 0.15, -1.0), (0.0, 0.0, 0.0), {"sun_radius": 1e-3})
    assert np.isfinite(got).all()
    assert got.max() <= reference.CEILING


# ---------------------------------------------------------------- where


@pytest.mark.gpu
@pytest.mark.parametrize("depth", ["reversed", "standard"])
def test_only_where_depth_is_at_the_far_plane(device: Device, tmp_path: Path, depth: str) -> None:
    got = drawn(tmp_path, SUNS["noon"], (0.0, 0.0, 0.0), {}, depth, masked=True)
    everywhere = drawn(tmp_path, SUNS["noon"], (0.0, 0.0, 0.0), {}, depth)
    np.testing.assert_array_equal(got[:, :48], everywhere[:, :48])
    assert (got[:, 48:] == 0.0).all()
    assert (everywhere[:, 48:, :3] > 0.0).all()


@pytest.mark.gpu
def test_multisampled_target_resolves_to_the_same_image(device: Device, tmp_path: Path) -> None:
    graph: dict[str, Any] = {
        "frame": {"size": [WIDTH, HEIGHT]},
        "scene": {"source": "spheres", "detail": 0.0, "lights": {"sun": {"direction": [-0.1, -1, -0.1]}}},
        "resources": {
            "many": {"format": "rgba16f", "samples": 4},
            "depth": {"format": "d32f", "samples": 4},
            "one": {"format": "rgba16f"},
        },
        "passes": {
            "far": {"node": "clear", "write": {"target": "depth"}, "set": {"value": 1}},
            "start": {"node": "clear", "write": {"target": "many"}},
            "sky": {"node": "sky", "read": {"depth": "depth"}, "write": {"color": "many"}, "after": ["start"]},
            "resolve": {
                "node": "copy", "read": {"source": "many"}, "write": {"destination": "one"}, "set": {"blit": True},
            },
        },
        "outputs": {"one": {"file": "one.npy"}},
    }  # fmt: skip
    resolved = run_graph(tmp_path, graph, {}).images["one"]
    graph["resources"] = {"one": {"format": "rgba16f"}}
    graph["passes"] = {
        "start": {"node": "clear", "write": {"target": "one"}},
        "sky": {"node": "sky", "write": {"color": "one"}, "after": ["start"]},
    }
    single = run_graph(tmp_path, graph, {}).images["one"]
    np.testing.assert_allclose(resolved.astype(float), single.astype(float), rtol=2e-3)
    assert single[..., :3].min() > 0
