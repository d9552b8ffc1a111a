"""A scene on the device: vertex, index, instance, material and light buffers, texture arrays, and draw commands.

Everything is uploaded once, before the first frame. Draw commands are sorted for each camera of the run beforehand, so
a moving camera uploads nothing either.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer, create_buffer, upload_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram
from rendergraph.run.scene_store import PAD, SceneStore
from rendergraph.scene.draw_queues import draw_runs
from rendergraph.scene.gpu_layout import pack_instances, pack_lights
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


@dataclass(frozen=True, slots=True)
class _DrawOrder:
    """Draw commands sorted for every eye, one block after another; the batches they are drawn in, by queue and replays;
    and each frame's block.
    """

    packed: bytes
    batches: dict[tuple[str, int], tuple[Batch, ...]]
    block_bytes: int
    block_of: tuple[int, ...]


class SceneGeometry:
    """The uploaded scene. ``blocks`` are the storage blocks a shader may name; ``textures`` are ``u_textures``."""

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
        self.textures, materials = self._store.materials(scene)
        self.blocks: dict[str, Buffer] = {
            "Instances": create_buffer(device, pack_instances(scene) or PAD.tobytes() * 2, "Instances"),
            "Materials": materials,
            "Lights": create_buffer(device, self._lights_packed, "Lights"),
        }
        self._vertex_arrays: dict[tuple[tuple[str, int], ...], int] = {}
        self._replays = replays
        self._order = self._sorted_commands(scene, cameras)
        self._commands_packed = self._order.packed
        self._commands = create_buffer(device, self._commands_packed, "scene draw commands")
        self._frame_offset = 0

    def change(self, scene: Scene, cameras: list[Camera]) -> bool:
        """Upload what differs of another state of the scene, seen by other cameras: lights and the order of draws.
        False, and nothing is done, where the instances, the number of lights, or whether any moves, are others.
        """
        order = self._sorted_commands(scene, cameras)
        lights_move = _move(scene, cameras)
        lights = self._all_lights(scene, len(cameras), lights_move)
        if (order.batches, lights_move) != (self._order.batches, self.lights_move):
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

    def bind_lights(self, binding: int) -> None:
        """Let a storage binding point see this frame's lights."""
        self._gl.glBindBufferRange(
            enums.SHADER_STORAGE_BUFFER, binding, self.blocks["Lights"].glo, self._light_offset, self._light_bytes
        )

    # ---- draw commands

    @property
    def batches(self) -> dict[tuple[str, int], tuple[Batch, ...]]:
        """By queue and replays."""
        return self._order.batches

    def _sorted_commands(self, scene: Scene, cameras: list[Camera]) -> _DrawOrder:
        eyes = [camera.position for camera in cameras]
        distinct = list(dict.fromkeys(eyes))
        per_frame = max(1, len(scene.instances) * COMMAND_BYTES * len(self._replays))
        kept = distinct[:: max(1, -(-len(distinct) * per_frame // COMMAND_BUDGET))]
        found: dict[tuple[str, int], tuple[Batch, ...]] = {}
        blocks = []
        for eye in kept:
            queues = draw_runs(scene, eye)
            parts, first = [], 0
            for replay in sorted(self._replays):
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
                    found[queue, replay] = tuple(batches)
            blocks.append(np.concatenate(parts).tobytes() if parts else b"")
        where = {eye: index for index, eye in enumerate(kept)}
        nearest, block_of = 0, []
        for eye in eyes:
            nearest = where.get(eye, nearest)
            block_of.append(nearest)
        return _DrawOrder(
            b"".join(blocks) or bytes(COMMAND_BYTES), found, len(blocks[0]) if blocks else 0, tuple(block_of)
        )

    def begin_frame(self, index: int) -> None:
        """Use the commands sorted for this frame's camera."""
        block_of = self._order.block_of
        block = block_of[min(index, len(block_of) - 1)] if block_of else 0
        self._frame_offset = block * self._order.block_bytes
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
        gl.glVertexArrayElementBuffer(array, self._store.indices.glo)
        gl.glVertexArrayVertexBuffer(array, 0, self._store.positions.glo, 0, 12)
        gl.glVertexArrayVertexBuffer(array, 1, self._store.attributes.glo, 0, ATTRIBUTE_STRIDE)
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


def _move(scene: Scene, cameras: list[Camera]) -> bool:
    """Whether lights move over frames of these cameras."""
    return len(cameras) > 1 and any(light.circle for light in scene.lights)
