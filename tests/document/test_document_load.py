"""Graph files as a whole: what loads, and one test a way to be wrong, by code and place."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from sample_graph import GRAPH, BlurParams, Fail, Load, places

from rendergraph.document import source_file
from rendergraph.document.load import load_document
from rendergraph.document.messages import MESSAGES, RenderGraphError
from rendergraph.document.source_file import MAX_BYTES


def edited(old: str, new: str) -> str:
    assert old in GRAPH
    return GRAPH.replace(old, new)


def test_a_graph_loads(load: Load) -> None:
    document = load(GRAPH)
    assert document.model.frame.size == (64, 32)
    assert document.params == {"blur": BlurParams(radius=2)}
    assert document.text == GRAPH
    assert document.warnings == ()
    at = document.position("passes", "blur", "set", "radius")
    assert (Path(at.file), at.line, at.column) == (document.path, 10, 19)
    assert document.position("passes", "blur", "set", "radius", key=True).column == 11
    assert document.position("passes", "blur").line == 6
    assert document.position("passes", "blur", "set", "taps").line == 10
    assert document.position("barriers").line == 1


def test_byte_order_mark_and_line_ends(load: Load) -> None:
    document = load(b"\xef\xbb\xbf" + GRAPH.replace("\n", "\r\n").encode())
    assert document.position("passes", "blur", "node").line == 7
    assert document.position("rendergraph", key=True).column == 1


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "column"),
    [
        ("rendergraph: 1", "rendergraph: 2", "RG124", 1, 14),
        ("rendergraph: 1", "rendergraph: true", "RG122", 1, 14),
        ("rendergraph: 1\n", "", "RG120", 1, 1),
        ("frame: {size: [64, 32]}", "frame: {sise: [64, 32]}", "RG121", 2, 9),
        ("frame: {size: [64, 32]}", "frame: 7", "RG122", 2, 8),
        ("frame: {size: [64, 32]}", "frame:", "RG122", 2, 7),
        ("[64, 32]", "[64, 0]", "RG123", 2, 20),
        ("[64, 32]", "[64, 99999]", "RG123", 2, 20),
        ("[64, 32]", "[64]", "RG126", 2, 15),
        ("[64, 32]", "[64, 32, 1]", "RG126", 2, 15),
        ("[64, 32]", "[64, '32']", "RG122", 2, 20),
        ("[64, 32]", "[64, 32.0]", "RG122", 2, 20),
        ("[64, 32]", "[64, 010]", "RG112", 2, 20),
        ("{size: [64, 32]}", "{depth: standrad}", "RG124", 2, 16),
        ("{size: [64, 32]}", "{seed: -1}", "RG123", 2, 15),
        ("first: {", "1st: {", "RG125", 4, 3),
        ("first: {", "a.b: {", "RG125", 4, 3),
        ("{format: rgba8}", "{format: rgba9}", "RG303", 4, 19),
        ("{format: rgba8}", "{scale: 0.5}", "RG302", 4, 3),
        ("{format: rgba8}", "{format: rgba8, bytes: 4}", "RG301", 4, 11),
        ("{format: rgba8}", "{bytes: 6}", "RG123", 4, 18),
        ("{format: rgba8}", "{previous: image, mips: 2}", "RG301", 4, 28),
        ("{format: rgba8}", "{file: a.png, scale: 2}", "RG301", 4, 24),
        ("{format: rgba8}", "{format: rgba8, fixed: [1, 1], like: image}", "RG301", 4, 41),
        ("{format: rgba8}", "{format: rgba8, samples: 4, mips: 2}", "RG309", 4, 38),
        ("{format: rgba8}", "{format: rgba8, samples: 3}", "RG124", 4, 35),
        ("{format: rgba8}", "{format: rgba8, samples: true}", "RG122", 4, 35),
        ("{format: rgba8}", "{format: rgba8, scale: .nan}", "RG122", 4, 33),
        ("    node: blur\n", "", "RG120", 6, 3),
        ("node: blur", "node: blurr", "RG200", 7, 11),
        ("node: blur", "node: broken", "RG207", 7, 11),
        ("{color: first}", "{colour: first, color: first}", "RG201", 8, 12),
        ("{color: first}", "{mask: first}", "RG202", 8, 5),
        ("    read: {color: first}\n", "", "RG202", 6, 3),
        ("{color: image}", "{color: image, mask: image}", "RG201", 9, 27),
        ("    write: {color: image}\n", "", "RG203", 6, 3),
        ("{color: first}", "{color: [first]}", "RG122", 8, 19),
        ("{color: first}", "{color: a b}", "RG125", 8, 19),
        ("set: {radius: 2}", "set: {radius: 2, tap: 3}", "RG204", 10, 22),
        ("set: {radius: 2}", "set: {radius: 65}", "RG205", 10, 19),
        ("set: {radius: 2}", "set: {radius: two}", "RG205", 10, 19),
        ("set: {radius: 2}", "set: {radius: 2, mode: fats}", "RG205", 10, 28),
        ("set: {radius: 2}", "set: {radius: 2, taps: 2.5}", "RG205", 10, 28),
        ("set: {radius: 2}", "set: {radius: 2, offset: [1]}", "RG205", 10, 30),
        ("set: {radius: 2}", "set: {radius: 2, offset: wide}", "RG205", 10, 30),
        ("set: {radius: 2}", "set: {radius: 2, wrap: yes}", "RG205", 10, 28),
        ("set: {radius: 2}", "set: {radius: 2, taps: 4, mode: exact}", "RG205", 10, 5),
        ("set: {radius: 2}", "set: {radius: 2, taps: 13}", "RG207", 10, 5),
        ("set: {radius: 2}", "set: {radius: .inf}", "RG205", 10, 19),
        ("set: {radius: 2}", "set: {}", "RG206", 10, 5),
        ("    set: {radius: 2}\n", "", "RG206", 6, 3),
        ("set: {radius: 2}", "set: [radius]", "RG122", 10, 10),
        ("set: {radius: 2}", "set: {radius: 2}\n    taps: 3", "RG121", 11, 5),
        ("{file: image.png}", "{file: image.bmp}", "RG127", 12, 17),
        ("{file: image.png}", "{file: ../image.png}", "RG127", 12, 17),
        ("{file: image.png}", "{file: /image.png}", "RG127", 12, 17),
        ("image: {file: image.png}", "image: {file: a.png}\n  b: {file: a.png}", "RG127", 13, 7),
        ("outputs:\n  image: {file: image.png}", "outputs: {}", "RG126", 11, 10),
        ("frame:", "budget: {flip: 2}\nframe:", "RG123", 2, 16),
        ("frame:", "scene: {source: ''}\nframe:", "RG126", 2, 17),
        ("frame:", "scene: {source: x, camera: {near: 2, far: 1}}\nframe:", "RG127", 2, 38),
        ("frame:", "scene: {source: x, lights: {sun: {direction: [0, 0, 0]}}}\nframe:", "RG127", 2, 46),
        ("frame:", "scene: {source: x, lights: {list: [{position: [0, 0, 0], inner: 40}]}}\nframe:", "RG127", 2, 58),
        ("frame:", "scene: {source: x, lights: {list: [{position: [0, 0]}]}}\nframe:", "RG126", 2, 47),
        ("frame:", "title: [x]\nframe:", "RG122", 2, 8),
        ("frame:", "barriers: [{resource: a, after: b, before: c, kind: storage}]\nframe:", "RG124", 2, 53),
    ],
)
def test_one_mistake(fail: Fail, old: str, new: str, code: str, line: int, column: int) -> None:
    assert places(fail(edited(old, new))) == [(code, line, column)]


MANY = """\
rendergraph: 1
frame: {size: [0, 32], cont: 2}
resources:
  first: {format: rgba9}
  first: {bytes: 5}
