"""Pipeline-statistics queries (GL_ARB_pipeline_statistics_query): what a device itself counts in a stretch of work."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.context import Device

EXTENSION: Final = "GL_ARB_pipeline_statistics_query"  # core from 4.6 on; 4.5 contexts offer it by name
_COUNTED: Final = {
    "vertices": e.VERTICES_SUBMITTED,
    "primitives": e.PRIMITIVES_SUBMITTED,
    "primitives_clipped": e.CLIPPING_OUTPUT_PRIMITIVES,
    "vertex_invocations": e.VERTEX_SHADER_INVOCATIONS,
    "fragments": e.FRAGMENT_SHADER_INVOCATIONS,
    "compute_invocations": e.COMPUTE_SHADER_INVOCATIONS,
}


def has_statistics(device: Device) -> bool:
    """Whether the driver counts."""
    return EXTENSION in device.info.extensions


def count_statistics(device: Device, work: Callable[[], None]) -> dict[str, int] | None:
    """What the device counts while ``work`` runs, waited for; ``None`` where it does not count.

    ``vertices`` and ``primitives`` as submitted, ``primitives_clipped`` as left after clipping, and invocations of the
    vertex, fragment (``fragments``) and compute shaders. Drivers may shade more fragments than are covered: whole
    quads or blocks (llvmpipe: 4x4).
    """
    if not has_statistics(device):
        work()
        return None
    gl = device.gl
    # Mesa's glCreateQueries refuses these targets; a name made by glGenQueries gets its target when it is begun.
    queries = {name: gl.create("glGenQueries") for name in _COUNTED}
    try:
        for name, query in queries.items():
            gl.glBeginQuery(_COUNTED[name], query)
        try:
            work()
        finally:
            for name in queries:
                gl.glEndQuery(_COUNTED[name])
        device.finish()
        return {name: _result(device, query) for name, query in queries.items()}
    finally:
        for query in queries.values():
            gl.delete("glDeleteQueries", query)


def _result(device: Device, query: int) -> int:
    value = ctypes.c_uint64()
    device.gl.glGetQueryObjectui64v(query, e.QUERY_RESULT, ctypes.byref(value))
    return value.value
