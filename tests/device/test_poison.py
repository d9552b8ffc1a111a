"""Poison of every kind, in every format: what it should be, and never zero."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.device.buffers import create_buffer, poison_buffer, read_buffer
from rendergraph.device.context import Device
from rendergraph.device.texels import POISONS, Poison, poison_value
from rendergraph.device.textures import create_texture, destroy_texture, poison_texture, read_texture
from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import TextureDesc


@pytest.mark.gpu
@pytest.mark.parametrize("poison", POISONS)
@pytest.mark.parametrize("format", sorted(FORMATS))
def test_no_texel_is_zero(device: Device, format: str, poison: Poison) -> None:
    texture = create_texture(device, TextureDesc(format, 3, 2, mips=2), "poisoned")
    try:
        poison_texture(device, texture, poison)
        for mip in (0, 1):
            texels = read_texture(device, texture, mip)
            assert (texels != 0).all()
    finally:
        destroy_texture(device, texture)


@pytest.mark.gpu
@pytest.mark.parametrize(("poison", "value"), [("nan", np.nan), ("inf", np.inf), ("1000", 1000.0)])
def test_floats_hold_it(device: Device, poison: Poison, value: float) -> None:
    for format in ("r32f", "rgba16f"):
        texture = create_texture(device, TextureDesc(format, 2, 2), "poisoned")
        poison_texture(device, texture, poison)
        found = read_texture(device, texture)
        assert np.isnan(found).all() if np.isnan(value) else (found == value).all()
        destroy_texture(device, texture)
    buffer = create_buffer(device, 16, "poisoned")
    poison_buffer(device, buffer, poison)
    words = np.frombuffer(read_buffer(device, buffer), np.float32)
    assert np.array_equal(words, np.full(4, value, np.float32), equal_nan=True)
    device.delete_object("glDeleteBuffers", buffer.glo)


def test_kinds_differ_where_the_format_can_tell_them() -> None:
    for format, row in FORMATS.items():
        values = {repr(poison_value(format, poison)[0]) for poison in POISONS}
        assert len(values) == (3 if row.depth or row.channel.value == "float" else 1 if row.sampler else 2), format
