"""Tone curves and dither against float64, over 24 stops and everything that is no number."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from graph_run import RADIANCE, build_node, paint, run_graph

from rendergraph.device.context import Device
from rendergraph.document.messages import RenderGraphError
from rendergraph.node.builder import Builder
from rendergraph.nodes.tonemap import reference
from rendergraph.plan.graph import BufferDesc, TextureDesc, Usage
from rendergraph.run.result import FrameResult

if TYPE_CHECKING:
    from tests.conftest import Hardware

CURVES = ("agx", "aces", "reinhard", "linear")


def built(
    params: dict[str, Any], format: str = "rgba8", inputs: dict[str, TextureDesc | BufferDesc] | None = None
) -> Builder:
    """A tonemap pass on a 64 x 64 image."""
    hdr = TextureDesc("rgba16f", 64, 64)
    return build_node("tonemap", params, {"color": hdr, **(inputs or {})}, {"color": TextureDesc(format, 64, 64)})


def mapped(folder: Path, params: dict[str, Any], format: str = "rgba32f", shader: str = RADIANCE) -> FrameResult:
    """A painted 64 x 48 image, tone-mapped; both are captured."""
    graph = {
        "frame": {"size": [64, 48], "seed": 77},
        "resources": {"hdr": {"format": "rgba32f"}},
        "passes": {
            "paint": paint("hdr"),
            "map": {"node": "tonemap", "read": {"color": "hdr"}, "write": {"color": "image"}, "set": params},
        },
        "outputs": {"image": {"file": "image.npy", "format": format}},
    }
    return run_graph(folder, graph, {"paint.frag": shader}, captures=("hdr",))


# ---------------------------------------------------------------- the sub-pass


@pytest.mark.parametrize("curve", CURVES)
def test_one_draw_with_the_curve_asked_for(curve: str) -> None:
    (step,) = built({"curve": curve}).subpasses
    assert step.program is not None
    assert dict(step.program.stages)["fragment"].name == f"{curve}.frag"
    assert [(a.resource, a.usage) for a in step.accesses] == [("out_color", Usage.COLOR), ("in_color", Usage.SAMPLED)]
    assert ("u_white" in step.uniforms) == (curve == "reinhard")


def test_exposure_buffer_is_read_only_where_connected() -> None:
    (step,) = built({}, inputs={"exposure": BufferDesc(16)}).subpasses
    assert ("in_exposure", Usage.STORAGE_READ) in [(a.resource, a.usage) for a in step.accesses]
    assert step.program is not None
    assert ("METERED", "1") in step.program.defines


def test_exposure_buffer_too_small() -> None:
    with pytest.raises(RenderGraphError) as raised:
        built({}, inputs={"exposure": BufferDesc(12)})
    assert raised.value.diagnostics[0].code == "RG225"


@pytest.mark.parametrize(("format", "step"), [("rgba8", 1 / 255), ("rgb10_a2", 1 / 1023), ("rgba16f", None)])
def test_dither_is_one_step_of_the_output(format: str, step: float | None) -> None:
    (draw,) = built({"dither": "ordered"}, format).subpasses
    assert draw.uniforms.get("u_step") == step
    assert draw.program is not None
    assert dict(draw.program.defines)["DITHER"] == ("0" if step is None else "1")


# ---------------------------------------------------------------- the curves


def test_sigmoid_meets_its_ends_and_its_slope() -> None:
    pivot = 20 / 33
    x = np.array([0.0, pivot, 1.0, pivot - 1e-6, pivot + 1e-6])
    y = reference.agx_sigmoid(x)
    np.testing.assert_allclose(y[:3], [0.0, 0.5, 1.0], atol=1e-12)
    assert (y[4] - y[3]) / 2e-6 == pytest.approx(2.0, rel=1e-6)


@pytest.mark.gpu
@pytest.mark.parametrize("curve", CURVES)
def test_curve_equals_float64(device: Device, tmp_path: Path, curve: str) -> None:
    result = mapped(tmp_path, {"curve": curve, "ev": 1.5, "white": 3.0, "dither": "none"})
    got, source = result.images["image"], result.captures["hdr"]
    assert np.isnan(source).any()
    assert np.isposinf(source).any()
    want = reference.tonemap(source, curve, gain=2.0**1.5, white=3.0)
    assert np.abs(got[..., :3] - want).max() < 2e-5
    assert (got[..., 3] == 1.0).all()
    # The twin: half a percent more exposure is told apart.
    assert np.abs(got[..., :3] - reference.tonemap(source, curve, gain=2.0**1.5 * 1.005, white=3.0)).max() > 2e-4


@pytest.mark.gpu
@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("ev", [-32, 32])
def test_extreme_exposures_stay_in_range(device: Device, tmp_path: Path, curve: str, ev: float) -> None:
    got = mapped(tmp_path, {"curve": curve, "ev": ev}).images["image"]
    assert np.isfinite(got).all()
    assert got.min() >= 0.0
    assert got.max() <= 1.0
    assert got[0, 4, :3].max() < 0.01  # black stays black
    assert got[0, 0, :3].max() < 0.01  # NaN counts as black
    assert got[0, 1, :3].min() > 0.99  # infinity is white


# ---------------------------------------------------------------- dither

RAMP = """\
#version 450
in vec2 v_uv;
out vec4 color;
void main() {
    float shade = (gl_FragCoord.x - 0.5) / 63.0;
    color = vec4(vec3(shade * shade * shade), 1.0);
}
"""


@pytest.mark.gpu
@pytest.mark.parametrize("dither", ["ordered", "triangular"])
def test_dithered_bytes_equal_float64(device: Device, hardware: Hardware, tmp_path: Path, dither: str) -> None:
    result = mapped(tmp_path, {"curve": "linear", "dither": dither}, "rgba8", RAMP)
    encoded = reference.tonemap(result.captures["hdr"], "linear")
    noise = reference.ordered_noise(48, 64) if dither == "ordered" else reference.triangular_noise(48, 64, 0, 77)
    got = result.images["image"][..., :3] / 255.0
    want = reference.dither(encoded, noise, 1 / 255)
    assert np.abs(got - want).max() * 255 < hardware.rounding + 0.01  # and float32
    assert np.abs(got - encoded).max() * 255 > 0.6  # the twin: without the noise it does not fit
    assert set(np.unique(got[:, 0])) == {0.0}
    assert set(np.unique(got[:, -1])) == {1.0}


def test_noise_has_zero_mean_and_the_stated_spread() -> None:
    ordered = reference.ordered_noise(8, 8)
    assert ordered.mean() == pytest.approx(0.0, abs=1e-15)
    assert np.unique(ordered).size == 64
    triangular = reference.triangular_noise(256, 256, 3, 1)
    assert abs(triangular.mean()) < 4 * (1 / 6) ** 0.5 / triangular.size**0.5  # four standard errors
    assert triangular.var() == pytest.approx(1 / 6, rel=0.02)  # of the difference of two uniform numbers
    assert (triangular != reference.triangular_noise(256, 256, 4, 1)).mean() > 0.99
