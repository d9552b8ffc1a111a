"""Runs a function of the shared GLSL over rows of numbers, as a compute shader: unit tests for shader code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.device import enums
from rendergraph.device.buffers import create_buffer, read_buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import compile_program
from rendergraph.plan.graph import Program

BUFFER_UPDATE_BARRIER_BIT = 0x200

F32 = npt.NDArray[np.float32]

_SHADER = """\
#version 450
{includes}
layout(local_size_x = 64) in;
layout(std430) readonly buffer Inputs {{ float inputs[]; }};
layout(std430) writeonly buffer Outputs {{ float outputs[]; }};
uniform uint u_rows;
{functions}
void main() {{
    uint row = gl_GlobalInvocationID.x;
    if (row >= u_rows) {{
        return;
    }}
    uint i = row * {columns}u;
    uint o = row * {results}u;
{body}
}}
"""


def run_shader_function(
    device: Device,
    folder: Path,
    body: str,
    inputs: Any,
    results: int,
    *,
    includes: tuple[str, ...],
    functions: str = "",
    defines: dict[str, int] | None = None,
    blocks: dict[str, bytes] | None = None,
) -> F32:
    """``float32[rows, results]`` written as ``outputs[o + k]`` by ``body``, which reads ``inputs[i + k]``.

    ``blocks`` are further uniform or storage blocks by name.
    """
    rows = np.ascontiguousarray(inputs, dtype=np.float32)
    text = _SHADER.format(
        includes="\n".join(f"#include <{name}>" for name in includes),
        functions=functions, columns=rows.shape[1], results=results, body=body,
    )  # fmt: skip
    path = folder / "shader_function.comp"
    path.write_text(text)
    variant = {"DEPTH_REVERSED": 1} | (defines or {})
    program = compile_program(
        device,
        Program((("compute", path),), tuple(sorted((key, str(value)) for key, value in variant.items()))),
        uniforms={"u_rows": len(rows)},
    )
    output = create_buffer(device, 4 * results * len(rows), "outputs")
    data = {"Inputs": create_buffer(device, rows, "inputs"), "Outputs": output}
    data |= {name: create_buffer(device, content, name) for name, content in (blocks or {}).items()}
    for target, found in (
        (enums.SHADER_STORAGE_BUFFER, program.storage_blocks),
        (enums.UNIFORM_BUFFER, program.uniform_blocks),
    ):
        for name, block in found.items():
            device.gl.glBindBufferRange(target, block.binding, data[name].glo, 0, data[name].bytes)
    device.gl.glUseProgram(program.glo)
    device.gl.glDispatchCompute(-(-len(rows) // 64), 1, 1)
    device.gl.glMemoryBarrier(BUFFER_UPDATE_BARRIER_BIT)
    result = np.frombuffer(read_buffer(device, output), dtype=np.float32).reshape(len(rows), results)
    for buffer in data.values():
        device.delete_object("glDeleteBuffers", buffer.glo)
    device.check()
    return result
