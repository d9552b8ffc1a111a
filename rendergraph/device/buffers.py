"""Buffers of immutable size, and ranges of them."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.texels import POISON_WORDS, Poison
from rendergraph.document.messages import RenderGraphError, diagnose


@dataclass(frozen=True, slots=True)
class Buffer:
    """A buffer object, or a range of one: ``bytes`` from ``offset`` on. A range does not own the storage."""

    glo: int
    bytes: int
    label: str
    offset: int = 0

    def range(self, offset: int, bytes: int, label: str) -> Buffer:
        """A part of this buffer, for bindings and every function here.

        :raises RenderGraphError: RG525 outside this buffer.
        """
        _check(self, offset, bytes)
        return Buffer(self.glo, bytes, label, self.offset + offset)


def create_buffer(device: Device, data: int | bytes | bytearray | NDArray[Any], label: str) -> Buffer:
    """A buffer holding ``data``, or of that many zero bytes. moderngl sees it by ``ctx.external_buffer(glo, bytes)``.

    :raises RenderGraphError: RG521 out of memory, RG525 for an empty buffer.
    """
    if isinstance(data, int):
        block, size = None, data
    else:
        block = _block(data)
        size = len(block)
    if size < 1:
        raise RenderGraphError([diagnose("RG525", label=label, reason="it would be empty", bytes=size)])
    device.debug.subject = label
    glo = device.create_object("glCreateBuffers", label=label)
    device.gl.glNamedBufferStorage(glo, size, None if block is None else _pointer(block), e.DYNAMIC_STORAGE_BIT)
    device.name(e.BUFFER, glo, label)
    if not device.debug.synchronous:
        device.debug.poll()
    if texts := device.debug.take_errors():
        device.delete_object("glDeleteBuffers", glo)
        raise RenderGraphError([diagnose("RG521", label=label, bytes=size, detail="; ".join(texts))])
    buffer = Buffer(glo, size, label)
    if block is not None:
        device.counters.bytes_uploaded += size
    else:
        clear_buffer(device, buffer)
    device.debug.subject = ""
    return buffer


def upload_buffer(device: Device, buffer: Buffer, data: bytes | bytearray | NDArray[Any], offset: int = 0) -> None:
    """Overwrite bytes from ``offset`` on; RG525 when they do not fit."""
    block = _block(data)
    _check(buffer, offset, len(block))
    device.debug.subject = buffer.label
    device.gl.glNamedBufferSubData(buffer.glo, buffer.offset + offset, len(block), _pointer(block))
    device.counters.bytes_uploaded += len(block)
    device.debug.subject = ""


def read_buffer(device: Device, buffer: Buffer, offset: int = 0, bytes: int | None = None) -> bytes:
    """Bytes from ``offset`` on, to the end unless said; waits for the device."""
    count = buffer.bytes - offset if bytes is None else bytes
    _check(buffer, offset, count)
    block = np.empty(count, np.uint8)
    device.debug.subject = buffer.label
    device.gl.glGetNamedBufferSubData(buffer.glo, buffer.offset + offset, count, block.ctypes.data)
    device.debug.subject = ""
    return block.tobytes()


def clear_buffer(device: Device, buffer: Buffer, word: int = 0) -> None:
    """Repeat one 32-bit word over the buffer; bytes beyond the last whole word take the word's lowest byte."""
    device.debug.subject = buffer.label
    whole = buffer.bytes & ~3
    for format, kind, type_, start, count in (
        (e.R32UI, e.RED_INTEGER, e.UNSIGNED_INT, 0, whole),
        (e.R8UI, e.RED_INTEGER, e.UNSIGNED_BYTE, whole, buffer.bytes - whole),
    ):
        if count:
            value = ctypes.byref(ctypes.c_uint(word & 0xFFFFFFFF))
            device.gl.glClearNamedBufferSubData(buffer.glo, format, buffer.offset + start, count, kind, type_, value)
    device.debug.subject = ""


def poison_buffer(device: Device, buffer: Buffer, poison: Poison = "nan") -> None:
    """Fill with the bits of a float: NaN (0xFFFFFFFF, the largest unsigned integer too), infinity or 1000."""
    clear_buffer(device, buffer, POISON_WORDS[poison])


def copy_buffer(device: Device, source: Buffer, destination: Buffer, bytes: int) -> None:
    """Copy the first bytes of one buffer to another; RG525 when either is smaller."""
    _check(source, 0, bytes)
    _check(destination, 0, bytes)
    device.debug.subject = destination.label
    device.gl.glCopyNamedBufferSubData(source.glo, destination.glo, source.offset, destination.offset, bytes)
    device.debug.subject = ""


def _check(buffer: Buffer, offset: int, bytes: int) -> None:
    if offset < 0 or bytes < 0 or offset + bytes > buffer.bytes:
        reason = f"bytes {offset} to {offset + bytes} are outside it"
        raise RenderGraphError([diagnose("RG525", label=buffer.label, reason=reason, bytes=buffer.bytes)])


def _block(data: bytes | bytearray | NDArray[Any]) -> NDArray[np.uint8]:
    if isinstance(data, np.ndarray):
        return np.ascontiguousarray(data).reshape(-1).view(np.uint8)
    return np.frombuffer(data, np.uint8)


def _pointer(block: NDArray[np.uint8]) -> int:
    return int(block.ctypes.data)
