"""Buffers: content, ranges, clears, copies, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.device.buffers import (
    clear_buffer,
    copy_buffer,
    create_buffer,
    poison_buffer,
    read_buffer,
)
from rendergraph.device.context import Device
from rendergraph.document.messages import RenderGraphError


def test_content_survives(device: Device) -> None:
    data = bytes(range(77))
    before = device.counters.snapshot()
    buffer = create_buffer(device, data, "bytes")
    assert (device.counters - before).bytes_uploaded == 77
    assert read_buffer(device, buffer) == data
    assert read_buffer(device, buffer, 10, 5) == data[10:15]
    device.delete_object("glDeleteBuffers", buffer.glo)
    array = create_buffer(device, np.arange(6, dtype=np.float32).reshape(2, 3)[:, ::-1], "array")
    assert np.frombuffer(read_buffer(device, array), np.float32).tolist() == [2, 1, 0, 5, 4, 3]
    device.delete_object("glDeleteBuffers", array.glo)


def test_a_buffer_of_a_size_is_zero_and_uploads_nothing(device: Device) -> None:
    before = device.counters.snapshot()
    buffer = create_buffer(device, 35, "empty")
    assert read_buffer(device, buffer) == bytes(35)
    assert (device.counters - before).bytes_uploaded == 0
    device.delete_object("glDeleteBuffers", buffer.glo)


def test_ranges_stay_within_themselves(device: Device) -> None:
    heap = create_buffer(device, 1024, "heap")
    inner = heap.range(256, 100, "inner").range(4, 8, "innermost")
    clear_buffer(device, inner.range(4, 4, "half"), 0x01010101)
    clear_buffer(device, heap.range(512, 7, "odd"), 0xAABBCCDD)
    content = read_buffer(device, heap)
    assert content[256:272] == bytes(8) + b"\x01" * 4 + bytes(4)
    assert content[512:520] == b"\xdd\xcc\xbb\xaa" + b"\xdd" * 3 + b"\x00"
    assert sum(content) == 4 + 0xDD + 0xCC + 0xBB + 0xAA + 3 * 0xDD
    with pytest.raises(RenderGraphError) as caught:
        heap.range(1000, 25, "beyond")
    assert caught.value.diagnostics[0].code == "RG525"
    device.delete_object("glDeleteBuffers", heap.glo)


def test_poison_is_nan_and_all_ones(device: Device) -> None:
    buffer = create_buffer(device, 64, "poisoned")
    poison_buffer(device, buffer)
    content = read_buffer(device, buffer)
    assert np.isnan(np.frombuffer(content, np.float32)).all()
    assert (np.frombuffer(content, np.uint32) == 0xFFFFFFFF).all()
    device.delete_object("glDeleteBuffers", buffer.glo)


def test_copies_between_ranges(device: Device) -> None:
    source, destination = create_buffer(device, bytes(range(32)), "from"), create_buffer(device, 64, "to")
    copy_buffer(device, source.range(8, 16, "part"), destination.range(32, 32, "half"), 16)
    assert read_buffer(device, destination) == bytes(32) + bytes(range(8, 24)) + bytes(16)
    device.delete_object("glDeleteBuffers", source.glo)
    device.delete_object("glDeleteBuffers", destination.glo)


def test_what_does_not_fit_is_refused(device: Device) -> None:
    buffer, other = create_buffer(device, 16, "small"), create_buffer(device, 64, "large")
    for attempt in (
        lambda: read_buffer(device, buffer, 9, 8),
        lambda: read_buffer(device, buffer, -1, 4),
        lambda: copy_buffer(device, other, buffer, 17),
        lambda: copy_buffer(device, buffer, other, 17),
        lambda: create_buffer(device, 0, "none"),
        lambda: create_buffer(device, b"", "none"),
    ):
        with pytest.raises(RenderGraphError) as caught:
            attempt()
        assert caught.value.diagnostics[0].code == "RG525"
    device.delete_object("glDeleteBuffers", buffer.glo)
    device.delete_object("glDeleteBuffers", other.glo)


def test_moderngl_sees_the_bytes(device: Device) -> None:
    buffer = create_buffer(device, b"rendergraph!", "shared")
    seen = device.ctx.external_buffer(buffer.glo, buffer.bytes)
    assert seen.glo == buffer.glo
    assert seen.size == 12
    device.delete_object("glDeleteBuffers", buffer.glo)
