"""What a vertex shader of the scene may read: which input comes from where in the scene's buffers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer
from rendergraph.device.context import Device
from rendergraph.scene.gpu_layout import INSTANCE


@dataclass(frozen=True, slots=True)
class VertexInput:
    """Where an input comes from: the stream, the byte in its rows, components and columns; ``whole`` for integers."""

    stream: int
    offset: int
    components: int
    columns: int = 1
    whole: bool = False


#: Positions have a stream of their own, which is all that depth-only passes read of a vertex. ``INSTANCES`` is the row
#: of ``Instances`` that a draw command's base instance names, for all its vertices and replays.
POSITIONS, ATTRIBUTES, INSTANCES = range(3)
STRIDES = (12, 60, INSTANCE.itemsize)
VERTEX_INPUTS = {
    "in_position": VertexInput(POSITIONS, 0, 3),
    "in_normal": VertexInput(ATTRIBUTES, 0, 3),
    "in_tangent": VertexInput(ATTRIBUTES, 12, 4),
    "in_uv0": VertexInput(ATTRIBUTES, 28, 2),
    "in_uv1": VertexInput(ATTRIBUTES, 36, 2),
    "in_color": VertexInput(ATTRIBUTES, 44, 4),
    "in_world": VertexInput(INSTANCES, 0, 4, columns=4),
    "in_normal_rows": VertexInput(INSTANCES, 64, 3, columns=3),
    "in_material_flags": VertexInput(INSTANCES, 112, 2, whole=True),
}
NEVER = 2**31 - 1  # a divisor that no count of replays reaches
COLUMN_BYTES = 16


def create_vertex_array(
    device: Device, inputs: Iterable[tuple[str, int]], streams: tuple[Buffer, Buffer, Buffer], indices: Buffer
) -> int:
    """A vertex array that feeds ``inputs`` (name, first location) from the three streams; unknown names stay off."""
    gl = device.gl
    array = device.create_object("glCreateVertexArrays", label="scene vertices")
    gl.glVertexArrayElementBuffer(array, indices.glo)
    for stream, (buffer, stride) in enumerate(zip(streams, STRIDES, strict=True)):
        gl.glVertexArrayVertexBuffer(array, stream, buffer.glo, 0, stride)
    gl.glVertexArrayBindingDivisor(array, INSTANCES, NEVER)
    for name, first in inputs:
        if name not in VERTEX_INPUTS:
            continue
        given = VERTEX_INPUTS[name]
        for column in range(given.columns):
            location, offset = first + column, given.offset + COLUMN_BYTES * column
            gl.glEnableVertexArrayAttrib(array, location)
            if given.whole:
                gl.glVertexArrayAttribIFormat(array, location, given.components, enums.UNSIGNED_INT, offset)
            else:
                gl.glVertexArrayAttribFormat(array, location, given.components, enums.FLOAT, 0, offset)
            gl.glVertexArrayAttribBinding(array, location, given.stream)
    return array
