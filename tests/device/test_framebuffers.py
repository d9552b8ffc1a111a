"""Framebuffers: layers, mips, mixed targets, clears of every kind of format, and refusals with a reason."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.device import enums as e
from rendergraph.device.buffers import create_buffer, read_buffer
from rendergraph.device.context import Device
from rendergraph.device.framebuffers import (
    blit,
    clear_color,
    clear_depth,
    create_framebuffer,
    destroy_framebuffer,
)
from rendergraph.device.textures import Texture, clear_texture, create_texture, destroy_texture, read_texture
from rendergraph.document.formats import FORMATS
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.graph import Target, TextureDesc

RENDERABLE = sorted(f.name for f in FORMATS.values() if f.renderable and not f.depth and "snorm" not in f.name)

LAYERED_VERTEX = """
#extension GL_ARB_shader_viewport_layer_array : require
flat out int v_layer;
void main() {
    gl_Layer = v_layer = gl_InstanceID;
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0);
}
"""


@pytest.fixture
def make(device: Device):
    """Creates textures that are deleted after the test."""
    made: list[Texture] = []

    def create(format: str, width: int = 8, height: int = 8, **fields) -> Texture:
        made.append(create_texture(device, TextureDesc(format, width, height, **fields), f"{format} target"))
        return made[-1]

    yield create
    for texture in made:
        destroy_texture(device, texture)


@pytest.mark.parametrize(
    ("target", "layers"), [(Target.D2_ARRAY, 4), (Target.CUBE, 6), (Target.CUBE_ARRAY, 12), (Target.D3, 5)]
)
def test_layered_rendering_reaches_every_layer(device: Device, make, compile_text, draw, target, layers: int) -> None:
    texture = make("r32f", layers=layers, target=target)
    framebuffer = create_framebuffer(device, [(texture, 0, None)], None, "layered")
    assert framebuffer.layers == layers
    fragment = "flat in int v_layer;\nout float o_value;\nvoid main() { o_value = float(v_layer) + 1.0; }"
    draw(compile_text(vertex=LAYERED_VERTEX, fragment=fragment), framebuffer, instances=layers)
    whole = read_texture(device, texture)
    for layer in range(layers):
        assert (whole[layer] == layer + 1).all()
    destroy_framebuffer(device, framebuffer)


@pytest.mark.parametrize(("target", "layers"), [(Target.D2_ARRAY, 4), (Target.CUBE, 6)])
def test_layered_depth_without_colour(device: Device, make, compile_text, draw, target, layers: int) -> None:
    depth = make("d32f", layers=layers, target=target)
    framebuffer = create_framebuffer(device, [], (depth, None), "shadow cascades")
    clear_depth(device, framebuffer, 0.0)
    gl = device.gl
    gl.glEnable(e.DEPTH_TEST)
    gl.glDepthFunc(e.GREATER)
    draw(compile_text(vertex=LAYERED_VERTEX, fragment="void main() {}"), framebuffer, instances=layers - 1)
    gl.glDisable(e.DEPTH_TEST)
    whole = read_texture(device, depth)
    # Clip control is 0..1: z = 0.5 is stored as 0.5, not 0.75.
    assert (whole[: layers - 1] == 0.5).all()
    assert (whole[layers - 1] == 0.0).all()
    destroy_framebuffer(device, framebuffer)


def test_one_layer_and_mip(device: Device, make, shade) -> None:
    texture = make("rgba8", layers=3, mips=3, target=Target.D2_ARRAY)
    clear_texture(device, texture, (0.0, 0.0, 0.0, 0.0))
    framebuffer = create_framebuffer(device, [(texture, 1, 2)], None, "one")
    assert (framebuffer.width, framebuffer.height, framebuffer.layers) == (4, 4, 1)
    clear_color(device, framebuffer, 0, (1.0, 1.0, 1.0, 1.0))
    assert (read_texture(device, texture, 1, 2) == 255).all()
    assert not read_texture(device, texture, 1, 1).any()
    assert not read_texture(device, texture, 0).any()
    destroy_framebuffer(device, framebuffer)


@pytest.mark.parametrize("format", RENDERABLE)
def test_clear_color_writes_every_format(device: Device, make, format: str) -> None:
    texture = make(format)
    framebuffer = create_framebuffer(device, [(texture, 0, None)], None, format)
    clear_color(device, framebuffer, 0, (1.0, 1.0, 1.0, 1.0))
    got = read_texture(device, texture)
    whole = {"unorm": np.iinfo(got.dtype).max if got.dtype.kind == "u" else 1.0}.get(FORMATS[format].channel.value, 1)
    assert (got == whole).all()
    destroy_framebuffer(device, framebuffer)


def test_srgb_targets_encode_draws_and_clears(device: Device, make) -> None:
    texture = make("srgb8_a8")
    framebuffer = create_framebuffer(device, [(texture, 0, None)], None, "srgb")
    clear_color(device, framebuffer, 0, (0.2, 0.0, 1.0, 0.5))
    encoded = round((1.055 * 0.2 ** (1 / 2.4) - 0.055) * 255)
    pixel = read_texture(device, texture)[0, 0].astype(int)
    assert abs(pixel[0] - encoded) <= 1
    assert encoded != round(0.2 * 255)
    assert abs(pixel[3] - 128) <= 1
    destroy_framebuffer(device, framebuffer)


def test_depth_stencil_clears_both(device: Device, make) -> None:
    for format in ("d24s8", "d32fs8"):
        texture = make(format)
        framebuffer = create_framebuffer(device, [], (texture, None), "both")
        clear_depth(device, framebuffer, 0.25, 3)
        assert np.abs(read_texture(device, texture) - 0.25).max() < 1e-6
        assert (read_texture(device, texture, aspect="stencil") == 3).all()
        destroy_framebuffer(device, framebuffer)


def test_many_targets_in_draw_buffer_order(device: Device, make, compile_text, draw) -> None:
    targets = [make("r32f"), make("r32ui"), make("rgba16f")]
    framebuffer = create_framebuffer(device, [(t, 0, None) for t in targets], (make("d32f"), None), "gbuffer")
    fragment = (
        "layout(location = 2) out vec4 o_c;\nlayout(location = 0) out float o_a;\nlayout(location = 1) out uint o_b;\n"
        "void main() { o_a = 1.5; o_b = 7u; o_c = vec4(3.0); }"
    )
    draw(compile_text(fragment=fragment), framebuffer)
    assert [read_texture(device, t)[3, 3, 0] for t in targets] == [1.5, 7, 3.0]
    destroy_framebuffer(device, framebuffer)


def test_without_attachments_shaders_still_run(device: Device, compile_text, draw) -> None:
    framebuffer = create_framebuffer(device, [], None, "count only", size=(16, 8))
    counter = create_buffer(device, 4, "counter")
    program = compile_text(fragment="buffer Count { uint hits; };\nvoid main() { atomicAdd(hits, 1u); }")
    device.gl.glBindBufferBase(e.SHADER_STORAGE_BUFFER, program.storage_blocks["Count"].binding, counter.glo)
    draw(program, framebuffer)
    device.gl.glMemoryBarrier(e.ALL_BARRIER_BITS)
    assert int.from_bytes(read_buffer(device, counter), "little") == 16 * 8
    destroy_framebuffer(device, framebuffer)
    device.delete_object("glDeleteBuffers", counter.glo)


def test_blit_scales_converts_and_resolves(device: Device, make) -> None:
    def framebuffer_of(texture):
        return create_framebuffer(device, [(texture, 0, None)], None, texture.label)

    sharp, half, flat = make("rgba16f", samples=4), make("rgba8", 4, 4), make("rgba16f")
    clear_texture(device, sharp, (0.5, 1.0, 0.0, 1.0))
    made = [framebuffer_of(t) for t in (sharp, flat, half)]
    blit(device, made[0], made[1])
    blit(device, made[1], made[2], linear=True)
    assert tuple(read_texture(device, flat)[0, 0].astype(float)) == (0.5, 1.0, 0.0, 1.0)
    assert tuple(read_texture(device, half)[0, 0].astype(int)) in {(127, 255, 0, 255), (128, 255, 0, 255)}
    for framebuffer in made:
        destroy_framebuffer(device, framebuffer)


def refused(device: Device, colors, depth=None, size=None) -> None:
    before = dict(device.owned)
    with pytest.raises(RenderGraphError) as caught:
        create_framebuffer(device, colors, depth, "bad", size)
    assert caught.value.diagnostics[0].code == "RG523"
    assert device.owned == before
    device.check()


def test_targets_that_do_not_fit_are_refused(device: Device, make) -> None:
    color, small, samples = make("rgba8"), make("rgba8", 4, 4), make("rgba8", samples=4)
    array = make("rgba8", layers=2, target=Target.D2_ARRAY)
    refused(device, [(color, 0, None), (small, 0, None)])
    refused(device, [(color, 0, None), (samples, 0, None)])
    refused(device, [(color, 1, None)])
    refused(device, [(color, 0, 1)])
    refused(device, [(array, 0, 2)])
    refused(device, [])
    refused(device, [(color, 0, None)] * 9)
    refused(device, [(make("d32f"), 0, None)])  # depth as colour
    refused(device, [(array, 0, None), (color, 0, None)])  # layered and not
