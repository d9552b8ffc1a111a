"""A scene on the device: vertex, index, instance, material and light buffers, texture arrays, and draw commands.

Everything is uploaded once, before the first frame. Draw commands are sorted for each camera of the run beforehand, so
a moving camera uploads nothing either.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer, create_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram
from rendergraph.device.textures import Texture, create_texture, upload_texture
from rendergraph.plan.graph import Target, TextureDesc
from rendergraph.run.batches import Batch, cut_batches
from rendergraph.run.vertex_inputs import create_vertex_array
from rendergraph.scene.draw_queues import draw_runs
from rendergraph.scene.gpu_layout import (
    TexturePlacement,
    pack_instances,
    pack_lights,
    pack_materials,
    place_textures,
)
from rendergraph.scene.scene import Camera, Scene

COMMAND_BYTES = 20

#: Most bytes of draw commands kept for a moving camera; beyond it neighbouring frames share an order.
COMMAND_BUDGET = 64 * 2**20
#: Most bytes of lights kept for moving ones; beyond it neighbouring frames share their positions.
LIGHT_BUDGET = 64 * 2**20


class SceneGeometry:
    """The uploaded scene. ``blocks`` are the blocks a shader may name; of ``textures``, :meth:`draw` binds those that
    a batch needs as ``u_textures``.
    """

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
        self._build_commands(scene, cameras, replays, placement)
        self._block = 0

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

    def bind_lights(self, target: int, binding: int) -> None:
        """Let a binding point of storage or uniform blocks see this frame's lights."""
        self._gl.glBindBufferRange(target, binding, self.blocks["Lights"].glo, self._light_offset, self._light_bytes)

    # ---- draw commands

    def _build_commands(
        self, scene: Scene, cameras: list[Camera], replays: frozenset[int], placement: TexturePlacement
    ) -> None:
        eyes = [camera.position for camera in cameras]
        distinct = list(dict.fromkeys(eyes))
        per_frame = max(1, len(scene.instances) * COMMAND_BYTES * len(replays))
        kept = distinct[:: max(1, -(-len(distinct) * per_frame // COMMAND_BUDGET))]
        # Of each eye: where blended draws of unlike state change places, their runs are cut elsewhere.
        names = [texture.glo for texture in self.textures]
        cut = [cut_batches(draw_runs(scene, eye, placement), replays, names) for eye in kept]
        self._batches = [batches for batches, _ in cut]
        blocks = [commands for _, commands in cut]
        self._frame_bytes = len(blocks[0]) if blocks else 0
        self._commands = create_buffer(self._device, b"".join(blocks) or bytes(COMMAND_BYTES), "scene draw commands")
        where = {eye: index for index, eye in enumerate(kept)}
        nearest, self._frame_block = 0, []
        for eye in eyes:
            nearest = where.get(eye, nearest)
            self._frame_block.append(nearest)

    def begin_frame(self, index: int) -> None:
        """Use the commands sorted for this frame's camera."""
        self._block = self._frame_block[min(index, len(self._frame_block) - 1)] if self._frame_block else 0
        self._light_offset = self._light_block[min(index, len(self._light_block) - 1)] * self._light_stride

    def batches(self, queue: str, replays: int) -> tuple[Batch, ...]:
        """This frame's batches of a queue; none for a frame without a camera."""
        return self._batches[self._block][queue, replays] if self._batches else ()

    def draw(self, queue: str, replays: int, cull: str, texture_units: range, patches: bool) -> None:
        """Issue this frame's batches of a queue with the program that is bound.

        Sets culling (``cull``, but none where double-sided), the front face and the texture arrays of the materials'
        first slots, one of ``texture_units`` each, and leaves them as the last batch needs them. ``patches`` of three
        vertices feed tessellation shaders.
        """
        gl = self._gl
        mode = enums.PATCHES if patches else enums.TRIANGLES
        frame = self._block * self._frame_bytes
        # An indirect draw of this frame's own arguments may have bound another buffer.
        gl.glBindBuffer(enums.DRAW_INDIRECT_BUFFER, self._commands.glo)
        gl.glCullFace(enums.FRONT if cull == "front" else enums.BACK)
        culls, faces = None, None
        bound: dict[int, int] = {}
        for batch in self.batches(queue, replays):
            if culls is not (culled := cull != "none" and not batch.double_sided):
                culls = culled
                (gl.glEnable if culled else gl.glDisable)(enums.CULL_FACE)
            if faces is not batch.mirrored:
                faces = batch.mirrored
                gl.glFrontFace(enums.CW if faces else enums.CCW)
            for slot, texture in batch.textures:
                if slot < len(texture_units) and bound.get(slot) != texture:
                    bound[slot] = texture
                    gl.glBindTextureUnit(texture_units[slot], texture)
            offset = frame + batch.first * COMMAND_BYTES
            gl.glMultiDrawElementsIndirect(mode, enums.UNSIGNED_INT, offset, batch.count, COMMAND_BYTES)

    # ---- vertex arrays

    def vertex_array(self, program: LinkedProgram) -> int:
        """A vertex array that feeds the program's inputs; shared by programs with equal inputs."""
        inputs = tuple(sorted(program.attributes.items()))
        if inputs in self._vertex_arrays:
            return self._vertex_arrays[inputs]
        streams = self._positions, self._attributes, self.blocks["Instances"]
        self._vertex_arrays[inputs] = create_vertex_array(self._device, inputs, streams, self._indices)
        return self._vertex_arrays[inputs]


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
