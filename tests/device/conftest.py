"""A way to run one shader: full-screen draws and dispatches with textures bound by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.framebuffers import Framebuffer, bind_framebuffer, create_framebuffer, destroy_framebuffer
from rendergraph.device.includes import SHARED
from rendergraph.device.programs import LinkedProgram, compile_program
from rendergraph.device.textures import Texture, create_texture, destroy_texture, read_texture
from rendergraph.plan.graph import Program, TextureDesc

Compile = Callable[..., LinkedProgram]


@pytest.fixture
def compile_text(device: Device, tmp_path: Path) -> Compile:
    """Compiles stages given as text: ``compile_text(fragment="...", vertex="...")``; full-screen without a vertex."""

    def compile_stages(defines: dict[str, str] | None = None, uniforms=None, **stages: str) -> LinkedProgram:
        files = []
        for stage, text in stages.items():
            path = tmp_path / f"{stage}.glsl"
            path.write_text(text)
            files.append((stage, path))
        if "compute" not in stages and "vertex" not in stages:
            files.append(("vertex", SHARED / "fullscreen.vert"))
        program = Program(tuple(sorted(files)), tuple(sorted((defines or {}).items())))
        return compile_program(device, program, uniforms=uniforms)

    return compile_stages


@pytest.fixture
def vertex_array(device: Device) -> Iterator[int]:
    """A vertex array without inputs."""
    name = device.create_object("glCreateVertexArrays", label="test")
    yield name
    device.delete_object("glDeleteVertexArrays", name)


@pytest.fixture
def draw(device: Device, vertex_array: int) -> Callable[..., None]:
    """Draws a full-screen triangle (or ``count`` vertices) into a framebuffer, ``instances`` times."""

    def run(program: LinkedProgram, target: Framebuffer, count: int = 3, instances: int = 1) -> None:
        bind_framebuffer(device, target)
        device.gl.glUseProgram(program.glo)
        device.gl.glBindVertexArray(vertex_array)
        device.gl.glDrawArraysInstanced(e.TRIANGLES, 0, count, instances)
        device.gl.glBindFramebuffer(e.DRAW_FRAMEBUFFER, 0)
        device.check()

    return run


@pytest.fixture
def shade(device: Device, compile_text: Compile, draw) -> Callable[..., np.ndarray]:
    """The rgba32f picture of a fragment shader's body that writes ``o_color``, with textures and samplers by name."""

    def run(
        body: str, textures: dict[str, tuple[Texture, int]] | None = None, size: tuple[int, int] = (4, 4)
    ) -> np.ndarray:
        program = compile_text(fragment=f"in vec2 v_uv;\nout vec4 o_color;\n{body}")
        for name, (texture, sampler) in (textures or {}).items():
            device.gl.glBindTextureUnit(program.samplers[name].unit, texture.glo)
            device.gl.glBindSampler(program.samplers[name].unit, sampler)
        target = create_texture(device, TextureDesc("rgba32f", *size), "picture")
        framebuffer = create_framebuffer(device, [(target, 0, None)], None, "picture")
        draw(program, framebuffer)
        pixels = read_texture(device, target)
        destroy_framebuffer(device, framebuffer)
        destroy_texture(device, target)
        return pixels

    return run
