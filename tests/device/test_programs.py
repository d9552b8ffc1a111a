"""Programs: reflection, uniforms, caching, and compile errors at their place in the author's files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rendergraph.device import enums as e
from rendergraph.device.buffers import create_buffer, read_buffer
from rendergraph.device.context import Device
from rendergraph.device.includes import FileTable
from rendergraph.device.programs import compile_program
from rendergraph.device.shader_errors import decode_compile_log
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.graph import Position, Program


def error_of(call, *arguments, **more) -> RenderGraphError:
    with pytest.raises(RenderGraphError) as caught:
        call(*arguments, **more)
    return caught.value


def test_reflection_names_everything(compile_text) -> None:
    program = compile_text(
        compute="""
layout(local_size_x = 8, local_size_y = 4) in;
layout(std140) uniform Camera { mat4 view; };
layout(std430) readonly buffer Input { float values[]; };
layout(std430) buffer Output { vec4 head; vec4 results[]; };
uniform sampler2D u_color;
uniform usampler2DArray u_ids[3];
uniform sampler2DShadow u_shadow;
layout(rgba16f) writeonly uniform image2D u_out;
layout(r32ui) uniform uimage3D u_volume;
uniform float u_radius;
uniform vec3 u_weights[4];
uniform mat3 u_turn;
uniform int u_unused;
void main() {
    uint id = texelFetch(u_ids[2], ivec3(0), 0).r + texelFetch(u_ids[0], ivec3(0), 0).r;
    vec3 sum = u_turn * (u_weights[0] + u_weights[3]) * u_radius;
    float lit = texture(u_shadow, vec3(0.5)) + values[id];
    results[id] = view * vec4(sum, lit) + textureLod(u_color, vec2(0), 0.0) + head;
    imageStore(u_out, ivec2(0), vec4(1));
    imageAtomicAdd(u_volume, ivec3(0), 1u);
}"""
    )
    interface = program.interface
    assert program.work_group == (8, 4, 1)
    assert {n: (s.type, s.count) for n, s in program.samplers.items()} == {
        "u_color": ("sampler2D", 1), "u_ids": ("usampler2DArray", 3), "u_shadow": ("sampler2DShadow", 1),
    }  # fmt: skip
    taken = [s.unit + i for s in program.samplers.values() for i in range(s.count)]
    assert sorted(taken) == list(range(5)), "each sampler has a unit of its own"
    assert {n: i.type for n, i in program.images.items()} == {"u_out": "image2D", "u_volume": "uimage3D"}
    assert sorted(i.unit for i in program.images.values()) == [0, 1]
    assert set(program.uniform_blocks) == {"Camera"}
    assert program.uniform_blocks["Camera"].bytes == 64
    assert set(program.storage_blocks) == {"Input", "Output"}
    assert len({b.binding for b in program.storage_blocks.values()}) == 2
    assert program.storage_blocks["Output"].bytes == 32
    assert {n: (u.type, u.count) for n, u in program.uniforms.items()} == {
        "u_radius": ("float", 1), "u_weights": ("vec3", 4), "u_turn": ("mat3", 1),
    }  # fmt: skip
    assert interface.unsupported == ()


def test_vertex_inputs_and_outputs(compile_text) -> None:
    program = compile_text(
        vertex="layout(location = 3) in vec4 in_position;\nvoid main() { gl_Position = in_position; }",
        fragment="layout(location = 1) out vec4 o_b;\nlayout(location = 0) out vec4 o_a;\n"
        "void main() { o_a = o_b = vec4(1); }",
    )
    assert program.attributes == {"in_position": 3}
    assert program.interface.outputs == {"o_a": 0, "o_b": 1}


def test_bindings_reach_the_right_blocks_and_images(device: Device, compile_text) -> None:
    program = compile_text(
        compute="""
