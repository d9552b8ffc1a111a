"""Runs a plan: compiles and allocates everything once, then replays the frame's commands."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rendergraph.device import enums
from rendergraph.device.buffers import create_buffer, upload_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram, compile_program
from rendergraph.device.texels import Poison
from rendergraph.plan.graph import DrawScene
from rendergraph.plan.plan import Plan
from rendergraph.run.allocation import Allocation
from rendergraph.run.bindings import FRAME_BINDING
from rendergraph.run.commands import Command, CommandBuilder
from rendergraph.run.counting import count_command, count_step
from rendergraph.run.finite import check_finite_writes
from rendergraph.run.frame_constants import STRIDE, pack_frames
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.readback import read_resource
from rendergraph.run.result import Pixels, StepCounters, StepTimes
from rendergraph.run.scene_store import SceneStore
from rendergraph.run.state import restore_defaults
from rendergraph.scene.floating_origin import camera_from, device_origin, scene_from
from rendergraph.scene.scene import Camera, Scene

if TYPE_CHECKING:
    from rendergraph.device.clock import Clock

#: Called with a texture's name and pixels.
Inspect = Callable[[str, Pixels], None]


class Runner:
    """One plan on one device. Call :meth:`prepare` once, :meth:`run_frame` for each frame, :meth:`release` at the end.

    ``cameras`` holds one camera a frame; later frames reuse the last. ``poison`` fills transient resources before their
    first use (True: with NaN). ``store`` is the scene's vertices and textures where they are on the device already.
    """

    def __init__(
        self,
        device: Device,
        plan: Plan,
        scene: Scene | None,
        cameras: list[Camera],
        *,
        poison: bool | Poison = False,
        store: SceneStore | None = None,
    ) -> None:
        self._device = device
        self._plan = plan
        #: Where the device's origin is in the world: what passes see, and their references, is placed from it.
        self.origin = device_origin(cameras)
        self._scene = scene_from(scene, self.origin) if scene is not None else None
        self._cameras = [camera_from(camera, self.origin) for camera in cameras]
        self._poison: Poison | None = "nan" if poison is True else poison or None
        self._store = store
        self._owned_before = set(device.owned)
        self.compile_ns = 0
        self.upload_ns = 0

    def prepare(self, progress: Callable[[int, int], None] = lambda done, total: None) -> None:
        """Compile every program, upload the scene and frame constants, allocate, and record the commands."""
        device, plan = self._device, self._plan
        start = time.perf_counter_ns()
        self._programs = self._compile(progress)
        middle = time.perf_counter_ns()
        self._geometry: SceneGeometry | None = None
        if self._scene is not None:
            replays = frozenset(s.work.instances for s in plan.order if isinstance(s.work, DrawScene))
            self._geometry = SceneGeometry(device, self._scene, self._cameras, replays, self._store)
        self._frames_packed = pack_frames(plan.graph.frame, self._scene, self._cameras)
        self._frame_block = create_buffer(device, self._frames_packed, "Frame")
        self._storage = Allocation(device, plan)
        self._commands = [self._build(parity) for parity in range(self._storage.parities)]
        device.finish()
        device.check()
        self.upload_ns = time.perf_counter_ns() - middle
        self.compile_ns = middle - start

    def _compile(self, progress: Callable[[int, int], None]) -> dict[str, LinkedProgram]:
        programs = {}
        for index, subpass in enumerate(self._plan.order):
            progress(index, len(self._plan.order))
            if subpass.program is not None:
                programs[subpass.name] = compile_program(
                    self._device, subpass.program, subpass.position, subpass.uniforms
                )
        return programs

    def _build(self, parity: int) -> list[Command]:
        return CommandBuilder(
            self._device, self._plan, self._storage, self._geometry, self._programs, parity, poison=self._poison
        ).build()

    def change_scene(
        self, scene: Scene, cameras: list[Camera], *, first: int = 0, before: Camera | None = None
    ) -> bool:
        """Let frames from ``first`` on show another state of the scene, uploading what differs; ``before`` is the
        camera of the frame before. False, and nothing is done, where the recorded commands cannot draw it.
        """
        scene = scene_from(scene, self.origin)
        cameras = [camera_from(camera, self.origin) for camera in cameras]
        if self._geometry is None or len(cameras) != len(self._cameras) or not self._geometry.change(scene, cameras):
            return False
        self._scene, self._cameras = scene, cameras
        seen = list(cameras)
        if before is not None and 0 < first <= len(seen):
            seen[first - 1] = camera_from(before, self.origin)
        packed = pack_frames(self._plan.graph.frame, scene, seen)
        if packed != self._frames_packed:
            upload_buffer(self._device, self._frame_block, packed)
            self._frames_packed = packed
        return True

    # ---- frames

    @property
    def plan(self) -> Plan:
        """What it runs."""
        return self._plan

    @property
    def storage(self) -> Allocation:
        """Where the plan's resources live; after :meth:`prepare`."""
        return self._storage

    def commands_of(self, index: int) -> list[Command]:
        """Point the frame's constants and draw commands at frame ``index``; its commands."""
        at = min(index, len(self._cameras) - 1)
        self._device.gl.glBindBufferRange(
            enums.UNIFORM_BUFFER, FRAME_BINDING, self._frame_block.glo, at * STRIDE, STRIDE
        )
        if self._geometry is not None:
            self._geometry.begin_frame(at)
        return self._commands[index % len(self._commands)]

    def run_frame(
        self, index: int, *, capture: Iterable[str] = (), inspect: Inspect | None = None, check_finite: bool = False
    ) -> dict[str, Pixels]:
        """Run one frame; give back the resources to ``capture``, each read right after the last sub-pass that uses it,
        before another may take its memory. ``inspect`` is called with every texture then, and nothing of it is kept.

        :raises RenderGraphError: RG500 for a driver error, RG565 for the first NaN or Inf under ``check_finite``.
        """
        last: dict[int, list[str]] = {}
        kept = set(capture)
        if kept or inspect is not None:
            for name, life in self._plan.lifetimes.items():
                if name in kept or (inspect is not None and self._storage.is_texture(name)):
                    last.setdefault(life.last, []).append(name)
        captured = {}
        for position, command in enumerate(self.commands_of(index)):
            command.run()
            if check_finite:
                check_finite_writes(self._device, self._plan, command.subpass, self._storage, index)
            for name in last.get(position, ()):
                pixels = self.read(name, index)
                if name in kept:
                    captured[name] = pixels
                if inspect is not None and self._storage.is_texture(name):
                    inspect(name, pixels)
        self._device.check()
        return captured

    def read(self, name: str, index: int, *, mip: int = 0, aspect: str = "color") -> Pixels:
        """A resource's content after frame ``index``: ``[height, width, channels]``, first row at the bottom."""
        return read_resource(self._device, self._storage, name, index, mip=mip, aspect=aspect)

    # ---- counts

    def count_plan(self) -> tuple[StepCounters, ...]:
        """What the plan alone says of each sub-pass."""
        return tuple(count_step(self._plan, subpass, self._geometry) for subpass in self._plan.order)

    def count_frame(self, index: int) -> tuple[StepCounters, ...]:
        """Run one frame with the device counting, sub-pass by sub-pass; never one that is timed."""
        counters = tuple(
            count_command(self._device, self._plan, command, self._storage, self._geometry, index)
            for command in self.commands_of(index)
        )
        self._device.check()
        return counters

    # ---- times

    def time_frames(
        self, first: int, count: int, clock: Clock, progress: Callable[[str, int, int], None]
    ) -> tuple[tuple[int, ...], tuple[int, ...], tuple[StepTimes, ...]]:
        """Run ``count`` whole frames and ``count`` pass by pass under the clock, in turn from frame ``first`` on: times
        of the whole frames, the part of them until all was handed over, and of the sub-passes.

        Nanoseconds. Timing a pass on its own ends its overlap with its neighbours, so both figures are kept.
        """
        frames, handed, submit, process, submitted = [], [], [], [], []
        for sample in range(count):
            progress("timing", sample, count)
            self._device.finish()
            start = time.perf_counter_ns()
            for command in self.commands_of(first + 2 * sample):
                command.run()
            handed.append(time.perf_counter_ns() - start)
            self._device.finish()
            frames.append(time.perf_counter_ns() - start)
            clock.begin_frame()
            for position, command in enumerate(self.commands_of(first + 2 * sample + 1)):
                clock.begin(position)
                command.run()
                clock.end(position)
            clock.end_frame()
            submit.append(clock.submit_ns)
            process.append(clock.process_ns)
            submitted.append(clock.submit_starts)
        passes = clock.drain()
        steps = tuple(
            StepTimes(
                subpass.name,
                tuple(times[i] for times in passes),
                tuple(times[i] for times in submit),
                tuple(times[i] for times in process),
                tuple(times[i] for times in clock.starts),
                tuple(times[i] for times in submitted),
            )
            for i, subpass in enumerate(self._plan.order)
        )
        return tuple(frames), tuple(handed), steps

    def release(self) -> None:
        """Delete every object this runner made, and leave the context's state as it was opened."""
        self._device.finish()
        restore_defaults(self._device.gl)
        # Samplers are shared by every run through the device's cache.
        mine = [key for key in self._device.owned if key not in self._owned_before and key[0] != "glDeleteSamplers"]
        for delete, name in mine:
            self._device.delete_object(delete, name)
