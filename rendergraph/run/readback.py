"""Reads resources back as arrays."""

from __future__ import annotations

import numpy as np

from rendergraph.device import enums
from rendergraph.device.buffers import read_buffer
from rendergraph.device.context import Device
from rendergraph.device.textures import read_texture
from rendergraph.run.allocation import Allocation
from rendergraph.run.result import Pixels


def read_resource(
    device: Device, storage: Allocation, name: str, frame: int, *, mip: int = 0, aspect: str = "color"
) -> Pixels:
    """A texture's mip as ``[height, width, channels]`` (the layers of an array side by side), a buffer as
    ``float32[1, words, 1]``; rows bottom-up. ``aspect`` ``"stencil"``: uint8 stencil of a depth-stencil texture.
    """
    # No sub-pass of the plan reads this: shader stores are made visible to the transfer here.
    device.gl.glMemoryBarrier(enums.TEXTURE_UPDATE_BARRIER_BIT | enums.BUFFER_UPDATE_BARRIER_BIT)
    if not storage.is_texture(name):
        data = read_buffer(device, storage.buffer(name, frame))
        return np.frombuffer(data, dtype=np.float32).reshape(1, -1, 1)
    pixels = read_texture(device, storage.texture(name, frame), mip, aspect=aspect)
    if pixels.ndim == 4:
        return np.concatenate(list(pixels), axis=1)
    return pixels
