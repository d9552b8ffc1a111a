"""Graphs with mistakes: each is refused before anything runs, at its place in the file."""

from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import PAINT, SHOW, A, assert_refused, write_graph

MISTAKES = {
    "unknown node": ({"passes": PAINT + SHOW.replace("tonemap", "tonemapp")}, "RG200", 7, ["'tonemap'"]),
    "unknown port": ({"passes": PAINT + SHOW.replace("{color: a}", "{colour: a}")}, "RG201", 7, ["'color'"]),
    "unknown key": ({"passes": PAINT + SHOW.replace("read:", "raed:")}, "RG121", 7, ["read"]),
    "wrong format": ({"resources": A.replace("rgba16f", "r32ui")}, "RG320", 7, ["r32ui", "rgba16f"]),
    "unknown format": ({"resources": A.replace("rgba16f", "rgba17f")}, "RG303", 4, ["rgba16f"]),
    "size zero": ({"resources": "  a: {format: rgba16f, fixed: [0, 4]}\n"}, "RG123", 4, ["at least 1"]),
    "size above": ({"resources": "  a: {format: rgba16f, fixed: [16385, 4]}\n"}, "RG123", 4, ["16384"]),
    "memory above": (
        {"resources": "  a: {format: rgba32f, fixed: [16384, 16384], layers: 64}\n"}, "RG313", 4, ["262144 MiB"],
    ),
    "read before write": ({"passes": SHOW}, "RG231", 6, ["'a'"]),
    "two writers": ({"passes": PAINT + PAINT.replace("paint:", "again:") + SHOW}, "RG230", 7, ["paint", "again"]),
    "output nobody writes": (
        {"outputs": "{image: {file: image.png}, ghost: {file: ghost.png}}"}, "RG213", 8, ["'ghost'"],
    ),
    "shader missing": ({"passes": PAINT.replace("paint.frag", "gone.frag") + SHOW}, "RG222", 6, ["gone.frag"]),
    "shader outside": ({"passes": PAINT.replace("paint.frag", "../x.frag") + SHOW}, "RG222", 6, ["../x.frag"]),
    "wrong uniform value": (
        {"passes": PAINT.replace("paint.frag", "paint.frag, uniforms: {u_k: hello}") + SHOW}, "RG205", 6, ["u_k"],
    ),
    "output escapes": ({"outputs": "{image: {file: ../../x.png}}"}, "RG127", 8, ["../../x.png"]),
    "output absolute": ({"outputs": "{image: {file: /tmp/x.png}}"}, "RG127", 8, ["/tmp/x.png"]),
    "output suffix": ({"outputs": "{image: {file: x.gif}}"}, "RG127", 8, ["x.gif", ".png"]),
    "output name too long": ({"outputs": "{image: {file: " + "\u4e00" * 80 + ".png}}"}, "RG127", 8, ["bytes"]),
    "one file twice": ({"outputs": "{image: {file: x.png}, a: {file: x.png}}"}, "RG127", 8, ["x.png"]),
    "one file, spelled twice": ({"outputs": "{image: {file: x.png}, a: {file: ./x.png}}"}, "RG127", 8, ["x.png"]),
    "one file in some frame": (
        {"outputs": "{image: {file: 'x_{frame}.png'}, a: {file: x_0003.png}}"}, "RG127", 8, ["x_0003.png"],
    ),
    "file and folder": ({"outputs": "{image: {file: x.png}, a: {file: x.png/y.png}}"}, "RG127", 8, ["folder"]),
    "scene missing": ({"extra": "scene: {source: gone.glb}\n"}, "RG651", 3, ["gone.glb"]),
    "scene unknown": ({"extra": "scene: {source: sphers}\n"}, "RG650", 3, ["'spheres'"]),
    "scene of another kind": ({"extra": "scene: {source: house.fbx}\n"}, "RG650", 3, [".glb"]),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_is_refused_by_validate_and_render(rg: Rg, tmp_path: Path, name: str) -> None:
    change, code, line, named = MISTAKES[name]
    graph = write_graph(tmp_path, **change)
    out = tmp_path / "out"
    assert_refused(rg("validate", str(graph)), 1, code, f"graph.yaml:{line}:", *named)
    assert_refused(rg("render", str(graph), "-o", str(out)), 1, code, f"graph.yaml:{line}:", *named, folder=out)
    assert not out.exists()


def test_the_graph_without_mistakes_is_valid(rg: Rg, tmp_path: Path) -> None:
    assert rg("validate", str(write_graph(tmp_path))).code == 0


@pytest.mark.parametrize(
    "outputs",
    [
        "{image: {file: 'x_{frame}.png'}, a: {file: x_final.png}}",
        "{image: {file: x_0001.png}, a: {file: x_0002.png}}",
        "{image: {file: 'x_{frame}.png'}, a: {file: 'y_{frame}.png'}}",
        "{image: {file: sub/x.png}, a: {file: sub/y.npy}}",
    ],
)
def test_outputs_that_do_not_meet_are_fine(rg: Rg, tmp_path: Path, outputs: str) -> None:
    assert rg("validate", str(write_graph(tmp_path, outputs=outputs))).code == 0


def test_a_cycle_is_shown_as_a_path(rg: Rg, tmp_path: Path) -> None:
    circle = (
        "  one: {node: fxaa, read: {color: b}, write: {color: a}}\n"
        "  two: {node: fxaa, read: {color: a}, write: {color: b}}\n"
    )
    graph = write_graph(tmp_path, resources="  a: {format: rgba8}\n  b: {format: rgba8}\n", passes=circle,
                        outputs="{a: {file: a.png}}")  # fmt: skip
    assert_refused(rg("validate", str(graph)), 1, "RG233", "one -> two -> one", "graph.yaml:7:3")


def test_a_pass_after_itself_or_nobody(rg: Rg, tmp_path: Path) -> None:
    for after in ("show", "ghost"):
        passes = PAINT + SHOW.replace("read:", f"after: [{after}], read:")
        assert_refused(rg("validate", str(write_graph(tmp_path, passes=passes))), 1, "RG218", "graph.yaml:7:")


def test_an_unused_resource_is_only_a_warning(rg: Rg, tmp_path: Path) -> None:
    graph = write_graph(tmp_path, resources=A + "  spare: {format: r8}\n")
    outcome = rg("validate", str(graph))
    assert outcome.code == 0
    assert "RG214" in outcome.err
    assert "graph.yaml:5:3" in outcome.err
    assert "valid" in outcome.out


def test_all_mistakes_are_told_at_once(rg: Rg, tmp_path: Path) -> None:
    graph = write_graph(
        tmp_path, resources=A.replace("rgba16f", "rgba17f"), passes=PAINT + SHOW.replace("tonemap", "tonemapp"),
        outputs="{image: {file: x.gif}}",
    )  # fmt: skip
    outcome = rg("validate", str(graph))
    assert [f"graph.yaml:{line}:" in outcome.err for line in (4, 7, 8)] == [True] * 3


def test_unicode_in_titles_and_odd_file_names(rg: Rg, tmp_path: Path) -> None:
    folder = tmp_path / "Größe 測試 🎨"
    folder.mkdir()
    graph = write_graph(folder, extra="title: Größe 測試 🎨 \\u202e\n")
    assert rg("validate", str(graph)).code == 0
    assert "測試" in rg("plan", str(graph), "--format", "json").out
    broken = write_graph(folder, passes=PAINT + SHOW.replace("tonemap", "tönemap"))
    assert_refused(rg("validate", str(broken)), 1, "RG200", "tönemap", "測試")


@pytest.mark.parametrize(
    ("content", "exit_code", "code"),
    [
        (b"", 1, "RG110"),
        (b"# nothing but this\n", 1, "RG110"),
        (b"[1, 2]\n", 1, "RG110"),
        (bytes(range(128, 256)), 2, "RG102"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 2, "RG102"),
        (b"rendergraph: 1\n\tpasses: {}\n", 1, "RG104"),
        (b"rendergraph: 1\0\n", 1, "RG104"),
        (b"a: &a [*a]\n", 1, "RG109"),
        (b"[" * 5000, 1, "RG108"),
        (b"#" * (9 << 20), 2, "RG103"),
    ],
    ids=["empty", "comment", "list", "garbage", "png", "tab", "nul", "self", "deep", "large"],
)
def test_files_that_are_no_graph(rg: Rg, tmp_path: Path, content: bytes, exit_code: int, code: str) -> None:
    path = tmp_path / "odd.yaml"
    path.write_bytes(content)
    for command in (["validate"], ["plan"], ["render", "-o", str(tmp_path / "out")]):
        assert_refused(rg(*command, str(path)), exit_code, code, "odd.yaml:")
    assert not (tmp_path / "out").exists()


def test_missing_file_directory_and_loop(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    assert_refused(rg("render", str(tmp_path / "gone.yaml")), 2, "RG100", "gone.yaml")
    assert_refused(rg("render", str(tmp_path)), 2, "RG101", "directory")
    assert_refused(rg("render", str(tmp_path / "loop.yaml")), 2, "RG101", "loop.yaml")
    assert_refused(rg("render", str(tmp_path / ("x" * 300))), 2, "RG101", "too long")
    assert_refused(rg("validate", "defered_shading"), 2, "RG100", "deferred_shading")
