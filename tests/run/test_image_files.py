"""Image files keep their values and their orientation."""

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.graph import BufferDesc, Resource, TextureDesc
from rendergraph.run.image_files import capture_files, display_pixels, read_image, write_capture, write_image


def ramp(dtype: type, channels: int = 4) -> np.ndarray:
    """Five rows, three columns; every value different, the first row (bottom) smallest."""
    values = np.arange(5 * 3 * channels, dtype=np.float64).reshape(5, 3, channels)
    return (values if np.issubdtype(dtype, np.integer) else values / 64).astype(dtype)


def test_png_has_its_first_row_on_top_and_keeps_bytes(tmp_path: Path) -> None:
    pixels = ramp(np.uint8)
    pixels[..., 3] = 255
    write_image(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as image:
        seen = np.asarray(image)
    assert (seen[0] == pixels[-1, :, :3]).all()
    assert (read_image(tmp_path / "a.png") == pixels).all()


def test_linear_floats_are_encoded_srgb() -> None:
    # 0.5 -> 1.055 * 0.5^(1/2.4) - 0.055 = 0.735357; x 255 = 187.5; 0.001 -> 12.92 * 0.001 * 255 = 3.29
    pixels = np.array([[[0.0, 0.5, 1.0], [0.001, -1.0, 9.0]]], dtype=np.float32)
    assert display_pixels(pixels).tolist() == [[[0, 188, 255], [3, 0, 255]]]


def test_nan_shows_as_magenta_and_infinity_as_white() -> None:
    pixels = np.array([[[np.nan, 0.0, 0.0], [np.inf, -np.inf, 0.0]]], dtype=np.float32)
    assert display_pixels(pixels).tolist() == [[[255, 0, 255], [255, 0, 0]]]


def test_integers_are_shown_by_their_types_range() -> None:
    # 257 steps of uint16 are one of uint8; 128 of them lie in the middle and round up
    assert display_pixels(np.array([[[0], [257], [386], [65535]]], dtype=np.uint16))[0, :, 0].tolist() == [0, 1, 2, 255]
    assert display_pixels(np.array([[[-5], [127]]], dtype=np.int8))[0, :, 0].tolist() == [0, 255]


@pytest.mark.parametrize(
    ("desc", "suffixes"),
    [
        (TextureDesc("rgba8", 1, 1), {".png"}),
        (TextureDesc("rgba16f", 1, 1), {".png", ".exr"}),
        (TextureDesc("d32f", 1, 1), {".png", ".exr"}),
        (TextureDesc("rg16", 1, 1), {".png", ".npy"}),
        (TextureDesc("r32ui", 1, 1), {".png", ".npy"}),
        (BufferDesc(16), {".npy"}),
    ],
)
def test_captures_keep_their_values(desc: TextureDesc | BufferDesc, suffixes: set[str]) -> None:
    pytest.importorskip("OpenEXR")
    assert {Path(file).suffix for file in capture_files(Resource("a", desc))} == suffixes


def test_a_depth_capture_is_visible_and_exact(tmp_path: Path) -> None:
    pytest.importorskip("OpenEXR")
    depth = np.array([[[0.001], [0.002], [0.0]]], dtype=np.float32)
    paths = write_capture(tmp_path, Resource("z", TextureDesc("d32f", 3, 1)), depth)
    assert [p.name for p in paths] == ["z.png", "z.exr"]
    with Image.open(paths[0]) as image:
        assert np.asarray(image).tolist() == [[128, 255, 0]]


def test_a_buffer_capture_is_its_words(tmp_path: Path) -> None:
    words = np.array([1, 2, 0xFFFFFFFF], dtype=np.uint32)
    write_capture(tmp_path, Resource("b", BufferDesc(12)), words.view(np.float32).reshape(1, -1, 1))
    assert np.load(tmp_path / "b.npy").view(np.uint32).tolist() == [words.tolist()]


@pytest.mark.parametrize(("channels", "mode"), [(1, "L"), (2, "RGB"), (3, "RGB"), (4, "RGB")])
def test_every_channel_count_has_a_png(tmp_path: Path, channels: int, mode: str) -> None:
    write_image(tmp_path / "a.png", ramp(np.float32, channels))
    with Image.open(tmp_path / "a.png") as image:
        assert (image.mode, image.size) == (mode, (3, 5))


def test_npy_keeps_everything(tmp_path: Path) -> None:
    pixels = ramp(np.float16)
    write_image(tmp_path / "a.npy", pixels)
    assert (np.load(tmp_path / "a.npy")[::-1] == pixels).all()


def test_exr_keeps_half_floats(tmp_path: Path) -> None:
    openexr = pytest.importorskip("OpenEXR")
    pixels = ramp(np.float16)
    write_image(tmp_path / "a.exr", pixels)
    with openexr.File(str(tmp_path / "a.exr")) as file:
        read = file.channels()["RGBA"].pixels
    assert read.dtype == np.float16
    assert (read[::-1] == pixels).all()


def test_an_unknown_suffix_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RenderGraphError) as caught:
        write_image(tmp_path / "a.bmp", ramp(np.uint8))
    assert caught.value.diagnostics[0].code == "RG561"
    assert not list(tmp_path.iterdir())


def test_garbage_is_not_an_image(tmp_path: Path) -> None:
    for name in ("a.png", "a.hdr", "missing.png"):
        if not name.startswith("missing"):
            (tmp_path / name).write_bytes(b"#? not an image")
        with pytest.raises(RenderGraphError) as caught:
            read_image(tmp_path / name)
        assert caught.value.diagnostics[0].code == "RG563"


def hdr(body: bytes, width: int, height: int) -> bytes:
    """A Radiance file around a body."""
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + body


def test_flat_hdr_values(tmp_path: Path) -> None:
    # RGBE (128, 64, 32, 129): mantissa / 256 * 2^(129 - 128) = 1.0, 0.5, 0.25; exponent 0 is black
    (tmp_path / "a.hdr").write_bytes(hdr(bytes([128, 64, 32, 129, 9, 9, 9, 0]), 1, 2))
    pixels = read_image(tmp_path / "a.hdr")
    assert pixels[1, 0].tolist() == [1.0, 0.5, 0.25, 1.0]  # the file's first row is the top one
    assert pixels[0, 0].tolist() == [0.0, 0.0, 0.0, 1.0]


def test_run_length_hdr_values(tmp_path: Path) -> None:
    row = bytes([2, 2]) + struct.pack(">H", 8)
    row += bytes([128 + 8, 128]) + bytes([8, *range(8)]) + bytes([128 + 8, 0]) + bytes([128 + 8, 129])
    (tmp_path / "a.hdr").write_bytes(hdr(row, 8, 1))
    pixels = read_image(tmp_path / "a.hdr")
    assert pixels[0, :, 0].tolist() == [1.0] * 8
    assert pixels[0, :, 1].tolist() == [i / 128 for i in range(8)]


@pytest.mark.parametrize("cut", [1, 5, 9, 14])
def test_truncated_hdr_is_an_error(tmp_path: Path, cut: int) -> None:
    row = bytes([2, 2]) + struct.pack(">H", 8) + bytes([8, *range(8)]) * 4
    (tmp_path / "a.hdr").write_bytes(hdr(row[:-cut], 8, 1))
    with pytest.raises(RenderGraphError) as caught:
        read_image(tmp_path / "a.hdr")
    assert caught.value.diagnostics[0].code == "RG563"
