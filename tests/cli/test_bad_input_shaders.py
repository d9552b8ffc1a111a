"""Shaders with mistakes: told at the author's own file, line and column; nothing is written."""

from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import PAINT, SHADER, SHOW, A, assert_refused, write_graph

pytestmark = pytest.mark.gpu

HEAD = "#version 450\n"
TAIL = "out vec4 o_color;\nvoid main() { o_color = vec4(1.0); }\n"

SHADERS: dict[str, tuple[str | bytes, str, str]] = {
    "unknown function": (
        HEAD + "out vec4 o_color;\nvoid main() {\n  o_color = vec5(1);\n}\n", "RG515", "paint.frag:4:12",
    ),
    "no semicolon": (HEAD + TAIL.replace(");", ")"), "RG515", "paint.frag:3:"),
    "empty": ("", "RG515", "paint.frag:1:"),
    "in an include": (HEAD + '#include "part.glsl"\n' + TAIL, "RG515", "part.glsl:2:"),
    "after an include": (
        HEAD + "#include <frame.glsl>\n" + TAIL.replace("vec4(1.0)", "nothing"), "RG515", "paint.frag:4:",
    ),
    "include missing": (HEAD + '#include "gone.glsl"\n' + TAIL, "RG511", "paint.frag:2:1"),
    "shared include missing": (HEAD + "#include <gone.glsl>\n" + TAIL, "RG511", "paint.frag:2:1"),
    "include in a circle": (HEAD + '#include "loop.glsl"\n' + TAIL, "RG512", "loop.glsl:1:1"),
    "include outside": (HEAD + '#include "../../secret.glsl"\n' + TAIL, "RG513", "paint.frag:2:1"),
    "include malformed": (HEAD + "#include gone.glsl\n" + TAIL, "RG514", "paint.frag:2:1"),
    "does not link": (
        HEAD + "in vec3 v_nothing;\n" + TAIL.replace("vec4(1.0)", "v_nothing.xyzz"), "RG516", "graph.yaml:6:3",
    ),
    "no output": (HEAD + "void main() {}\n", "RG569", "graph.yaml:6:3"),
    "output elsewhere": (HEAD + "layout(location = 1) " + TAIL, "RG569", "location 0"),
    "not UTF-8": ((HEAD + TAIL).encode() + b"// caf\xe9\n", "RG510", "0xE9"),
    "garbage": (bytes(range(128, 256)), "RG510", "paint.frag"),
    "unbound sampler": (
        HEAD + "uniform sampler2D u_gone;\n" + TAIL.replace("vec4(1.0)", "texture(u_gone, vec2(0))"),
        "RG566", "u_gone",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHADERS)
def test_shader_with_a_mistake(rg: Rg, tmp_path: Path, name: str) -> None:
    text, code, named = SHADERS[name]
    (tmp_path / "part.glsl").write_text("float f(float x) {\n  return y;\n}\n")
    (tmp_path / "loop.glsl").write_text('#include "loop.glsl"\n')
    out = tmp_path / "out"
    outcome = rg("render", str(write_graph(tmp_path, shader=text)), "-o", str(out))
    assert_refused(outcome, 1, code, named, "graph.yaml:6:3" if code in ("RG515", "RG516", "RG510") else named)
    assert not out.exists()


@pytest.mark.parametrize(
    ("given", "code", "named"),
    [
        ("{u_k: 3}", "RG517", "vec2"),
        ("{u_k: [1, 2, 3]}", "RG517", "vec2"),
        ("{u_n: 1.5}", "RG517", "int"),
        ("{u_n: 3000000000}", "RG517", "int"),
        ("{u_q: 1}", "RG518", "u_q"),
    ],
)
def test_uniform_of_the_wrong_type(rg: Rg, tmp_path: Path, given: str, code: str, named: str) -> None:
    shader = HEAD + "uniform vec2 u_k;\nuniform int u_n;\n" + TAIL.replace("vec4(1.0)", "vec4(u_k, u_n, 1)")
    passes = PAINT.replace("paint.frag", f"paint.frag, uniforms: {given}") + SHOW
    out = tmp_path / "out"
    outcome = rg("render", str(write_graph(tmp_path, passes=passes, shader=shader)), "-o", str(out))
    assert_refused(outcome, 1, code, named, "graph.yaml:6:3")
    assert not out.exists()


@pytest.mark.parametrize(("bits", "value"), [("0x7fc00000u", "nan"), ("0x7f800000u", "inf"), ("0xff800000u", "-inf")])
def test_what_is_not_finite_is_found(rg: Rg, tmp_path: Path, bits: str, value: str) -> None:
    there = "gl_FragCoord.xy == vec2(3.5, 2.5)"
    graph = str(write_graph(tmp_path, shader=SHADER.replace("0.5,", f"{there} ? uintBitsToFloat({bits}) : 0.5,")))
    out = tmp_path / "out"
    outcome = rg("render", graph, "-o", str(out), "--check-finite", "--samples", "0")
    assert_refused(outcome, 1, "RG565", "'paint.", "'a'", "(3, 2)", value, "graph.yaml:6:3")
    assert not out.exists()
    assert rg("render", graph, "-o", str(out), "--samples", "0").code == 0  # without the check it is not an error


def test_an_array_of_outputs_has_a_location_for_each(rg: Rg, tmp_path: Path) -> None:
    text = HEAD + "out vec4 o_all[2];\nvoid main() { o_all[0] = vec4(1.0); o_all[1] = vec4(0.5); }\n"
    graph = write_graph(
        tmp_path,
        resources=A + A.replace("a:", "b:"),
        passes=PAINT.replace("o_color: a", "one: a, two: b"),
        outputs="{a: {file: a.png}, b: {file: b.png}}",
        shader=text,
    )
    outcome = rg("render", str(graph), "-o", str(tmp_path / "out"), "--samples", "0")
    assert outcome.code == 0, outcome.err


def test_nothing_of_an_earlier_run_is_touched(rg: Rg, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert rg("render", str(write_graph(tmp_path)), "-o", str(out), "--samples", "0").code == 0
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    broken = write_graph(tmp_path, shader=SHADER.replace("vec4(", "vec5("))
    assert rg("render", str(broken), "-o", str(out)).code == 1
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