passes:
  blur: {node: blur, read: {colour: first}, set: {radius: -1, tap: 1}}
  next: {node: blurr}
outputs: {image: {file: image}}
"""


def test_everything_wrong_is_reported_at_once_and_in_order(fail: Fail) -> None:
    found = fail(MANY)
    assert [d.code for d in found] == [
        "RG123", "RG121", "RG105", "RG123", "RG203", "RG202", "RG201", "RG205", "RG204", "RG200", "RG127"
    ]  # fmt: skip
    assert places(found) == sorted(places(found), key=lambda place: place[1:])


@pytest.mark.parametrize(
    ("old", "new", "suggestion"),
    [
        ("size:", "sise:", "size"),
        ("rgba8", "rgba88", "rgba8"),
        ("node: blur", "node: blir", "blur"),
        ("{color: first}", "{colr: first}", "color"),
        ("radius: 2", "radius: 2, mode: exakt", "exact"),
        ("radius: 2", "radius: 2, tapps: 1", "taps"),
        ("    set: {radius: 2}", "    set: {radius: 2}\n    radius: 2", "`set:`"),
        ("    set: {radius: 2}", "    set: {radius: 2}\n    mask: first", "`read:`"),
        ("radius: 2", "radius: 2, wrap: yes", "true"),
        ("radius: 2", "radius: 1_0", "10"),
        ("{color: image}", "{color: image, mask: first}", "`read:`"),
    ],
)
def test_help_names_what_was_meant(fail: Fail, old: str, new: str, suggestion: str) -> None:
    assert any(suggestion in d.help for d in fail(edited(old, new)))


def test_union_branches_make_one_mistake(fail: Fail) -> None:
    (found,) = fail(edited("radius: 2", "radius: 2, offset: x"))
    assert "a number or a list" in found.data["problem"]


def test_yaml_1_1_words_are_warned_about(load: Load, fail: Fail) -> None:
    document = load(edited("frame:", "title: off\nframe:"))
    assert document.model.title == "off"
    assert places(list(document.warnings)) == [("RG113", 2, 8)]
    assert [d.code for d in fail(edited("radius: 2", "radius: 2, wrap: on"))] == ["RG205"]  # not warned about as well


def test_words_as_keys_stay_text(load: Load) -> None:
    document = load(edited("first: {format", "on: {format").replace("color: first", "color: on"))
    assert "on" in document.model.resources


def test_open_ports_take_any_name(load: Load) -> None:
    document = load(
        edited("node: blur", "node: open").replace("    set: {radius: 2}\n", "").replace("{color:", "{any:")
    )
    assert set(document.params) == {"blur"}


def test_aliases_and_merge_keys(load: Load) -> None:
    text = edited("set: {radius: 2}", "set: &s {radius: 2}").replace(
        "outputs:", "  two: {node: blur, read: {color: image}, write: {color: last}, set: {<<: *s, taps: 3}}\noutputs:"
    )
    assert load(text).params["two"] == BlurParams(radius=2, taps=3)


def test_very_many_mistakes_are_cut_short(fail: Fail) -> None:
    wrong = "".join(f"  p{i}: {{node: blur, nod: {i}, set: {{rad: 1}}}}\n" for i in range(3000))
    started = time.perf_counter()
    found = fail(edited("passes:\n", f"passes:\n{wrong}"))
    assert time.perf_counter() - started < 5
    assert len(found) == 101
    assert found[-1].code == "RG114"


@pytest.mark.parametrize("text", ["", "# nothing\n", "null\n", "just text\n", "[1, 2]\n", "42\n"])
def test_no_graph(fail: Fail, text: str) -> None:
    assert places(fail(text)) == [("RG110", 1, 1)]


# ---------------------------------------------------------------- files


def failure(path: str | Path) -> tuple[str, int]:
    with pytest.raises(RenderGraphError) as error:
        load_document(path)
    (found,) = error.value.diagnostics
    return found.code, error.value.exit_code


def test_unreadable_files(tmp_path: Path) -> None:
    assert failure(tmp_path / "none.yaml") == ("RG100", 2)
    assert failure(tmp_path / "no" / "folder.yaml") == ("RG100", 2)
    assert failure(tmp_path) == ("RG101", 2)
    assert failure("a\0b") == ("RG101", 2)
    assert failure("x" * 5000) == ("RG101", 2)
    assert failure("\udcff.yaml") == ("RG100", 2)
    assert failure("") == ("RG101", 2)
    big = tmp_path / "big.yaml"
    big.write_bytes(b"#" * (MAX_BYTES + 1))
    assert failure(big) == ("RG103", 2)
    (tmp_path / "file").write_text("")
    assert failure(tmp_path / "file" / "below.yaml") == ("RG100", 2)


def test_no_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    assert failure(tmp_path / "graph.yaml") == ("RG101", 2)


@pytest.mark.parametrize(
    ("data", "line", "column", "offset"),
    [
        (b"a: 1\n\xc3\xa9: \xff\n", 2, 4, 9),
        (b"\xef\xbb\xbfa: \xe9\n", 1, 4, 6),
        ("a: 1\n".encode("utf-16"), 1, 1, 0),
        (b"\x7fELF\x02\x00\x00\xd0", 1, 8, 7),
    ],
)
def test_not_utf_8(fail: Fail, data: bytes, line: int, column: int, offset: int) -> None:
    (found,) = fail(data)
    assert places([found]) == [("RG102", line, column)]
    assert found.data["offset"] == offset


def test_shipped_graphs_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shipped = tmp_path / "shipped"
    shipped.mkdir()
    graph = GRAPH.replace("blur", "copy").replace("    set: {radius: 2}\n", "").replace("color: ", "source: ", 1)
    (shipped / "soft.yaml").write_text(graph)
    monkeypatch.setattr(source_file, "graph_folder", lambda: shipped)
    monkeypatch.chdir(tmp_path)
    assert source_file.shipped_graphs() == ("soft",)
    assert source_file.find_graph("soft") == shipped / "soft.yaml"
    (tmp_path / "soft").mkdir()  # such as an output folder
    assert source_file.find_graph("soft") == shipped / "soft.yaml"
    (tmp_path / "soft").rmdir()
    (tmp_path / "soft").write_text("")
    assert source_file.find_graph("soft") == Path("soft")
    assert source_file.find_graph("./sub/soft") == Path("sub/soft")
    with pytest.raises(RenderGraphError) as error:
        load_document("sotf")
    assert "soft" in error.value.diagnostics[0].help


def test_missing_file_names_its_neighbour(tmp_path: Path) -> None:
    (tmp_path / "shading.yaml").write_text(GRAPH)
    with pytest.raises(RenderGraphError) as error:
        load_document(tmp_path / "shadnig.yaml")
    assert "shading.yaml" in error.value.diagnostics[0].help


def test_every_syntax_and_node_row_explains_itself() -> None:
    rows = [code for code in MESSAGES if code < "RG210"]
    assert len(rows) > 25
    assert [code for code in rows if not MESSAGES[code].explain] == []
