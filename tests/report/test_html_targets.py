"""What the page says of textures: exact ranges, true texels, a picture to match, all within the budget."""

from __future__ import annotations

import base64
import io
import zlib
from typing import Any

import numpy as np
import pytest
from PIL import Image

from rendergraph.plan.graph import Frame, Graph, Resource, TextureDesc
from rendergraph.report.html.targets import BUDGET, TargetGallery, target_entries
from tests.report.made_up import ramp


def entry_of(pixels: np.ndarray[Any, Any], format: str, budget: int = BUDGET) -> dict[str, Any]:
    gallery = TargetGallery()
    gallery.add("t", pixels)
    resource = Resource("t", TextureDesc(format, pixels.shape[1], pixels.shape[0]))
    (entry,) = target_entries(Graph(Frame(64, 64), {"t": resource}, {}, ()), gallery.views, budget)
    return entry


def decoded(entry: dict[str, Any]) -> np.ndarray[Any, Any]:
    """Values as the page reads them: [channels, rows, columns], first row on top. Not by the code that packed them."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(entry["data"])), np.uint8)
    width = int(entry["type"][1])
    words = planes.reshape(width, -1).T.copy().view("<" + entry["type"]).ravel()
    return words.reshape(-1, entry["rows"], entry["columns"]) * entry["scale"]


def picture(entry: dict[str, Any]) -> np.ndarray[Any, Any]:
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(entry["png"].split(",")[1]))))


@pytest.mark.parametrize(
    ("format", "dtype", "scale"),
    [
        ("rgba8", np.uint8, 1 / 255), ("rgba16", np.uint16, 1 / 65535), ("rgba8_snorm", np.int8, 1 / 127),
        ("rgba8ui", np.uint8, 1), ("rgba32i", np.int32, 1), ("rgba16f", np.float16, 1), ("rgba32f", np.float32, 1),
    ],
)  # fmt: skip
def test_values_survive_and_have_their_first_row_on_top(format: str, dtype: Any, scale: float) -> None:
    pixels = ramp(3, 4, 4).astype(dtype)
    entry = entry_of(pixels, format)
    assert (entry["columns"], entry["rows"], entry["samples"]) == (4, 3, [4, 3])
    assert decoded(entry) == pytest.approx(np.moveaxis(pixels[::-1], -1, 0).astype(np.float64) * scale, rel=1e-12)
    assert entry["ranges"][0]["low"] == 0
    assert entry["ranges"][0]["high"] == pytest.approx(23 * scale)


def test_floats_keep_12_bits_and_what_is_not_finite() -> None:
    odd = [np.nan, np.inf, -np.inf, 3.4028235e38, -3.4028235e38, 1e-42, 0.0, -0.0]
    pixels = np.array([[*odd, *np.random.default_rng(1).lognormal(0, 9, 4000)]], np.float32)[..., None]
    entry = entry_of(np.repeat(pixels, 2, axis=0), "r32f")
    assert (entry["ranges"][0]["nan"], entry["ranges"][0]["infinite"]) == (2, 4)
    assert entry["ranges"][0]["high"] == np.float32(3.4028235e38)
    whole = TargetGallery()
    whole.add("t", pixels[:, :600])
    stored = whole.views["t"].samples[0, :, 0]
    read = decoded(entry_of(pixels[:, :600], "r32f"))[0, 0]
    assert np.isnan(read[0])
    assert (read[1:3] == [np.inf, -np.inf]).all()
    normal = np.isfinite(stored) & (np.abs(stored) > 1e-30)
    error = np.abs(read[normal] / stored[normal] - 1)
    assert error.max() < 2**-12
    assert error.max() > 2**-14, "nothing was rounded: the bound above would not be tested"


def test_a_reduced_target_holds_true_texels_where_the_page_says() -> None:
    rng = np.random.default_rng(2)
    pixels = rng.random((900, 1501, 3), np.float32)
    entry = entry_of(pixels, "rgba16f", 60_000)
    assert len(entry["png"]) + len(entry["data"]) <= 60_000 + 100
    values = decoded(entry)
    columns, rows, (width, height) = entry["columns"], entry["rows"], entry["samples"]
    assert 40 < columns < 640
    for x, y in [(0, 0), (columns - 1, rows - 1), (7, rows // 2), (columns // 3, 5)]:
        across = (2 * ((2 * x + 1) * width // (2 * columns)) + 1) * 1501 // (2 * width)
        up = (2 * ((2 * (rows - 1 - y) + 1) * height // (2 * rows)) + 1) * 900 // (2 * height)
        assert values[:, y, x] == pytest.approx(pixels[up, across], rel=2**-12)


def test_many_targets_share_the_budget() -> None:
    rng = np.random.default_rng(3)
    gallery, resources = TargetGallery(), {}
    for index in range(20):
        resources[f"t{index}"] = Resource(f"t{index}", TextureDesc("rgba16f", 320, 180))
        gallery.add(f"t{index}", rng.random((180, 320, 4)).astype(np.float16))
    entries = target_entries(Graph(Frame(64, 64), resources, {}, ()), gallery.views, 400_000)
    assert [e["name"] for e in entries] == list(resources)
    total = sum(len(e["png"]) + len(e["data"]) for e in entries)
    assert 250_000 < total <= 400_000 + 20 * 40


def test_the_picture_shows_nan_magenta_and_data_linear() -> None:
    pixels = ramp(2, 2, 1)
    pixels[1, 1] = np.nan
    entry = entry_of(pixels, "r32f")
    assert not entry["srgb"]
    shown = picture(entry)
    assert tuple(shown[0, 1]) == (255, 0, 255)
    assert tuple(shown[1, 0]) == (0, 0, 0)
    assert shown[1, 1, 0] < shown[0, 0, 0] == 255


def test_radiance_is_shown_encoded_and_outliers_do_not_blacken_it() -> None:
    pixels = np.full((40, 40, 3), 0.5, np.float16)
    pixels[:20] = 1.0
    pixels[0, 0] = 60000
    entry = entry_of(pixels, "rgba16f")
    assert entry["srgb"]
    assert (entry["low"], entry["high"]) == (0.0, 1.0)
    assert entry["ranges"][0]["high"] == 60000
    assert entry["histogram"]["beyond"] == (False, True)
    assert set(np.unique(picture(entry))) == {188, 255}  # sRGB of 0.5 is 187.5


def test_depth_is_stretched_to_its_range() -> None:
    entry = entry_of(np.linspace(0.5, 0.75, 64, dtype=np.float32).reshape(8, 8, 1), "d32f")
    assert (entry["low"], entry["high"], entry["srgb"]) == (0.5, 0.75, False)
    assert (picture(entry).min(), picture(entry).max()) == (0, 255)


@pytest.mark.parametrize("shape", [(1, 5000, 1), (5000, 1, 2), (2, 4096, 4), (1, 1, 1)])
def test_thin_targets_keep_a_row_and_a_column(shape: tuple[int, int, int]) -> None:
    entry = entry_of(np.ones(shape, np.float32), "rgba32f")
    assert min(entry["rows"], entry["columns"]) >= 1
    assert (decoded(entry) == 1).all()


@pytest.mark.parametrize("value", [0.0, 7.5, np.nan, np.inf, -np.inf])
def test_flat_and_empty_contents(value: float) -> None:
    entry = entry_of(np.full((4, 4, 1), value, np.float32), "r32f")
    assert entry["high"] > entry["low"]
    assert np.isfinite([entry["low"], entry["high"]]).all()
    assert picture(entry).shape[:2] == (4, 4)
