"""A scene on the device: vertex, index, instance, material and light buffers, texture arrays, and draw commands.

Everything is uploaded once, before the first frame. Draw commands are sorted for each camera of the run beforehand, so
a moving camera uploads nothing either.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer, create_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram
from rendergraph.device.textures import Texture, create_texture, upload_texture
from rendergraph.plan.graph import Target, TextureDesc
from rendergraph.scene.draw_queues import draw_runs
from rendergraph.scene.gpu_layout import (
    TexturePlacement,
    pack_instances,
    pack_lights,
    pack_materials,
    place_textures,
)
from rendergraph.scene.scene import Camera, Scene

#: Vertex inputs: name, components, offset in the attribute stream (positions have a stream of their own, which is all
#: that depth-only passes read).
ATTRIBUTES = (("in_normal", 3, 0), ("in_tangent", 4, 12), ("in_uv0", 2, 28), ("in_uv1", 2, 36), ("in_color", 4, 44))
ATTRIBUTE_STRIDE = 60
COMMAND_BYTES = 20

#: Most bytes of draw commands kept for a moving camera; beyond it neighbouring frames share an order.
COMMAND_BUDGET = 64 * 2**20
#: Most bytes of lights kept for moving ones; beyond it neighbouring frames share their positions.
LIGHT_BUDGET = 64 * 2**20


@dataclass(frozen=True, slots=True)
class Batch:
    """A run of draw commands with one culling rule: first command and count, within one frame's commands, and the
    triangles (replays included) they draw.
    """

    first: int
    count: int
    double_sided: bool
    mirrored: bool
    triangles: int


class SceneGeometry:
    """The uploaded scene. ``blocks`` are the storage blocks a shader may name; ``textures`` are ``u_textures``."""

    def __init__(self, device: Device, scene: Scene, cameras: list[Camera], replays: frozenset[int]) -> None:
        """``replays``: the instance counts that scene draws of the plan use (1, or the number of cascades)."""
        self._device = device
        self._gl = device.gl
        attributes = np.concatenate([scene.normals, scene.tangents, scene.uv0, scene.uv1, scene.colors], axis=1)
        # Drawing an empty scene is legal and draws nothing, but GL wants every buffer to have at least one byte.
        pad = np.zeros(16, dtype=np.uint32)
        self._positions = create_buffer(device, _bytes(scene.positions, pad), "scene positions")
        self._attributes = create_buffer(device, _bytes(attributes.astype(np.float32), pad), "scene attributes")
        self._indices = create_buffer(device, _bytes(scene.indices, pad), "scene indices")
        placement = place_textures(scene)
        self.textures = _upload_textures(device, placement)
        self.blocks: dict[str, Buffer] = {
            "Instances": create_buffer(device, pack_instances(scene) or pad.tobytes() * 2, "Instances"),
            "Materials": create_buffer(device, pack_materials(scene, placement) or pad.tobytes() * 4, "Materials"),
            "Lights": self._pack_lights(scene, len(cameras)),
        }
        self._vertex_arrays: dict[tuple[tuple[str, int], ...], int] = {}
        self._build_commands(scene, cameras, replays)
        self._frame_offset = 0

    # ---- lights

    def _pack_lights(self, scene: Scene, frames: int) -> Buffer:
        """The lights of every frame one after another, or once for all where none moves."""
        self.lights_move = frames > 1 and any(light.circle for light in scene.lights)
        first = pack_lights(scene)
        # Storage ranges may start only at multiples of 256 (the GL maximum).
        self._light_stride = -(-len(first) // 256) * 256
        kept = min(frames, max(1, LIGHT_BUDGET // self._light_stride)) if self.lights_move else 1
        self._light_block = [frame * kept // frames for frame in range(frames)] or [0]
        blocks = [pack_lights(scene, block / kept).ljust(self._light_stride, b"\0") for block in range(kept)]
        self._light_bytes = len(first)
        self._light_offset = 0
        return create_buffer(self._device, b"".join(blocks) if self.lights_move else first, "Lights")

    def bind_lights(self, binding: int) -> None:
        """Let a storage binding point see this frame's lights."""
        self._gl.glBindBufferRange(
            enums.SHADER_STORAGE_BUFFER, binding, self.blocks["Lights"].glo, self._light_offset, self._light_bytes
        )

    # ---- draw commands

    def _build_commands(self, scene: Scene, cameras: list[Camera], replays: frozenset[int]) -> None:
        eyes = [camera.position for camera in cameras]
        distinct = list(dict.fromkeys(eyes))
        per_frame = max(1, len(scene.instances) * COMMAND_BYTES * len(replays))
        kept = distinct[:: max(1, -(-len(distinct) * per_frame // COMMAND_BUDGET))]
        self.batches: dict[tuple[str, int], tuple[Batch, ...]] = {}
        blocks = []
        for eye in kept:
            queues = draw_runs(scene, eye)
            parts, first = [], 0
            for replay in sorted(replays):
                for queue, runs in queues.items():
                    batches = []
                    for run in runs:
                        commands = run.commands.copy()
                        commands["instance_count"] *= replay
                        indices = commands["count"].astype(np.int64) * commands["instance_count"]
                        triangles = int(indices.sum()) // 3
                        batches.append(Batch(first, len(commands), run.double_sided, run.mirrored, triangles))
                        parts.append(commands)
                        first += len(commands)
                    self.batches[queue, replay] = tuple(batches)
            blocks.append(np.concatenate(parts).tobytes() if parts else b"")
        self._frame_bytes = len(blocks[0]) if blocks else 0
        self._commands = create_buffer(self._device, b"".join(blocks) or bytes(COMMAND_BYTES), "scene draw commands")
        where = {eye: index for index, eye in enumerate(kept)}
        nearest, self._frame_block = 0, []
        for eye in eyes:
            nearest = where.get(eye, nearest)
            self._frame_block.append(nearest)

    def begin_frame(self, index: int) -> None:
        """Use the commands sorted for this frame's camera."""
        block = self._frame_block[min(index, len(self._frame_block) - 1)] if self._frame_block else 0
        self._frame_offset = block * self._frame_bytes
        self._light_offset = self._light_block[min(index, len(self._light_block) - 1)] * self._light_stride

    def bind_commands(self) -> None:
        """Make the scene's draw commands the source of indirect draws."""
        self._gl.glBindBuffer(enums.DRAW_INDIRECT_BUFFER, self._commands.glo)

    def draw(self, batch: Batch, patches: bool = False) -> None:
        """Issue a batch with the state that is bound; ``patches`` of three vertices feed tessellation shaders."""
        mode = enums.PATCHES if patches else enums.TRIANGLES
        offset = self._frame_offset + batch.first * COMMAND_BYTES
        self._gl.glMultiDrawElementsIndirect(mode, enums.UNSIGNED_INT, offset, batch.count, COMMAND_BYTES)

    # ---- vertex arrays

    def vertex_array(self, program: LinkedProgram) -> int:
        """A vertex array that feeds the program's inputs; shared by programs with equal inputs."""
        inputs = tuple(sorted(program.attributes.items()))
        if inputs in self._vertex_arrays:
            return self._vertex_arrays[inputs]
        gl = self._gl
        array = self._device.create_object("glCreateVertexArrays", label="scene vertices")
        gl.glVertexArrayElementBuffer(array, self._indices.glo)
        gl.glVertexArrayVertexBuffer(array, 0, self._positions.glo, 0, 12)
        gl.glVertexArrayVertexBuffer(array, 1, self._attributes.glo, 0, ATTRIBUTE_STRIDE)
        layout = {"in_position": (3, 0, 0)} | {name: (size, offset, 1) for name, size, offset in ATTRIBUTES}
        for name, location in inputs:
            if name not in layout:
                continue
            size, offset, stream = layout[name]
            gl.glEnableVertexArrayAttrib(array, location)
            gl.glVertexArrayAttribFormat(array, location, size, enums.FLOAT, 0, offset)
            gl.glVertexArrayAttribBinding(array, location, stream)
        self._vertex_arrays[inputs] = array
        return array


def _bytes(array: npt.NDArray[Any], pad: npt.NDArray[Any]) -> bytes:
    return np.ascontiguousarray(array).tobytes() or pad.tobytes()


def _upload_textures(device: Device, placement: TexturePlacement) -> list[Texture]:
    textures = []
    for index, array in enumerate(placement.arrays):
        desc = TextureDesc(
            "srgb8_a8" if array.srgb else "rgba8",
            array.size,
            array.size,
            layers=len(array.images),
            mips=array.size.bit_length(),
            target=Target.D2_ARRAY,
        )
        texture = create_texture(device, desc, f"u_textures[{index}]")
        for mip, level in enumerate(array.levels()):
            upload_texture(device, texture, level, mip=mip)
        textures.append(texture)
    return textures