layout(local_size_x = 4) in;
buffer Zebra { uint stripes[]; };
readonly buffer Apple { uint seeds[]; };
void main() { stripes[gl_GlobalInvocationID.x] = seeds[gl_GlobalInvocationID.x] * 2u; }"""
    )
    apple = create_buffer(device, np.arange(4, dtype=np.uint32), "apple")
    zebra = create_buffer(device, 16, "zebra")
    for name, buffer in (("Apple", apple), ("Zebra", zebra)):
        device.gl.glBindBufferBase(e.SHADER_STORAGE_BUFFER, program.storage_blocks[name].binding, buffer.glo)
    device.gl.glUseProgram(program.glo)
    device.gl.glDispatchCompute(1, 1, 1)
    device.gl.glMemoryBarrier(e.ALL_BARRIER_BITS)
    assert np.frombuffer(read_buffer(device, zebra), np.uint32).tolist() == [0, 2, 4, 6]
    for buffer in (apple, zebra):
        device.delete_object("glDeleteBuffers", buffer.glo)


UNIFORMS = """
layout(local_size_x = 1) in;
uniform float u_float; uniform int u_int; uniform uint u_uint; uniform bool u_bool;
uniform vec2 u_vec2; uniform ivec3 u_ivec3; uniform uvec4 u_uvec4; uniform float u_array[3];
uniform mat2 u_mat2; uniform mat4 u_mat4; uniform int u_unused;
buffer Result { float r[]; };
void main() {
    r[0] = u_float; r[1] = float(u_int); r[2] = float(u_uint); r[3] = u_bool ? 1.0 : 0.0;
    r[4] = u_vec2.y; r[5] = float(u_ivec3.z); r[6] = float(u_uvec4.w); r[7] = u_array[2];
    r[8] = u_mat2[1][0]; r[9] = u_mat4[3][1];
}"""


def test_uniforms_of_every_type_arrive(device: Device, compile_text) -> None:
    program = compile_text(compute=UNIFORMS)
    program.set_uniforms({
        "u_float": 2, "u_int": -3, "u_uint": 4, "u_bool": True, "u_vec2": (0.0, 5.0), "u_ivec3": (0, 0, -6),
        "u_uvec4": (0, 0, 0, 7), "u_array": (0.0, 0.0, 8.0), "u_mat2": (1.0, 2.0, 9.0, 4.0),
        "u_mat4": tuple(float(i) for i in range(16)), "u_unused": 1,
    })  # fmt: skip
    result = create_buffer(device, 40, "result")
    device.gl.glBindBufferBase(e.SHADER_STORAGE_BUFFER, program.storage_blocks["Result"].binding, result.glo)
    device.gl.glUseProgram(program.glo)
    device.gl.glDispatchCompute(1, 1, 1)
    device.gl.glMemoryBarrier(e.ALL_BARRIER_BITS)
    got = np.frombuffer(read_buffer(device, result), np.float32).tolist()
    assert got == [2, -3, 4, 1, 5, -6, 7, 8, 9, 13]
    device.delete_object("glDeleteBuffers", result.glo)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("u_int", 1.5), ("u_uint", -1), ("u_int", 2**31), ("u_bool", 2), ("u_float", (1.0, 2.0)), ("u_vec2", 1.0),
        ("u_vec2", (1.0, 2.0, 3.0)), ("u_array", (1.0,) * 4), ("u_float", "1"), ("u_ivec3", (1, 2, 3.0)),
        ("u_mat2", (1.0,) * 3), ("u_float", ()),
    ],
)  # fmt: skip
def test_wrong_uniform_values_are_refused(compile_text, name: str, value) -> None:
    at = Position("graph.yaml", 3, 5)
    error = error_of(compile_text(compute=UNIFORMS).set_uniforms, {name: value}, at)
    assert error.diagnostics[0].code == "RG517"
    assert error.diagnostics[0].data["name"] == name
    assert error.diagnostics[0].position == at


def test_unknown_uniforms_are_refused_with_the_nearest_name(compile_text) -> None:
    error = error_of(compile_text(compute=UNIFORMS).set_uniforms, {"u_flaot": 1.0})
    assert error.diagnostics[0].code == "RG518"
    assert "u_float" in error.diagnostics[0].data["hint"]


def test_the_same_text_is_compiled_once_for_the_same_uniforms(device: Device, compile_text) -> None:
    text = "uniform float u_x;\nout vec4 o;\nvoid main() { o = vec4(u_x, SCALE, 0, 1); }"
    first = compile_text({"SCALE": "1.25"}, fragment=text)
    before = device.counters.snapshot()
    assert compile_text({"SCALE": "1.25"}, fragment=text) is first
    assert (device.counters - before).programs_compiled == 0
    assert compile_text({"SCALE": "1.5"}, fragment=text) is not first
    two = compile_text({"SCALE": "1.25"}, {"u_x": 2.0}, fragment=text)
    three = compile_text({"SCALE": "1.25"}, {"u_x": 3.0}, fragment=text)
    assert len({first.glo, two.glo, three.glo}) == 3, "uniforms stay with their program"
    assert (device.counters - before).programs_compiled == 3


def test_compile_errors_are_placed_in_nested_includes(device: Device, tmp_path: Path) -> None:
    (tmp_path / "deep.glsl").write_text(
        "float half_of(float x) {\n    return x * 0.5;\n}\nfloat bad() {\n    return nope;\n}\n"
    )
    (tmp_path / "inner.glsl").write_text('#include "deep.glsl"\nfloat good() { return 1.0; }\n')
    root = tmp_path / "root.frag"
    root.write_text('#version 450\n#include "inner.glsl"\nout vec4 o;\nvoid main() {\n    o = vec4(also_nope);\n}\n')
    program = Program((("fragment", root),), (("A", "1"), ("B", "2")))
    error = error_of(compile_program, device, program, Position("graph.yaml", 7, 3))
    places = {(Path(d.position.file).name, d.position.line) for d in error.diagnostics}
    assert {d.code for d in error.diagnostics} == {"RG515"}
    assert places == {("deep.glsl", 5), ("root.frag", 5)}
    if device.info.is_software:
        assert {d.position.column for d in error.diagnostics if d.position.file.endswith("deep.glsl")} == {9}
    device.check()


def test_syntax_errors_and_bad_versions_are_placed(device: Device, tmp_path: Path) -> None:
    for text, line in (("#version 450\nout vec4 o\nvoid main() {}\n", 3), ("#version 999\nvoid main() {}\n", 1)):
        root = tmp_path / f"bad{line}.frag"
        root.write_text(text)
        error = error_of(compile_program, device, Program((("fragment", root),)))
        assert error.diagnostics[0].code == "RG515"
        assert error.diagnostics[0].position.line == line


def test_link_errors(compile_text, device: Device) -> None:
    mismatch = error_of(
        compile_text,
        vertex="out vec2 v_a;\nvoid main() { v_a = vec2(0); gl_Position = vec4(0); }",
        fragment="in vec3 v_a;\nout vec4 o;\nvoid main() { o = vec4(v_a, 1); }",
    )
    assert mismatch.diagnostics[0].code == "RG516"
    shared = (
        "layout(local_size_x = 1) in;\nshared float s[1000000];\nbuffer B { uint i; float r; };\n"
        "void main() { s[i] = 1.0; barrier(); r = s[i + 1u]; }"
    )
    assert error_of(compile_text, compute=shared).diagnostics[0].code in ("RG515", "RG516")
    device.check()


def test_includes_in_comments_do_not_reach_the_driver(compile_text) -> None:
    assert compile_text(fragment='// #include "x"\n/* #include <y> */\nout vec4 o;\nvoid main() { o = vec4(1); }').glo


# ---- dialects of other drivers, decoded without them


@pytest.mark.parametrize(
    ("line", "column"),
    [
        ("0:200007(12): error: `x' undeclared", 12),
        ("0:200007(12): preprocessor error: #error no", 12),
        ('0(200007) : error C1503: undefined variable "x"', 1),
        ("ERROR: 0:200007: 'x' : undeclared identifier", 1),
    ],
)
def test_each_dialect_is_decoded(line: str, column: int) -> None:
    files = FileTable([Path("a.frag"), Path("b.glsl")])
    log = f"0:100001(1): warning: something\n{line}\n{line}\n1 error generated"
    found = decode_compile_log(log, "fragment", files, None)
    assert [d.position for d in found] == [Position("b.glsl", 7, column)]
    assert "x" in found[0].data["detail"] or "no" in found[0].data["detail"]


def test_a_log_in_no_known_dialect_is_kept_whole() -> None:
    found = decode_compile_log("Something\nbroke", "vertex", FileTable([Path("a.vert")]), None)
    assert found[0].position == Position("a.vert", 1, 1)
    assert found[0].data["detail"] == "Something broke"
    assert decode_compile_log("", "vertex", FileTable([Path("a.vert")]), None)[0].data["detail"]


def test_a_flood_of_errors_is_cut(device: Device) -> None:
    log = "\n".join(f"0:{100000 + i}(1): error: e{i}" for i in range(1, 50))
    assert len(decode_compile_log(log, "fragment", FileTable([Path("a.frag")]), None)) == 10
