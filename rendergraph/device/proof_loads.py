"""Two known loads of some milliseconds, one drawn and one dispatched, for proving clocks."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.framebuffers import bind_framebuffer, create_framebuffer, destroy_framebuffer
from rendergraph.device.includes import SHARED
from rendergraph.device.programs import LinkedProgram, compile_program
from rendergraph.device.textures import create_texture, destroy_texture
from rendergraph.plan.graph import Program, TextureDesc

_SHADERS: Final = Path(__file__).resolve().parent / "shaders"
_SIZE: Final = 256
_ENOUGH_NS: Final = 3_000_000  # long beside a clock's granularity and the cost of a wait
_MOST_STEPS: Final = 1 << 22


class ProofLoads:
    """A full-screen draw and a dispatch, each sized to last some milliseconds on this device."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._draw = compile_program(
            device, Program((("fragment", _SHADERS / "proof.frag"), ("vertex", SHARED / "fullscreen.vert")))
        )
        self._dispatch = compile_program(device, Program((("compute", _SHADERS / "proof.comp"),)))
        self._texture = create_texture(device, TextureDesc("r32f", _SIZE, _SIZE), "clock proof")
        self._target = create_framebuffer(device, [(self._texture, 0, None)], None, "clock proof")
        self._vertices = device.create_object("glCreateVertexArrays", label="clock proof")
        for program, load in ((self._draw, self.raster), (self._dispatch, self.compute)):
            self._calibrate(program, load)

    def raster(self) -> None:
        """Draw once. Blending off, depth off: the state a moderngl context starts with."""
        gl = self._device.gl
        bind_framebuffer(self._device, self._target)
        for capability in (e.BLEND, e.DEPTH_TEST, e.CULL_FACE, e.RASTERIZER_DISCARD, e.SCISSOR_TEST):
            gl.glDisable(capability)
        gl.glColorMask(1, 1, 1, 1)
        gl.glUseProgram(self._draw.glo)
        gl.glBindVertexArray(self._vertices)
        gl.glDrawArrays(e.TRIANGLES, 0, 3)

    def compute(self) -> None:
        """Dispatch once."""
        gl = self._device.gl
        gl.glUseProgram(self._dispatch.glo)
        unit = self._dispatch.images["u_out"].unit
        gl.glBindImageTexture(unit, self._texture.glo, 0, 0, 0, e.WRITE_ONLY, 0x822E)
        gl.glDispatchCompute(_SIZE // 8, _SIZE // 8, 1)

    def _calibrate(self, program: LinkedProgram, load: Callable[[], None]) -> None:
        """Double the loop's steps until the load is long enough. The first run may compile and does not count."""
        steps = 16
        while True:
            program.set_uniforms({"u_steps": steps})
            load()
            self._device.finish()
            if min(self._time(load) for _ in range(2)) >= _ENOUGH_NS or steps >= _MOST_STEPS:
                return
            steps *= 2

    def _time(self, load: Callable[[], None]) -> int:
        start = time.perf_counter_ns()
        load()
        self._device.finish()
        return time.perf_counter_ns() - start

    def release(self) -> None:
        """Delete what was made, except the programs, which the device's cache keeps; leave nothing bound."""
        gl = self._device.gl
        gl.glBindFramebuffer(e.DRAW_FRAMEBUFFER, 0)
        gl.glBindVertexArray(0)
        gl.glUseProgram(0)
        destroy_framebuffer(self._device, self._target)
        destroy_texture(self._device, self._texture)
        self._device.delete_object("glDeleteVertexArrays", self._vertices)
