"""Samplers: what each filter and wrap mode returns, and shadow comparison under both depth conventions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rendergraph.device.context import Device
from rendergraph.device.samplers import sampler
from rendergraph.device.textures import clear_texture, create_texture, create_view, destroy_texture, upload_texture
from rendergraph.plan.graph import TextureDesc

SAMPLE = "uniform sampler2D u_in;\nvoid main() {{ o_color = textureLod(u_in, vec2({u}, {v}), {lod}); }}"


@pytest.fixture
def ramp(device: Device):
    """Two texels wide, one high, two mips: 0 and 1, then 5."""
    texture = create_texture(device, TextureDesc("r32f", 2, 1, mips=2), "ramp")
    upload_texture(device, texture, np.array([[[0.0], [1.0]]], np.float32))
    upload_texture(device, texture, np.array([[[5.0]]], np.float32), mip=1)
    yield texture
    destroy_texture(device, texture)


@pytest.mark.parametrize(
    ("filter", "wrap", "u", "lod", "right"),
    [
        ("nearest", "clamp", 0.45, 0.0, 0.0),
        ("nearest", "clamp", 0.55, 0.0, 1.0),
        ("nearest", "clamp", 0.55, 1.0, 1.0),  # lower mips are seen by mipmap alone
        ("linear", "clamp", 0.5, 0.0, 0.5),
        ("linear", "clamp", 0.5, 1.0, 0.5),
        ("mipmap", "clamp", 0.5, 1.0, 5.0),
        ("mipmap", "clamp", 0.5, 0.5, 2.75),
        ("nearest", "clamp", 1.25, 0.0, 1.0),
        ("nearest", "repeat", 1.25, 0.0, 0.0),
        ("nearest", "border", 1.25, 0.0, 0.0),
        ("linear", "repeat", 1.0, 0.0, 0.5),
    ],
)
def test_filters_and_wraps(
    device: Device, ramp, shade, filter: str, wrap: str, u: float, lod: float, right: float
) -> None:
    picture = shade(SAMPLE.format(u=u, v=0.5, lod=lod), {"u_in": (ramp, sampler(device, filter, wrap, True))})
    assert picture[..., 0] == pytest.approx(right, abs=1 / 256)


@pytest.mark.parametrize(("reversed_depth", "nearer", "farther"), [(True, 0.6, 0.4), (False, 0.4, 0.6)])
@pytest.mark.parametrize("format", ["d32f", "d24", "d16", "d32fs8", "d24s8"])
def test_compare_is_lit_where_not_farther(
    device: Device, shade, format: str, reversed_depth: bool, nearer: float, farther: float
) -> None:
    depth = create_texture(device, TextureDesc(format, 4, 4), "shadow")
    clear_texture(device, depth, (0.5, 0.0, 0.0, 0.0))
    compare = sampler(device, "compare", "border", reversed_depth)
    body = (
        "uniform sampler2DShadow u_in;\nvoid main() {"
        f" o_color = vec4(texture(u_in, vec3(0.5, 0.5, {nearer})), texture(u_in, vec3(0.5, 0.5, {farther})),"
        f" texture(u_in, vec3(0.5, 0.5, 0.5)), texture(u_in, vec3(3.0, 0.5, {farther}))); }}"
    )
    picture = shade(body, {"u_in": (depth, compare)})
    destroy_texture(device, depth)
    assert picture[0, 0, 0] == 1.0
    assert picture[0, 0, 1] == 0.0
    if format in ("d32f", "d32fs8"):  # 0.5 is not a unorm depth exactly
        assert picture[0, 0, 2] == 1.0
    assert picture[0, 0, 3] == 1.0, "outside a border is the far plane: lit"


def test_compare_filters_the_results_not_the_depths(device: Device, shade) -> None:
    depth = create_texture(device, TextureDesc("d32f", 2, 1), "shadow")
    upload_texture(device, depth, np.array([[[0.1], [0.9]]], np.float32))
    body = "uniform sampler2DShadow u_in;\nvoid main() { o_color = vec4(texture(u_in, vec3(0.4, 0.5, 0.2))); }"
    picture = shade(body, {"u_in": (depth, sampler(device, "compare", "clamp", True))})
    destroy_texture(device, depth)
    # 0.4 is 0.3 of the way from the first texel's centre to the second's; only the first one is lit.
    assert picture[0, 0, 0] == pytest.approx(0.7, abs=1 / 128)


def test_stencil_and_depth_sampled_at_once(device: Device, shade) -> None:
    texture = create_texture(device, TextureDesc("d32fs8", 4, 4), "both")
    clear_texture(device, texture, (0.25, 9.0, 0.0, 0.0))
    stencil = create_view(device, texture, replace(texture.desc), "stencil", stencil=True)
    nearest = sampler(device, "nearest", "clamp", True)
    body = (
        "uniform sampler2D u_depth;\nuniform usampler2D u_stencil;\n"
        "void main() { o_color = vec4(texture(u_depth, v_uv).r, float(texture(u_stencil, v_uv).r), 0, 0); }"
    )
    picture = shade(body, {"u_depth": (texture, nearest), "u_stencil": (stencil, nearest)})
    destroy_texture(device, stencil)
    destroy_texture(device, texture)
    assert tuple(picture[1, 1, :2]) == (0.25, 9.0)


def test_samplers_are_made_once(device: Device) -> None:
    first = sampler(device, "linear", "repeat", True)
    before = device.counters.snapshot()
    assert sampler(device, "linear", "repeat", False) == first, "depth convention matters to compare alone"
    assert sampler(device, "compare", "clamp", True) != sampler(device, "compare", "clamp", False)
    assert sampler(device, "linear", "repeat", True) == first
    assert (device.counters - before).objects_created <= 2
