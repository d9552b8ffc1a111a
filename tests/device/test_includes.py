"""The preprocessor, without GL: includes, defines, line numbers that lead back, and every way to get it wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from rendergraph.device.includes import LINES_A_FILE, FileTable, preprocess
from rendergraph.document.messages import Diagnostic, RenderGraphError


def write(folder: Path, **files: str) -> Path:
    """Writes ``name_ext`` as ``name.ext`` and returns the first."""
    paths = []
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        paths.append(path)
    return paths[0]


def refused(path: Path, code: str, **more) -> Diagnostic:
    with pytest.raises(RenderGraphError) as caught:
        preprocess(path, **more)
    assert caught.value.diagnostics[0].code == code
    return caught.value.diagnostics[0]


def number_of(source: str, wanted: str) -> int:
    """The number a driver would give the line that holds ``wanted``."""
    number = 1
    for line in source.split("\n"):
        if wanted in line and not line.startswith("#line"):
            return number
        number = int(line.removeprefix("#line ")) if line.startswith("#line ") else number + 1
    raise AssertionError(f"{wanted!r} is not in the source")


def where(source: str, files: FileTable, wanted: str) -> tuple[str, int]:
    position = files.locate(number_of(source, wanted))
    return Path(position.file).name, position.line


def test_version_and_defines_come_first(tmp_path: Path) -> None:
    given = write(tmp_path, a_frag="// note\n\n#version 430 core\nvoid main() {}\n")
    source, _ = preprocess(given, (("A", "1"), ("B", "")))
    assert source.split("\n")[:3] == ["#version 430 core", "#define A 1", "#define B"]
    assert source.count("#version") == 1
    missing = write(tmp_path, b_frag="void main() {}\n")
    assert preprocess(missing)[0].startswith("#version 450\n")


def test_nested_includes_map_every_line_back(tmp_path: Path) -> None:
    root = write(
        tmp_path,
        root_frag='#version 450\nroot_2\n#include "inner.glsl"\nroot_4\n  #  include "sub/deep.glsl"\nroot_6\n',
        inner_glsl='inner_1\n#include "sub/deep.glsl"\ninner_3\n',
        sub__deep_glsl="deep_1\r\n\r\ndeep_3\r\n",
    )
    source, files = preprocess(root)
    for wanted, file, line in (
        ("root_2", "root.frag", 2), ("inner_1", "inner.glsl", 1), ("deep_3", "deep.glsl", 3),
        ("inner_3", "inner.glsl", 3), ("root_4", "root.frag", 4), ("root_6", "root.frag", 6),
    ):  # fmt: skip
        assert where(source, files, wanted) == (file, line)
    assert len(files.paths) == 3


def test_lines_before_the_first_file_belong_to_the_root(tmp_path: Path) -> None:
    _, files = preprocess(write(tmp_path, a_frag="x\n"), (("A", "1"),))
    for line in (0, 1, 2, 99 * LINES_A_FILE):
        assert files.locate(line).line == 1
        assert files.locate(line).file.endswith("a.frag")


def test_shared_folder_then_given_folders(tmp_path: Path) -> None:
    root = write(tmp_path / "node", a_frag="#include <frame.glsl>\n#include <mine.glsl>\n")
    write(tmp_path / "more", mine_glsl="mine_1\n")
    source, _ = preprocess(root, include_dirs=[tmp_path / "more"])
    assert "uniform Frame" in source
    assert "mine_1" in source


def test_directives_in_comments_are_not_directives(tmp_path: Path) -> None:
    commented = '// #include "no.glsl"\n/* #include "no.glsl"\n#include <no.glsl>\n*/ int a; /* x */ // /*\n'
    text = commented + '#include "b.glsl" // "c"\n'
    source, _ = preprocess(write(tmp_path, a_frag=text, b_glsl="b_1\n"))
    assert "b_1" in source


def test_unknown_include_names_where_it_looked_and_the_chain(tmp_path: Path) -> None:
    root = write(tmp_path, a_frag='\n#include "b.glsl"\n', b_glsl="\n\n  #include <nothing.glsl>\n")
    found = refused(root, "RG511")
    assert found.position is not None
    assert (Path(found.position.file).name, found.position.line, found.position.column) == ("b.glsl", 3, 3)
    assert "a.frag:2" in found.data["chain"]
    refused(write(tmp_path, c_frag='#include "sub"\n', sub__x_glsl=""), "RG511")  # a folder


def test_cycles_are_shown_as_a_path(tmp_path: Path) -> None:
    root = write(tmp_path, a_frag='#include "b.glsl"\n', b_glsl='#include "c.glsl"\n', c_glsl='#include "b.glsl"\n')
    assert refused(root, "RG512").data["chain"] == "a.frag -> b.glsl -> c.glsl -> b.glsl"
    refused(write(tmp_path, self_frag='#include "self.frag"\n'), "RG512")


def test_doubling_includes_end(tmp_path: Path) -> None:
    for i in range(40):
        write(tmp_path, **{f"f{i}_glsl": f'#include "f{i + 1}.glsl"\n#include "f{i + 1}.glsl"\n'})
    write(tmp_path, f40_glsl="")
    refused(tmp_path / "f0.glsl", "RG512")


@pytest.mark.parametrize(
    "name", ['"../outside.glsl"', "<../device/gl.py>", '"/etc/hostname"', "</etc/hostname>", '"no/../../o"']
)
def test_includes_stay_within_their_folders(tmp_path: Path, name: str) -> None:
    write(tmp_path, outside_glsl="secret\n")
    refused(write(tmp_path / "node", a_frag=f"#include {name}\n"), "RG513")


def test_links_out_of_the_folder_are_outside(tmp_path: Path) -> None:
    write(tmp_path, outside_glsl="secret\n")
    root = write(tmp_path / "node", a_frag='#include "link.glsl"\n')
    (tmp_path / "node" / "link.glsl").symlink_to(tmp_path / "outside.glsl")
    refused(root, "RG513")


def test_given_folders_may_be_reached_by_quotes(tmp_path: Path) -> None:
    root = write(tmp_path / "node", a_frag='#include "../shared/b.glsl"\n')
    write(tmp_path / "shared", b_glsl="b_1\n")
    refused(root, "RG513")
    assert "b_1" in preprocess(root, include_dirs=[tmp_path])[0]


@pytest.mark.parametrize(
    "text", ["#include b.glsl\n", '#include "b.glsl\n', "#include <b.glsl\n", "#include\n", "int a;\n#version 450\n"]
)
def test_malformed_directives(tmp_path: Path, text: str) -> None:
    write(tmp_path, b_glsl="")
    refused(write(tmp_path, a_frag=text), "RG514")


def test_version_in_an_included_file(tmp_path: Path) -> None:
    refused(write(tmp_path, a_frag='#include "b.glsl"\n', b_glsl="#version 450\n"), "RG514")


def test_unreadable_files(tmp_path: Path) -> None:
    refused(tmp_path / "missing.frag", "RG510")
    refused(tmp_path, "RG510")
    binary = tmp_path / "binary.frag"
    binary.write_bytes(b"\x00\xff\xfe\x80")
    refused(binary, "RG510")
    long = write(tmp_path, long_frag="\n" * LINES_A_FILE)
    refused(long, "RG510")
