"""Timestamp queries: nanoseconds of the device's own counter."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

from rendergraph.device import enums as e
from rendergraph.device.context import Device


def create_timestamp(device: Device) -> int:
    """A timestamp query; not counted, since it belongs to the measurement and not to the graph."""
    name = device.gl.create("glCreateQueries", e.TIMESTAMP)
    device.owned["glDeleteQueries", name] = "pass time"
    return name


def read_timestamp(device: Device, query: int) -> int:
    """A timestamp in nanoseconds, waited for; 64 bits, since 32 wrap after 4.3 s."""
    value = ctypes.c_uint64()
    device.gl.glGetQueryObjectui64v(query, e.QUERY_RESULT, ctypes.byref(value))
    return value.value


def read_timestamps(device: Device, queries: Sequence[int]) -> list[int]:
    """Several timestamps, as :func:`read_timestamp` reads one."""
    values = (ctypes.c_uint64 * len(queries))()
    read, _ = device.gl.repeated(device.gl.glGetQueryObjectui64v)
    for index, query in enumerate(queries):
        read(query, e.QUERY_RESULT, ctypes.byref(values, 8 * index))
    return list(values)


def read_available(device: Device, query: int) -> bool:
    """Whether a query's result is there."""
    value = ctypes.c_int()
    device.gl.glGetQueryObjectiv(query, e.QUERY_RESULT_AVAILABLE, ctypes.byref(value))
    return bool(value.value)


def read_device_time(device: Device) -> int:
    """The device's counter now, in nanoseconds, without waiting for the commands before."""
    value = ctypes.c_int64()
    device.gl.glGetInteger64v(e.TIMESTAMP, ctypes.byref(value))
    return value.value
