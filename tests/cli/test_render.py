"""`rg render` and `rg doctor` on this machine's renderer."""

import json
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import Rg
from tests.cli.test_inspect import GRAPH, SHADER

pytestmark = pytest.mark.gpu


@pytest.fixture
def graph(tmp_path: Path) -> Path:
    """A two-pass graph in a folder of its own."""
    (tmp_path / "paint.frag").write_text(SHADER)
    path = tmp_path / "graph.yaml"
    path.write_text(GRAPH)
    return path


def test_render_writes_images_and_records(rg: Rg, graph: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    outcome = rg("render", str(graph), "-o", str(out), "--capture", "a", "--samples", "2")
    assert outcome.code == 0, outcome.err
    assert sorted(p.name for p in out.iterdir()) == ["a.exr", "a.png", "image.png", "resources.json", "timing.json"]
    with Image.open(out / "image.png") as image:
        assert image.size == (64, 36)
        # linear 0.5, 0.25, 0.125 in sRGB: 187.5, 136.9, 99.1 (within dither)
        assert all(abs(a - b) <= 1.6 for a, b in zip(image.getpixel((5, 5)), (187.5, 136.9, 99.1), strict=True))
    timing = json.loads((out / "timing.json").read_text())
    assert timing["schema"] == "rendergraph.timing/1"
    assert timing["timed_frames"] == 2
    assert [p["name"] for p in timing["passes"]] == ["paint", "show"]
    assert all(len(p["ms"]["samples"]) == 2 for p in timing["passes"])
    assert timing["steady_state"] == {"objects_created": 0, "programs_compiled": 0, "bytes_uploaded": 0}
    assert "Pass times" in outcome.out
    assert "Target lifetimes" in outcome.out


def test_render_json_on_stdout(rg: Rg, graph: Path, tmp_path: Path) -> None:
    outcome = rg("render", str(graph), "-o", str(tmp_path / "o"), "--format", "json", "--samples", "0")
    assert json.loads(outcome.out)["resources"]["order"]


def test_set_and_size_and_frames(rg: Rg, graph: Path, tmp_path: Path) -> None:
    out = tmp_path / "o"
    set_ = "outputs.image.file=frame_{frame}.png"
    outcome = rg(
        "render", str(graph), "-o", str(out), "--size", "10x20", "--frames", "2", "--set", set_, "--samples", "0"
    )
    assert outcome.code == 0, outcome.err
    assert {p.name for p in out.glob("*.png")} == {"frame_0000.png", "frame_0001.png"}
    with Image.open(out / "frame_0001.png") as image:
        assert image.size == (10, 20)


def test_a_shader_that_does_not_compile_names_its_line(rg: Rg, graph: Path, tmp_path: Path) -> None:
    (tmp_path / "paint.frag").write_text(
        "#version 450\nout vec4 o_color;\nvoid main() {\n    o_color = vec5(1.0);\n}\n"
    )
    outcome = rg("render", str(graph), "-o", str(tmp_path / "o"))
    assert outcome.code == 1
    assert "paint.frag:4:" in outcome.err
    assert "RG515" in outcome.err
    assert not (tmp_path / "o").exists()


def test_check_finite_names_pass_texel_and_value(rg: Rg, graph: Path, tmp_path: Path) -> None:
    bad = SHADER.replace("0.5,", "gl_FragCoord.x == 3.5 && gl_FragCoord.y == 2.5 ? uintBitsToFloat(0x7fc00000u) : 0.5,")
    (tmp_path / "paint.frag").write_text(bad)
    assert rg("render", str(graph), "-o", str(tmp_path / "o"), "--samples", "0").code == 0
    outcome = rg("render", str(graph), "-o", str(tmp_path / "p"), "--samples", "0", "--check-finite")
    assert outcome.code == 1
    assert "RG565" in outcome.err
    assert "(3, 2)" in outcome.err
    assert "paint" in outcome.err
    assert "nan" in outcome.err
    assert not (tmp_path / "p").exists()


def test_a_sampler_nothing_binds_is_an_error(rg: Rg, graph: Path, tmp_path: Path) -> None:
    text = "#version 450\nuniform sampler2D u_gone;\nout vec4 o_color;\n"
    text += "void main() { o_color = texelFetch(u_gone, ivec2(0), 0); }"
    (tmp_path / "paint.frag").write_text(text)
    outcome = rg("render", str(graph), "-o", str(tmp_path / "o"))
    assert outcome.code == 1
    assert "RG566" in outcome.err
    assert "u_gone" in outcome.err


def test_unknown_capture_exits_2(rg: Rg, graph: Path, tmp_path: Path) -> None:
    outcome = rg("render", str(graph), "-o", str(tmp_path / "o"), "--capture", "nothing")
    assert outcome.code == 2
    assert "RG564" in outcome.err


def test_output_folder_that_is_a_file_exits_2(rg: Rg, graph: Path, tmp_path: Path) -> None:
    (tmp_path / "o").write_text("")
    outcome = rg("render", str(graph), "-o", str(tmp_path / "o"), "--samples", "0")
    assert outcome.code == 2
    assert "RG560" in outcome.err


def test_doctor_is_content_here(rg: Rg) -> None:
    outcome = rg("doctor", "--format", "json")
    assert outcome.code == 0
    assert all(check["ok"] for check in json.loads(outcome.out))
