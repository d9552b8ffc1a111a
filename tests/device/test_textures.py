"""Textures: every format holds what it is told, views share bytes, bad shapes are refused with a reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rendergraph.device.context import Device
from rendergraph.device.texels import transfer
from rendergraph.device.texture_rules import level_size
from rendergraph.device.textures import (
    Texture,
    clear_texture,
    copy_texture,
    create_texture,
    create_view,
    destroy_texture,
    generate_mips,
    poison_texture,
    read_texture,
    upload_texture,
)
from rendergraph.document.formats import COLOUR, FORMATS, STENCIL, Channel
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.graph import Target, TextureDesc

VALUE = (0.2, 0.4, 0.6, 1.0)
ALL = sorted(FORMATS)


@pytest.fixture
def make(device: Device):
    """Creates textures that are deleted after the test."""
    made: list[Texture] = []

    def create(format: str, width: int = 6, height: int = 4, label: str = "test", **fields) -> Texture:
        made.append(create_texture(device, TextureDesc(format, width, height, **fields), label))
        return made[-1]

    yield create
    for texture in made:
        destroy_texture(device, texture)


def expected(format: str, value: tuple[float, ...]) -> tuple[np.ndarray, float]:
    """What reading a cleared texel must give, and the format's quantisation step in the units read."""
    row = FORMATS[format]
    given = np.array(value[: row.channels], dtype=np.float64)
    if row.depth:
        return np.array([value[0]]), {"d16": 1 / 65535, "d24": 1 / (2**24 - 1), "d24s8": 1 / (2**24 - 1)}.get(
            format, 2.0**-24
        )
    if row.channel in (Channel.UINT, Channel.INT):
        return np.trunc(given), 0.0
    if format == "rgb10_a2":
        return given, 1 / 1023
    if row.channel in (Channel.UNORM, Channel.SNORM):
        bits = row.texel_bytes // row.channels * 8 - (row.channel is Channel.SNORM)
        return given * (2**bits - 1), 1.0
    mantissa = 5 if format == "r11g11b10f" else 10 if "16f" in format else 23
    return given, 2.0**-mantissa


@pytest.mark.parametrize("format", ALL)
def test_clear_reads_back(device: Device, make, format: str) -> None:
    row = FORMATS[format]
    whole = row.channel in (Channel.UINT, Channel.INT)
    value = (3.0, 2.0, 1.0, 1.0) if whole else VALUE
    texture = make(format)
    clear_texture(device, texture, value)
    got = read_texture(device, texture)
    right, step = expected(format, value)
    assert got.shape == (4, 6, transfer(format).channels)
    assert np.abs(got - right).max() <= step
    # The known-bad twin: one step beside the tolerance must be seen.
    assert np.abs(got - (right + 2.1 * step + (step == 0) * 1e-3)).max() > step


@pytest.mark.parametrize("format", sorted(COLOUR))
def test_upload_reads_back_bit_for_bit(device: Device, make, format: str) -> None:
    layout = transfer(format)
    texture = make(format)
    random = np.random.default_rng(1)
    if format == "rgb10_a2ui":
        data = random.integers(0, [1024, 1024, 1024, 4], (4, 6, 4)).astype(layout.dtype)
    elif np.dtype(layout.dtype).kind == "f":
        # Values all of these formats hold exactly: few mantissa bits; 0 and 1 for the packed unorm one.
        choice = [0.0, 1.0] if format == "rgb10_a2" else [0.0, 0.5, 1.0, 1.25, 96.0]
        data = random.choice(choice, (4, 6, layout.channels)).astype(layout.dtype)
    else:
        info = np.iinfo(layout.dtype)
        data = random.integers(info.min, info.max, (4, 6, layout.channels), dtype=layout.dtype, endpoint=True)
        if "snorm" in format:  # the lowest integer and its neighbour both mean -1
            data = np.maximum(data, info.min + 1)
    before = device.counters.bytes_uploaded
    upload_texture(device, texture, data)
    assert device.counters.bytes_uploaded - before == data.nbytes
    got = read_texture(device, texture)
    assert got.dtype == data.dtype
    np.testing.assert_array_equal(got, data)


def test_negative_values_survive_signed_formats(device: Device, make) -> None:
    for format, right in (("r8_snorm", -127), ("rg16_snorm", -32767), ("r16f", -1.0)):
        texture = make(format)
        clear_texture(device, texture, (-1.0, -1.0, -1.0, -1.0))
        assert (read_texture(device, texture) == right).all()
    integer = make("r32i")
    clear_texture(device, integer, (-5.0, 0.0, 0.0, 0.0))
    assert (read_texture(device, integer) == -5).all()


