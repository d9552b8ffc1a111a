"""The FXAA filter against exact area coverage, against itself in float64, and where it must change nothing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from graph_run import build_node, paint, run_graph

from rendergraph.device.context import Device
from rendergraph.nodes.fxaa import reference
from rendergraph.plan.graph import TextureDesc, Usage
from rendergraph.run.result import FrameResult

if TYPE_CHECKING:
    from tests.conftest import Hardware

HEIGHT, WIDTH = 48, 256

#: Half planes as in reference.aliased: one sample a texel.
HALF_PLANE = """\
#version 450
uniform float u_slope, u_offset, u_contrast;
out vec4 color;
void main() {
    float below = float(gl_FragCoord.y < u_offset + u_slope * gl_FragCoord.x);
    color = vec4(vec3(1.0 - u_contrast + u_contrast * below), 0.5);
}
"""

NOISE = """\
#version 450
out vec4 color;
void main() {
    uvec2 t = uvec2(gl_FragCoord.xy);
    uvec3 v = uvec3(t, 5u) * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    color = vec4(vec3(v >> 24u) / 255.0, float(v.x & 255u) / 255.0);
}
"""

FLAT = """\
#version 450
out vec4 color;
void main() { color = vec4(0.2, 0.7, 0.1, 0.4); }
"""

#: Slopes and where the line starts, so that the edge crosses the image well inside it.
EDGES = [(0.02, 20.3), (0.05, 17.6), (0.1, 11.2), (-0.04, 29.4), (0.0, 23.3)]


def filtered(
    folder: Path, shader: str, settings: dict[str, Any], size: tuple[int, int] = (WIDTH, HEIGHT), **uniforms: float
) -> FrameResult:
    """A painted image and its filtered copy."""
    graph = {
        "frame": {"size": list(size)},
        "resources": {"aliased": {"format": "rgba8"}},
        "passes": {
            "paint": paint("aliased", uniforms=uniforms),
            "smooth": {"node": "fxaa", "read": {"color": "aliased"}, "write": {"color": "image"}, "set": settings},
        },
        "outputs": {"image": {"file": "image.png"}},
    }
    return run_graph(folder, graph, {"paint.frag": shader}, captures=("aliased",))


def test_one_draw() -> None:
    image = TextureDesc("rgba8", 8, 8)
    (step,) = build_node("fxaa", {}, {"color": image}, {"color": image}).subpasses
    assert [(a.resource, a.usage) for a in step.accesses] == [("out_color", Usage.COLOR), ("in_color", Usage.SAMPLED)]


def test_coverage_is_exact() -> None:
    # The line y = x / 2 through 2 x 1 texels: a triangle of area 1/4, then a trapezium of 3/4.
    np.testing.assert_allclose(reference.coverage(1, 2, 0.5, 0.0), [[0.25, 0.75]], atol=1e-15)
    # Against brute force, 256 x 256 samples a texel.
    fine = reference.aliased(8 * 256, 8 * 256, 0.37, 2.2 * 256).reshape(8, 256, 8, 256).mean(axis=(1, 3))
    np.testing.assert_allclose(reference.coverage(8, 8, 0.37, 2.2), fine, atol=3e-3)


@pytest.mark.gpu
@pytest.mark.parametrize("size", [(64, 48), (1, 1), (1, 5), (5, 1)])
def test_constant_image_is_unchanged(device: Device, tmp_path: Path, size: tuple[int, int]) -> None:
    result = filtered(tmp_path, FLAT, {"edge_threshold": 0.0, "edge_minimum": 0.0, "subpixel": 1.0}, size)
    np.testing.assert_array_equal(result.images["image"], result.captures["aliased"])


@pytest.mark.gpu
def test_edges_below_the_threshold_are_unchanged(device: Device, tmp_path: Path) -> None:
    result = filtered(tmp_path, HALF_PLANE, {"edge_threshold": 1.0}, u_slope=0.1, u_offset=11.2, u_contrast=1)
    np.testing.assert_array_equal(result.images["image"], result.captures["aliased"])


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("shader", "settings"),
    [
        (NOISE, {}),
        (NOISE, {"subpixel": 0.0, "search_steps": 32, "edge_threshold": 0.3}),
        (HALF_PLANE, {"subpixel": 1.0, "search_steps": 5}),
    ],
)
def test_equals_float64(
    device: Device, hardware: Hardware, tmp_path: Path, shader: str, settings: dict[str, Any]
) -> None:
    uniforms = {"u_slope": 0.13, "u_offset": 7.7, "u_contrast": 1.0} if shader is HALF_PLANE else {}
    result = filtered(tmp_path, shader, settings, (64, 40), **uniforms)
    source = result.captures["aliased"][..., :3] / 255.0
    got = result.images["image"] / 255.0
    want = reference.resolve(source, reference.Settings(**settings))
    assert np.abs(got[..., :3] - want).max() * 255 < hardware.rounding + 0.01
    np.testing.assert_array_equal(result.images["image"][..., 3], result.captures["aliased"][..., 3])
    # The twin: other knobs are told apart.
    other = reference.resolve(source, reference.Settings(**{**settings, "search_steps": 1, "subpixel": 0.4}))
    assert np.abs(got[..., :3] - other).max() * 255 > 1.0


MIDDLE = (slice(8, -8), slice(64, -64))  # away from the border, where edges are cut off


def rmse(folder: Path, contrast: float, **settings: float) -> float:
    """Root mean square error of filtered edges against exact coverage."""
    squares = []
    for slope, offset in EDGES:
        uniforms = {"u_slope": slope, "u_offset": offset, "u_contrast": contrast}
        result = filtered(folder, HALF_PLANE, {"subpixel": 0.0, **settings}, **uniforms)
        truth = 1.0 - contrast + contrast * reference.coverage(HEIGHT, WIDTH, slope, offset)
        squares.append((result.images["image"][..., 0] / 255.0 - truth)[MIDDLE] ** 2)
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.gpu
def test_error_falls_with_the_search(device: Device, tmp_path: Path) -> None:
    squares = [
        (reference.aliased(HEIGHT, WIDTH, s, o) - reference.coverage(HEIGHT, WIDTH, s, o))[MIDDLE] ** 2
        for s, o in EDGES
    ]
    errors = [float(np.sqrt(np.mean(squares))), *(rmse(tmp_path, 1.0, search_steps=n) for n in (1, 4, 8, 16))]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.6 * errors[0]


@pytest.mark.gpu
@pytest.mark.parametrize("knob", ["edge_threshold", "edge_minimum"])
def test_error_of_faint_edges_falls_with_the_thresholds(device: Device, tmp_path: Path, knob: str) -> None:
    other = "edge_minimum" if knob == "edge_threshold" else "edge_threshold"
    high, low = (rmse(tmp_path, 0.2, **{knob: value, other: 0.0}) for value in (0.5, 0.1))
    assert low < 0.7 * high
