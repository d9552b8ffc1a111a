"""Copies through the host's memory: the device is waited for, its content fetched and handed back."""

from __future__ import annotations

from rendergraph.device.buffers import Buffer, read_buffer, upload_buffer
from rendergraph.device.context import Device
from rendergraph.device.textures import Texture, read_texture, upload_texture


def texture_through_host(device: Device, source: Texture, destination: Texture) -> None:
    """Copy all texels of every common mip and layer between textures of one size and format, bit for bit.

    The read waits until everything the source depends on is done; nothing else can be handed over meanwhile.
    """
    for mip in range(min(source.desc.mips, destination.desc.mips)):
        upload_texture(device, destination, read_texture(device, source, mip), mip=mip)


def buffer_through_host(device: Device, source: Buffer, destination: Buffer, bytes: int) -> None:
    """Copy the first bytes of one buffer to another; RG525 when either is smaller."""
    upload_buffer(device, destination, read_buffer(device, source, 0, bytes))