@pytest.mark.parametrize("format", sorted(STENCIL))
def test_stencil_reads_back(device: Device, make, format: str) -> None:
    texture = make(format)
    clear_texture(device, texture, (0.5, 77.0, 0.0, 0.0))
    stencil = read_texture(device, texture, aspect="stencil")
    assert stencil.dtype == np.uint8
    assert (stencil == 77).all()
    assert np.abs(read_texture(device, texture) - 0.5).max() < 1e-6


@pytest.mark.parametrize("format", ALL)
def test_poison_cannot_be_mistaken(device: Device, make, format: str) -> None:
    texture = make(format)
    clear_texture(device, texture, (0.0, 0.0, 0.0, 0.0))
    poison_texture(device, texture)
    got = read_texture(device, texture)
    row = FORMATS[format]
    if row.channel is Channel.FLOAT:
        assert np.isnan(got).all()
    elif row.depth:
        assert np.abs(got - 0.37).max() < 1e-4
    elif format == "rgb10_a2":
        assert (got == 1.0).all()
    elif format == "rgb10_a2ui":
        assert (got == [1023, 1023, 1023, 3]).all()
    else:
        assert (got == np.iinfo(got.dtype).max).all()


@pytest.mark.parametrize(
    ("target", "layers"),
    [(Target.D2, 1), (Target.D2_ARRAY, 3), (Target.CUBE, 6), (Target.CUBE_ARRAY, 12), (Target.D3, 4)],
)
def test_every_target_keeps_layers_and_mips_apart(device: Device, make, target: Target, layers: int) -> None:
    texture = make("r32f", 8, 8, layers=layers, mips=3, target=target)
    for mip in range(3):
        width, height, depth = level_size(texture.desc, mip)
        for layer in range(depth):
            at = layer if texture.layered else None
            data = np.full((height, width, 1), 100 * mip + layer, np.float32)
            data[0, 0, 0] = -1.0
            upload_texture(device, texture, data, mip=mip, layer=at)
    for mip in range(3):
        depth = level_size(texture.desc, mip)[2]
        whole = read_texture(device, texture, mip)
        for layer in range(depth):
            one = read_texture(device, texture, mip, layer) if texture.layered else whole
            assert one[0, 0, 0] == -1.0
            assert (one.reshape(-1)[1:] == 100 * mip + layer).all()
            if texture.layered:
                np.testing.assert_array_equal(whole[layer], one)


def test_clear_of_one_layer_and_mip_leaves_the_others(device: Device, make) -> None:
    texture = make("rgba8", 8, 8, layers=3, mips=2, target=Target.D2_ARRAY)
    clear_texture(device, texture, (0.0, 0.0, 0.0, 0.0))
    clear_texture(device, texture, (1.0, 1.0, 1.0, 1.0), mip=1, layer=2)
    assert (read_texture(device, texture, 1)[2] == 255).all()
    assert not read_texture(device, texture, 1)[:2].any()
    assert not read_texture(device, texture, 0).any()


def test_views_share_bytes(device: Device, make) -> None:
    storage = make("rgba8")
    view = create_view(device, storage, replace(storage.desc, format="r32ui"), "as words")
    upload_texture(device, view, np.full((4, 6, 1), 0x04030201, np.uint32))
    np.testing.assert_array_equal(read_texture(device, storage)[2, 3], [1, 2, 3, 4])
    destroy_texture(device, view)


def test_every_view_class_views_all_its_members(device: Device, make) -> None:
    for row in FORMATS.values():
        storage = make(row.name)
        for other in FORMATS.values():
            desc = replace(storage.desc, format=other.name)
            if other.view_class == row.view_class:
                destroy_texture(device, create_view(device, storage, desc, "view"))
            else:
                with pytest.raises(RenderGraphError) as caught:
                    create_view(device, storage, desc, "view")
                assert caught.value.diagnostics[0].code == "RG522"


def test_view_of_one_mip_and_layer(device: Device, make) -> None:
    storage = make("r32f", 8, 8, layers=3, mips=2, target=Target.D2_ARRAY)
    for layer in range(3):
        upload_texture(device, storage, np.full((4, 4, 1), layer, np.float32), mip=1, layer=layer)
    view = create_view(device, storage, TextureDesc("r32f", 4, 4), "slice", mip=1, layer=2)
    assert (read_texture(device, view) == 2.0).all()
    destroy_texture(device, view)


def test_a_view_outlives_its_storage(device: Device, make) -> None:
    storage = create_texture(device, TextureDesc("r32f", 4, 4), "storage")
    clear_texture(device, storage, (7.0, 0.0, 0.0, 0.0))
    view = create_view(device, storage, storage.desc, "view")
    destroy_texture(device, storage)
    assert (read_texture(device, view) == 7.0).all()
    destroy_texture(device, view)


