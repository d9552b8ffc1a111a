"""Turns each sub-pass of a plan into the GL calls that carry it out, recorded once and replayed every frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer, clear_buffer, copy_buffer, poison_buffer
from rendergraph.device.context import Device
from rendergraph.device.debug import Scope
from rendergraph.device.framebuffers import Framebuffer, clear_color, clear_depth, create_framebuffer
from rendergraph.device.gl import Call
from rendergraph.device.host_copies import buffer_through_host, texture_through_host
from rendergraph.device.programs import LinkedProgram
from rendergraph.device.texels import Poison
from rendergraph.device.textures import (
    Texture,
    clear_texture,
    copy_texture,
    generate_mips,
    poison_texture,
)
from rendergraph.document.formats import FORMATS
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import (
    Access,
    ClearResource,
    CopyBuffer,
    CopyTexture,
    Dispatch,
    DispatchIndirect,
    DrawArrays,
    DrawIndirect,
    DrawScene,
    Fullscreen,
    GenerateMips,
    Kind,
    SubPass,
    Target,
    Usage,
)
from rendergraph.plan.plan import Barrier, Plan
from rendergraph.run.allocation import Allocation
from rendergraph.run.bindings import SCENE_TEXTURES, Bindings
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.state import Recorder

_TOPOLOGY = {"points": 0, "lines": 1, "line_strip": 3, "triangles": 4, "triangle_strip": 5, "patches": 14}


@dataclass(frozen=True, slots=True)
class Command:
    """A sub-pass ready to run: its calls, inside its debug group. The first ``poisoning`` of them fill what is used
    here for the first time.
    """

    subpass: SubPass
    scope: Scope
    calls: tuple[Call, ...]
    poisoning: int = 0

    def run(self) -> None:
        """Make the calls."""
        self.scope.run(self.calls)

    def run_poisoning(self) -> None:
        """Make the calls that poison."""
        self.scope.run(self.calls[: self.poisoning])

    def run_work(self) -> None:
        """Make the others."""
        self.scope.run(self.calls[self.poisoning :])


class CommandBuilder:
    """Builds the commands of one parity of a plan. Framebuffers and views are made here, never while running."""

    def __init__(
        self,
        device: Device,
        plan: Plan,
        storage: Allocation,
        geometry: SceneGeometry | None,
        programs: dict[str, LinkedProgram],
        parity: int,
        *,
        poison: Poison | None,
    ) -> None:
        self._device = device
        self._plan = plan
        self._storage = storage
        self._geometry = geometry
        self._programs = programs
        self._parity = parity
        self._poison = poison
        self._recorder = Recorder(device.gl, plan.graph.frame.depth == "reversed")
        self._bindings = Bindings(device, plan, storage, geometry, self._recorder, parity)
        self._framebuffers: dict[Any, Framebuffer] = {}
        self._empty_array = device.create_object("glCreateVertexArrays", label="no vertex inputs")

    def build(self) -> list[Command]:
        """All commands in plan order."""
        before = {barrier.index: barrier for barrier in self._plan.barriers}
        first_use: dict[int, list[str]] = {}
        for name, life in self._plan.lifetimes.items():
            first_use.setdefault(life.first, []).append(name)
        commands = []
        for index, subpass in enumerate(self._plan.order):
            if self._poison is not None:
                self._poison_all(first_use.get(index, ()), self._poison)
            poisoning = len(self._recorder.calls)
            if index in before:
                self._barrier(before[index])
            self._work(subpass)
            scope = self._device.scope(subpass.name, subpass.position)
            commands.append(Command(subpass, scope, self._recorder.take(), poisoning))
        return commands

    # ---- around the work

    def _barrier(self, barrier: Barrier) -> None:
        if barrier.bits:
            self._recorder.call(self._device.gl.glMemoryBarrier, barrier.bits)
        if barrier.texture_barrier:
            self._recorder.call(self._device.gl.glTextureBarrier)

    def _poison_all(self, names: Sequence[str], poison: Poison) -> None:
        transient = [name for name in names if self._plan.graph.resources[name].kind is Kind.TRANSIENT]
        if transient:
            # The plan's barriers are for the plan's accesses: this write to memory others have just used is not one.
            self._recorder.call(self._device.gl.glMemoryBarrier, enums.ALL_BARRIER_BITS)
        for name in transient:
            if self._storage.is_texture(name):
                self._recorder.call(poison_texture, self._device, self._texture(name), poison)
            else:
                self._recorder.call(poison_buffer, self._device, self._buffer(name), poison)

    def _texture(self, name: str) -> Texture:
        return self._storage.texture(name, self._parity)

    def _buffer(self, name: str) -> Buffer:
        return self._storage.buffer(name, self._parity)

    # ---- the work

    def _work(self, subpass: SubPass) -> None:
        work, gl, record = subpass.work, self._device.gl, self._recorder
        if subpass.program is not None:
            program = self._programs[subpass.name]
            if not subpass.program.is_compute:
                _require_outputs(subpass, program)
                self._targets(subpass)
            record.set("program", program.glo, gl.glUseProgram, program.glo)
            self._bindings.bind(subpass, program)
        match work:
            case Fullscreen():
                self._draw_arrays("triangles", 3, 1)
            case DrawArrays(vertices, instances, topology, separate):
                if separate:
                    self._draw_separately(topology, vertices, instances)
                else:
                    self._draw_arrays(topology, vertices, instances)
            case DrawIndirect(name, offset, count, topology):
                buffer = self._buffer(name)
                self._vertex_array(self._empty_array)
                record.call(gl.glBindBuffer, enums.DRAW_INDIRECT_BUFFER, buffer.glo)
                start = buffer.offset + offset
                record.call(gl.glMultiDrawArraysIndirect, _TOPOLOGY[topology], start, count, 16)
            case DrawScene():
                self._draw_scene(subpass, work)
            case Dispatch(x, y, z):
                record.call(gl.glDispatchCompute, x, y, z)
            case DispatchIndirect(name, offset):
                buffer = self._buffer(name)
                record.call(gl.glBindBuffer, enums.DISPATCH_INDIRECT_BUFFER, buffer.glo)
                record.call(gl.glDispatchComputeIndirect, buffer.offset + offset)
            case CopyTexture():
                self._copy(work)
            case CopyBuffer(source, destination, count, host):
                copy = buffer_through_host if host else copy_buffer
                record.call(copy, self._device, self._buffer(source), self._buffer(destination), count)
            case ClearResource(name, value):
                if isinstance(value, int):
                    record.call(clear_buffer, self._device, self._buffer(name), value)
                else:
                    record.call(clear_texture, self._device, self._texture(name), value)
            case GenerateMips(name):
                record.call(generate_mips, self._device, self._texture(name))

    def _draw_arrays(self, topology: str, vertices: int, instances: int) -> None:
        self._vertex_array(self._empty_array)
        gl, mode = self._device.gl, _TOPOLOGY[topology]
        if instances == 1:
            self._recorder.call(gl.glDrawArrays, mode, 0, vertices)
        else:
            self._recorder.call(gl.glDrawArraysInstanced, mode, 0, vertices, instances)

    def _draw_separately(self, topology: str, vertices: int, instances: int) -> None:
        self._vertex_array(self._empty_array)
        gl, mode = self._device.gl, _TOPOLOGY[topology]
        for instance in range(instances):
            self._recorder.call(gl.glDrawArraysInstancedBaseInstance, mode, 0, vertices, 1, instance)

    def _draw_scene(self, subpass: SubPass, work: DrawScene) -> None:
        geometry, program = self._geometry, subpass.program
        assert geometry is not None, "plan_document refuses scene draws without a scene"
        tessellated = program is not None and any(stage == "tess_evaluation" for stage, _ in program.stages)
        self._vertex_array(geometry.vertex_array(self._programs[subpass.name]))
        textures = self._programs[subpass.name].samplers.get(SCENE_TEXTURES)
        units = textures.units if textures is not None else range(0)
        for queue in work.queues:
            self._recorder.call(geometry.draw, queue, work.instances, work.cull, units, tessellated)
        self._recorder.forget_draws(units)
        self._recorder.front_face(False)

    def _vertex_array(self, array: int) -> None:
        self._recorder.set("vertex_array", array, self._device.gl.glBindVertexArray, array)

    # ---- targets

    def _targets(self, subpass: SubPass) -> None:
        gl, record = self._device.gl, self._recorder
        colors = [a for a in subpass.accesses if a.usage is Usage.COLOR]
        depths = [a for a in subpass.accesses if a.usage in (Usage.DEPTH, Usage.DEPTH_READ)]
        framebuffer = self._framebuffer(subpass, colors, depths[0] if depths else None)
        record.set("framebuffer", framebuffer.glo, gl.glBindFramebuffer, enums.DRAW_FRAMEBUFFER, framebuffer.glo)
        size = framebuffer.width, framebuffer.height
        record.set("viewport", size, gl.glViewport, 0, 0, *size)
        if subpass.clears:
            record.write_all()  # clears obey the write masks
        for index, access in enumerate(colors):
            if access.resource in subpass.clears:
                record.call(clear_color, self._device, framebuffer, index, subpass.clears[access.resource])
        for access in depths:
            if access.resource in subpass.clears:
                far, stencil, *_ = subpass.clears[access.resource]
                record.call(clear_depth, self._device, framebuffer, far, int(stencil))
        record.depth(subpass.state, bool(depths))
        if not isinstance(subpass.work, DrawScene):
            record.cull(subpass.state.cull)
        record.blend(subpass.state.blend)
        mask = int(subpass.state.color_mask)
        record.set("color_mask", bool(mask), gl.glColorMask, mask, mask, mask, mask)

    def _framebuffer(self, subpass: SubPass, colors: list[Access], depth: Access | None) -> Framebuffer:
        color_targets = [(self._texture(a.resource), a.mip or 0, a.layer) for a in colors]
        depth_target = (self._texture(depth.resource), depth.layer) if depth else None
        # Resources that share one texture are one attachment, whatever their names.
        key = (
            tuple((texture.glo, mip, layer) for texture, mip, layer in color_targets),
            depth_target and (depth_target[0].glo, depth_target[1]),
        )
        if key not in self._framebuffers:
            frame = self._plan.graph.frame
            self._framebuffers[key] = create_framebuffer(
                self._device, color_targets, depth_target, subpass.name, (frame.width, frame.height)
            )
        return self._framebuffers[key]

    # ---- copies

    def _copy(self, work: CopyTexture) -> None:
        source, destination = self._texture(work.source), self._texture(work.destination)
        record, device = self._recorder, self._device
        if not work.blit:
            record.call(texture_through_host if work.host else copy_texture, device, source, destination)
            return
        record.write_all()
        filter_ = enums.LINEAR if work.linear else enums.NEAREST
        for layer in range(min(source.desc.layers, destination.desc.layers)):
            at = [self._read_target(t, layer) for t in (source, destination)]
            format_ = FORMATS[source.desc.format]
            mask = enums.DEPTH_BUFFER_BIT if format_.depth else enums.COLOR_BUFFER_BIT
            mask |= enums.STENCIL_BUFFER_BIT if format_.stencil else 0
            record.call(
                device.gl.glBlitNamedFramebuffer, at[0].glo, at[1].glo,
                0, 0, at[0].width, at[0].height, 0, 0, at[1].width, at[1].height, mask, filter_,
            )  # fmt: skip

    def _read_target(self, texture: Texture, layer: int) -> Framebuffer:
        at = layer if texture.desc.target is not Target.D2 else None
        key = ("blit", texture, at)
        if key not in self._framebuffers:
            if FORMATS[texture.desc.format].depth:
                made = create_framebuffer(self._device, [], (texture, at), texture.label)
            else:
                made = create_framebuffer(self._device, [(texture, 0, at)], None, texture.label)
            self._framebuffers[key] = made
        return self._framebuffers[key]


def _require_outputs(subpass: SubPass, program: LinkedProgram) -> None:
    """Raise RenderGraphError RG569 for a colour target the shader has no output for: GL would leave it undefined."""
    colors = [a.resource for a in subpass.accesses if a.usage is Usage.COLOR]
    written = set(program.interface.outputs.values())
    for location, resource in enumerate(colors):
        if location not in written and subpass.state.color_mask:
            raise RenderGraphError([
                diagnose("RG569", subpass.position, subpass=subpass.name, resource=resource, location=location)
            ])  # fmt: skip
