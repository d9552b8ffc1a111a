"""A scene on the device: vertex, index, instance, material and light buffers, texture arrays, and draw commands.

Everything is uploaded once, before the first frame. Draw commands are sorted for each camera of the run beforehand, so
a moving camera uploads nothing either.
"""

from __future__ import annotations

from dataclasses import dataclass

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer, create_buffer, upload_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram
from rendergraph.run.batches import Batch, Batches, cut_batches
from rendergraph.run.scene_store import PAD, SceneStore
from rendergraph.run.vertex_inputs import create_vertex_array
from rendergraph.scene.draw_queues import draw_runs
from rendergraph.scene.gpu_layout import pack_instances, pack_lights, place_textures
from rendergraph.scene.scene import Camera, Scene

COMMAND_BYTES = 20

#: Most bytes of draw commands kept for a moving camera; beyond it neighbouring frames share an order.
COMMAND_BUDGET = 64 * 2**20
#: Most bytes of lights kept for moving ones; beyond it neighbouring frames share their positions.
LIGHT_BUDGET = 64 * 2**20


@dataclass(frozen=True, slots=True)
class _DrawOrder:
    """Draw commands sorted for every eye, one block after another; each block's batches (where blended draws of unlike
    state change places, their runs are cut elsewhere); and each frame's block.
    """

    packed: bytes
    batches: tuple[Batches, ...]
    block_bytes: int
    block_of: tuple[int, ...]


class SceneGeometry:
    """The uploaded scene. ``blocks`` are the blocks a shader may name; of ``textures``, :meth:`draw` binds those that
    a batch needs as ``u_textures``.
    """

    def __init__(
        self,
        device: Device,
        scene: Scene,
        cameras: list[Camera],
        replays: frozenset[int],
        store: SceneStore | None = None,
    ) -> None:
        """``replays``: the instance counts that scene draws of the plan use (1, or the number of cascades). ``store``
        holds the scene's vertices and textures already; it may be shared.
        """
        self._device = device
        self._gl = device.gl
        self._store = store or SceneStore(device, scene)
        self.lights_move = _move(scene, cameras)
        self._lights_packed = self._all_lights(scene, len(cameras), self.lights_move)
        self._instances_packed = pack_instances(scene) or PAD.tobytes() * 2
        self.textures, materials = self._store.materials(scene)
        self.blocks: dict[str, Buffer] = {
            "Instances": create_buffer(device, self._instances_packed, "Instances"),
            "Materials": materials,
            "Lights": create_buffer(device, self._lights_packed, "Lights"),
        }
        self._vertex_arrays: dict[tuple[tuple[str, int], ...], int] = {}
        self._replays = replays
        self._order = self._sorted_commands(scene, cameras)
        self._commands_packed = self._order.packed
        self._commands = create_buffer(device, self._commands_packed, "scene draw commands")
        self._block = 0

    def change(self, scene: Scene, cameras: list[Camera]) -> bool:
        """Upload what differs of another state of the scene, seen by other cameras: lights and the order of draws.
        False, and nothing is done, where the instances, the number of lights, or whether any moves, are others.
        """
        order = self._sorted_commands(scene, cameras)
        lights_move = _move(scene, cameras)
        lights = self._all_lights(scene, len(cameras), lights_move)
        if (pack_instances(scene) or PAD.tobytes() * 2, lights_move) != (self._instances_packed, self.lights_move):
            return False
        if len(order.packed) > len(self._commands_packed) or len(lights) != len(self._lights_packed):
            return False
        self._order = order
        if lights != self._lights_packed:
            upload_buffer(self._device, self.blocks["Lights"], lights)
            self._lights_packed = lights
        if order.packed != self._commands_packed[: len(order.packed)]:
            upload_buffer(self._device, self._commands, order.packed)
            self._commands_packed = order.packed + self._commands_packed[len(order.packed) :]
        return True

    # ---- lights

    def _all_lights(self, scene: Scene, frames: int, move: bool) -> bytes:
        """The lights of every frame one after another, or once for all where none moves."""
        first = pack_lights(scene)
        # Storage ranges may start only at multiples of 256 (the GL maximum).
        self._light_stride = -(-len(first) // 256) * 256
        kept = min(frames, max(1, LIGHT_BUDGET // self._light_stride)) if move else 1
        self._light_block = [frame * kept // frames for frame in range(frames)] or [0]
        blocks = [pack_lights(scene, block / kept).ljust(self._light_stride, b"\0") for block in range(kept)]
        self._light_bytes = len(first)
        self._light_offset = 0
        return b"".join(blocks) if move else first

    def bind_lights(self, target: int, binding: int) -> None:
        """Let a binding point of storage or uniform blocks see this frame's lights."""
        self._gl.glBindBufferRange(target, binding, self.blocks["Lights"].glo, self._light_offset, self._light_bytes)

    # ---- draw commands

    def _sorted_commands(self, scene: Scene, cameras: list[Camera]) -> _DrawOrder:
        eyes = [camera.position for camera in cameras]
        distinct = list(dict.fromkeys(eyes))
        per_frame = max(1, len(scene.instances) * COMMAND_BYTES * len(self._replays))
        kept = distinct[:: max(1, -(-len(distinct) * per_frame // COMMAND_BUDGET))]
        placement, names = place_textures(scene), [texture.glo for texture in self.textures]
        cut = [cut_batches(draw_runs(scene, eye, placement), self._replays, names) for eye in kept]
        blocks = [commands for _, commands in cut]
        where = {eye: index for index, eye in enumerate(kept)}
        nearest, block_of = 0, []
        for eye in eyes:
            nearest = where.get(eye, nearest)
            block_of.append(nearest)
        return _DrawOrder(
            b"".join(blocks) or bytes(COMMAND_BYTES),
            tuple(batches for batches, _ in cut),
            len(blocks[0]) if blocks else 0,
            tuple(block_of),
        )

    def begin_frame(self, index: int) -> None:
        """Use the commands sorted for this frame's camera."""
        block_of = self._order.block_of
        self._block = block_of[min(index, len(block_of) - 1)] if block_of else 0
        self._light_offset = self._light_block[min(index, len(self._light_block) - 1)] * self._light_stride

    def batches(self, queue: str, replays: int) -> tuple[Batch, ...]:
        """This frame's batches of a queue; none for a frame without a camera."""
        return self._order.batches[self._block][queue, replays] if self._order.batches else ()

    def draw(self, queue: str, replays: int, cull: str, texture_units: range, patches: bool) -> None:
        """Issue this frame's batches of a queue with the program that is bound.

        Sets culling (``cull``, but none where double-sided), the front face and the texture arrays of the materials'
        first slots, one of ``texture_units`` each, and leaves them as the last batch needs them. ``patches`` of three
        vertices feed tessellation shaders.
        """
        gl = self._gl
        mode = enums.PATCHES if patches else enums.TRIANGLES
        frame = self._block * self._order.block_bytes
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
        streams = self._store.positions, self._store.attributes, self.blocks["Instances"]
        self._vertex_arrays[inputs] = create_vertex_array(self._device, inputs, streams, self._store.indices)
        return self._vertex_arrays[inputs]


def _move(scene: Scene, cameras: list[Camera]) -> bool:
    """Whether lights move over frames of these cameras."""
    return len(cameras) > 1 and any(light.circle for light in scene.lights)