@pytest.mark.parametrize(
    ("change", "mip", "layer"),
    [
        ({"width": 4}, 0, 0),
        ({"mips": 2}, 1, 0),
        ({"layers": 2}, 0, 2),
        ({"samples": 4}, 0, 0),
        ({"target": Target.D3}, 0, 0),
    ],
)
def test_impossible_views_are_refused(device: Device, make, change: dict, mip: int, layer: int) -> None:
    storage = make("r32f", 8, 8, layers=3, mips=2, target=Target.D2_ARRAY)
    with pytest.raises(RenderGraphError) as caught:
        create_view(device, storage, replace(storage.desc, **change), "bad", mip=mip, layer=layer)
    assert caught.value.diagnostics[0].code == "RG522"


@pytest.mark.parametrize(
    "desc",
    [
        TextureDesc("rgba8", 0, 4),
        TextureDesc("rgba8", 1 << 20, 4),
        TextureDesc("rgba8", 4, 4, mips=4),
        TextureDesc("rgba8", 4, 4, layers=1 << 20, target=Target.D2_ARRAY),
        TextureDesc("rgba8", 4, 4, samples=1024),
        TextureDesc("rgba8", 4, 4, samples=4, mips=2),
        TextureDesc("rgba8", 8, 4, layers=6, target=Target.CUBE),
        TextureDesc("rgba8", 4, 4, layers=7, target=Target.CUBE_ARRAY),
        TextureDesc("rgba8", 4, 4, layers=12, target=Target.CUBE),
        TextureDesc("rgba8", 4, 4, layers=2),
        TextureDesc("d32f", 4, 4, layers=4, target=Target.D3),
    ],
)
def test_impossible_textures_are_refused_and_leave_nothing(device: Device, desc: TextureDesc) -> None:
    before = dict(device.owned)
    with pytest.raises(RenderGraphError) as caught:
        create_texture(device, desc, "bad")
    assert caught.value.diagnostics[0].code == "RG520"
    assert caught.value.diagnostics[0].data["label"] == "bad"
    assert device.owned == before


def test_out_of_memory_says_so(device: Device) -> None:
    if not device.info.is_software:
        pytest.skip("only the software rasteriser refuses at once")
    with pytest.raises(RenderGraphError) as caught:
        create_texture(device, TextureDesc("rgba32f", 16384, 16384, 64, target=Target.D2_ARRAY), "huge")
    assert caught.value.diagnostics[0].code == "RG521"
    device.check()


@pytest.mark.parametrize(
    "data", [np.zeros((4, 6, 3), np.uint8), np.zeros((4, 6, 4), np.float32), np.zeros((6, 4, 4), np.uint8)]
)
def test_upload_of_another_shape_or_dtype_is_refused(device: Device, make, data: np.ndarray) -> None:
    with pytest.raises(RenderGraphError) as caught:
        upload_texture(device, make("rgba8"), data)
    assert caught.value.diagnostics[0].code == "RG524"


def test_upload_accepts_a_flipped_view_of_an_array(device: Device, make) -> None:
    texture = make("r32f")
    data = np.arange(24, dtype=np.float32).reshape(4, 6, 1)
    upload_texture(device, texture, data[::-1])
    np.testing.assert_array_equal(read_texture(device, texture), data[::-1])


@pytest.mark.parametrize(("format", "value"), [("rgba16f", VALUE), ("r32ui", (9.0, 0.0, 0.0, 0.0)), ("d32f", VALUE)])
@pytest.mark.parametrize("layers", [1, 2])
def test_multisampled_textures_clear_and_read(
    device: Device, make, format: str, value: tuple[float, ...], layers: int
) -> None:
    target = Target.D2_ARRAY if layers > 1 else Target.D2
    texture = make(format, samples=4, layers=layers, target=target)
    clear_texture(device, texture, value)
    right, step = expected(format, value)
    got = read_texture(device, texture, layer=layers - 1 if layers > 1 else None)
    assert np.abs(got - right).max() <= max(step, 1e-6)


def test_mips_and_copies(device: Device, make) -> None:
    texture = make("r32f", 4, 4, mips=3)
    upload_texture(device, texture, np.arange(16, dtype=np.float32).reshape(4, 4, 1))
    generate_mips(device, texture)
    assert read_texture(device, texture, 2)[0, 0, 0] == pytest.approx(7.5)
    assert read_texture(device, texture, 1)[0, 0, 0] == pytest.approx(2.5)
    other = make("r32ui", 4, 4, mips=3)
    copy_texture(device, texture, other)
    assert read_texture(device, other, 2).view(np.float32)[0, 0, 0] == pytest.approx(7.5)


def test_creating_and_deleting_is_counted_and_owned(device: Device) -> None:
    before = device.counters.snapshot()
    texture = create_texture(device, TextureDesc("r8", 4, 4), "counted")
    assert (device.counters - before).objects_created == 1
    assert device.owned["glDeleteTextures", texture.glo] == "counted"
    assert device.gl.glIsTexture(texture.glo)
    destroy_texture(device, texture)
    assert not device.gl.glIsTexture(texture.glo)
    assert ("glDeleteTextures", texture.glo) not in device.owned
