"""Resources that are image files: found, measured by their header, refused when they are anything else."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import pytest
from PIL import Image
from toy_nodes import codes, graph

from rendergraph.plan.graph import Kind, TextureDesc
from rendergraph.plan.graph_files import locate, named_files
from rendergraph.plan.image_header import image_size

TEXT = """
resources: {{picture: {{file: "{file}"{more}}}}}
passes: {{p: {{node: copy, read: {{source: picture}}, write: {{destination: image}}, set: {{blit: true}}}}}}
outputs: {{image: {{file: a.png}}}}
"""


def text(file: str, more: str = "") -> str:
    """A graph that copies an image file to the output."""
    return TEXT.format(file=file, more=more)


def png_header(width: int, height: int) -> bytes:
    """A PNG cut off behind its header chunk."""
    chunk = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    crc = struct.pack(">I", zlib.crc32(chunk))
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + crc + b"\0\0\0\0IDAT"


HDR = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 9\n" + bytes(9 * 3 * 4)


@pytest.fixture
def pictures(tmp_path: Path) -> Path:
    """A folder of images."""
    Image.new("RGB", (5, 4)).save(tmp_path / "a.png")
    Image.new("L", (6, 2)).save(tmp_path / "b.jpg")
    (tmp_path / "c.hdr").write_bytes(HDR)
    (tmp_path / "sub").mkdir()
    Image.new("RGBA", (8, 8)).save(tmp_path / "sub" / "d.PNG")
    return tmp_path


@pytest.mark.parametrize(
    ("file", "more", "desc"),
    [
        ("a.png", "", TextureDesc("srgb8_a8", 5, 4)),
        ("a.png", ", format: rgba8, mips: 0", TextureDesc("rgba8", 5, 4, mips=3)),
        ("b.jpg", "", TextureDesc("srgb8_a8", 6, 2)),
        ("c.hdr", "", TextureDesc("rgba16f", 9, 3)),
        ("sub/d.PNG", "", TextureDesc("srgb8_a8", 8, 8)),
        ("sub/../a.png", "", TextureDesc("srgb8_a8", 5, 4)),
    ],
)
def test_size_and_format_of_files(pictures: Path, file: str, more: str, desc: TextureDesc) -> None:
    found = graph(pictures, text(file, more)).resources["picture"]
    assert (found.desc, found.kind) == (desc, Kind.IMPORTED)
    assert found.file == (pictures / file).resolve()


def test_a_file_cut_off_behind_its_header_still_tells_its_size(tmp_path: Path) -> None:
    (tmp_path / "cut.png").write_bytes(png_header(300, 200))
    assert image_size(tmp_path / "cut.png") == (300, 200)


@pytest.mark.parametrize(
    ("file", "content", "code"),
    [
        ("none.png", None, "RG310"),
        ("empty.png", b"", "RG312"),
        ("garbage.png", bytes(range(256)), "RG312"),
        ("text.hdr", b"hello", "RG312"),
        ("endless.hdr", b"#?RADIANCE\n" + b"A=1\n" * 100, "RG312"),
        ("turned.hdr", b"#?RADIANCE\n\n+X 3 -Y 3\n", "RG312"),
        ("letters.hdr", b"#?RADIANCE\n\n-Y a +X b\n", "RG312"),
        ("zero.hdr", b"#?RADIANCE\n\n-Y 0 +X 4\n", "RG312"),
        ("wide.hdr", b"#?RADIANCE\n\n-Y 4 +X 16385\n", "RG307"),
        ("bomb.png", png_header(60000, 60000), "RG312"),
        ("wide.png", png_header(20000, 100), "RG307"),
        ("note.txt", b"hello", "RG312"),
        ("short.png", b"\x89PNG\r\n\x1a\n\0\0", "RG312"),
        ("../outside.png", b"", "RG311"),
        ("/etc/hosts", None, "RG311"),
        ("x" * 300 + ".png", None, "RG312"),
    ],
)
def test_files_that_are_no_image(tmp_path: Path, file: str, content: bytes | None, code: str) -> None:
    folder = tmp_path / "graph"
    folder.mkdir()
    if content is not None:
        (folder / file).write_bytes(content)
    assert codes(folder, text(file)) == [code]


def test_a_folder_is_no_image(tmp_path: Path) -> None:
    (tmp_path / "a.png").mkdir()
    assert codes(tmp_path, text("a.png")) == ["RG312"]


def test_a_link_out_of_the_folder_is_followed_and_refused(tmp_path: Path) -> None:
    folder = tmp_path / "graph"
    folder.mkdir()
    Image.new("RGB", (5, 4)).save(tmp_path / "a.png")
    (folder / "link.png").symlink_to(tmp_path / "a.png")
    (folder / "loop.png").symlink_to(folder / "loop.png")
    assert codes(folder, text("link.png")) == ["RG311"]
    assert codes(folder, text("loop.png")) in (["RG310"], ["RG311"])
    assert locate(folder.resolve(), "nul\0.png") is None


@pytest.mark.parametrize("format", ["d32f", "r8ui"])
def test_formats_a_file_cannot_become(pictures: Path, format: str) -> None:
    assert codes(pictures, text("a.png", f", format: {format}")) == ["RG314"]


def test_too_many_levels_and_history_of_a_file(pictures: Path) -> None:
    assert codes(pictures, text("a.png", ", mips: 4")) == ["RG308"]
    history = text("a.png").replace("resources: {", "resources: {old: {previous: picture}, ")
    assert codes(pictures, history) == ["RG306"]


def test_writing_a_file_resource(pictures: Path) -> None:
    wrong = text("a.png").replace("passes: {", "passes: {z: {node: clear, write: {target: picture}}, ")
    assert codes(pictures, wrong) == ["RG215"]


def test_an_image_file_may_be_an_output(pictures: Path) -> None:
    both = text("a.png").replace("outputs: {", "outputs: {picture: {file: b.png}, ")
    assert codes(pictures, both) == []


def test_named_files_finds_every_shape() -> None:
    from toy_nodes import PeekParams

    params = PeekParams(file="a", table={"x": "b", "y": "c"})
    assert list(named_files(params)) == [("file", "a"), ("table", "b"), ("table", "c")]
    assert list(named_files(PeekParams())) == []
