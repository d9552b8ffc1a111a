"""Programs: compiled once per text and uniform values, reflected, with every unit and binding assigned at link time."""

from __future__ import annotations

import ctypes
import difflib
import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import moderngl

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.gl import GL
from rendergraph.device.includes import FileTable, preprocess
from rendergraph.device.interrupts import held_back
from rendergraph.device.reflection import Block, Interface, Uniform, Unit, reflect
from rendergraph.device.shader_errors import decode_compile_log
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Position, Program, UniformValue

_SUFFIX: Final = {"float": "fv", "int": "iv", "uint": "uiv", "bool": "iv"}
_C_TYPE: Final[dict[str, Any]] = {
    "float": ctypes.c_float, "int": ctypes.c_int, "uint": ctypes.c_uint, "bool": ctypes.c_int,
}  # fmt: skip
_RANGE: Final = {"int": (-(2**31), 2**31 - 1), "uint": (0, 2**32 - 1), "bool": (0, 1)}


@dataclass(frozen=True, slots=True)
class LinkedProgram:
    """A program ready to use. ``interface`` says what it declares; its samplers, images and blocks have their units."""

    glo: int
    handle: Any  # moderngl.Program or moderngl.ComputeShader
    label: str
    interface: Interface
    work_group: tuple[int, int, int] | None
    _gl: GL
    _sources: tuple[str, ...]

    @property
    def uniforms(self) -> dict[str, Uniform]:
        """Uniforms outside blocks."""
        return self.interface.uniforms

    @property
    def samplers(self) -> dict[str, Unit]:
        """Samplers and their texture units."""
        return self.interface.samplers

    @property
    def images(self) -> dict[str, Unit]:
        """Images and their image units."""
        return self.interface.images

    @property
    def uniform_blocks(self) -> dict[str, Block]:
        """Uniform blocks and their binding points."""
        return self.interface.uniform_blocks

    @property
    def storage_blocks(self) -> dict[str, Block]:
        """Shader storage blocks and their binding points."""
        return self.interface.storage_blocks

    @property
    def attributes(self) -> dict[str, int]:
        """Vertex inputs and their locations."""
        return self.interface.attributes

    def set_uniforms(self, values: Mapping[str, UniformValue], position: Position | None = None) -> None:
        """Set uniforms outside blocks; they stay set. Arrays and matrices (column by column) are flat tuples.

        A name the shader declares but does not use is skipped: a variant may compile it away.

        :raises RenderGraphError: RG517 wrong type or number of values, RG518 no such uniform.
        """
        for name, value in values.items():
            uniform = self.uniforms.get(name)
            if uniform is not None:
                self._set(name, uniform, value, position)
            elif not any(re.search(rf"\b{re.escape(name)}\b", source) for source in self._sources):
                raise RenderGraphError([self._unknown(name, position)])

    def _unknown(self, name: str, position: Position | None) -> Any:
        close = difflib.get_close_matches(name, self.uniforms, 1)
        known = ", ".join(self.uniforms) or "none"
        hint = f"did you mean '{close[0]}'?" if close else f"it has: {known}"
        return diagnose("RG518", position, program=self.label, name=name, hint=hint)

    def _set(self, name: str, uniform: Uniform, value: UniformValue, position: Position | None) -> None:
        values = value if isinstance(value, tuple | list) else (value,)
        total = uniform.components * uniform.count
        fits = len(values) % uniform.components == 0 and 0 < len(values) <= total
        if not fits or not all(_is_a(uniform.scalar, item) for item in values):
            expected = uniform.type + (f"[{uniform.count}]" if uniform.count > 1 else "")
            raise RenderGraphError([
                diagnose("RG517", position, name=name, expected=expected, got=repr(value), count=total)
            ])  # fmt: skip
        array = (_C_TYPE[uniform.scalar] * len(values))(*values)
        elements = len(values) // uniform.components
        if uniform.type.startswith("mat"):
            call = getattr(self._gl, f"glProgramUniformMatrix{uniform.type[-1]}fv")
            call(self.glo, uniform.location, elements, 0, array)
        else:
            call = getattr(self._gl, f"glProgramUniform{uniform.components}{_SUFFIX[uniform.scalar]}")
            call(self.glo, uniform.location, elements, array)


def _is_a(scalar: str, value: float | int) -> bool:
    if scalar == "float":
        return isinstance(value, int | float)
    low, high = _RANGE[scalar]
    return isinstance(value, int) and low <= value <= high


def compile_program(
    device: Device,
    program: Program,
    position: Position | None = None,
    uniforms: Mapping[str, UniformValue] | None = None,
    include_dirs: Sequence[Path] = (),
) -> LinkedProgram:
    """Compile, link and reflect a program; the same text with the same ``uniforms`` is compiled once a device.

    ``uniforms`` are set once. ``position`` is where the graph asks for it; ``include_dirs`` see :func:`preprocess`.

    :raises RenderGraphError: RG510..RG514 from the preprocessor, RG515 for each compile error at its place in the
        author's shader, RG516 when the stages do not link, RG517 and RG518 from the uniforms.
    """
    expanded = {stage: preprocess(path, program.defines, include_dirs, position) for stage, path in program.stages}
    values = tuple(sorted((uniforms or {}).items()))
    text = repr([(stage, source) for stage, (source, _) in sorted(expanded.items())] + [values])
    key = hashlib.sha256(text.encode()).hexdigest()
    if key not in device.programs:
        linked = _link(device, program, expanded, position)
        linked.set_uniforms(uniforms or {}, position)
        device.programs[key] = linked
    found: LinkedProgram = device.programs[key]
    return found


def _link(
    device: Device, program: Program, expanded: Mapping[str, tuple[str, FileTable]], position: Position | None
) -> LinkedProgram:
    label = " + ".join(path.name for _, path in program.stages)
    sources = {f"{stage}_shader": source for stage, (source, _) in expanded.items()}
    try:
        with held_back():
            if program.is_compute:
                handle = device.ctx.compute_shader(sources["compute_shader"])
            else:
                handle = device.ctx.program(**sources)
    except moderngl.Error as error:
        device.debug.take_errors()
        raise RenderGraphError(_explain(str(error), label, expanded, position)) from None
    device.counters.programs_compiled += 1
    device.name(e.PROGRAM, handle.glo, label)
    device.debug.subject = label
    interface = reflect(device.gl, handle.glo)
    work_group = None
    if program.is_compute:
        size = (ctypes.c_int * 3)()
        device.gl.glGetProgramiv(handle.glo, e.COMPUTE_WORK_GROUP_SIZE, size)
        work_group = (size[0], size[1], size[2])
    device.check()
    device.debug.subject = ""
    return LinkedProgram(
        handle.glo, handle, label, interface, work_group, device.gl, tuple(sources.values())
    )  # fmt: skip


def _explain(
    report: str, label: str, expanded: Mapping[str, tuple[str, FileTable]], position: Position | None
) -> list[Any]:
    """The report is a title, the stage, an underline, and the driver's log."""
    title, _, rest = report.partition("\n")
    stage, _, log = rest.strip().partition("\n")
    log = log.lstrip("=\n")
    stage = stage.strip().removesuffix("_shader")
    if "Compiler" in title and stage in expanded:
        return list(decode_compile_log(log, stage, expanded[stage][1], position))
    detail = " ".join(log.split()) or "the driver gives no reason"
    return [diagnose("RG516", position, program=label, detail=detail)]
