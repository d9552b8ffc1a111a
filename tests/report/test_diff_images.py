"""Images of two folders: identical, close, different, and all that cannot be compared."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rendergraph.document.messages import RenderGraphError
from rendergraph.report.diff import diff_records
from rendergraph.report.diff_images import compare_image_files, load_pixels
from rendergraph.run.image_files import write_image
from tests.report.diff_records import resources, write

GREY = np.full((4, 6, 3), 128, np.uint8)


def changed(texel: tuple[int, int], by: int) -> np.ndarray:
    """The grey image with one texel (x, y from the lower left) raised."""
    pixels = GREY.copy()
    pixels[texel[1], texel[0]] += np.uint8(by)
    return pixels


def status(tmp_path: Path, before: np.ndarray, after: np.ndarray, suffix: str = "png") -> str:
    """What is said of one image in two versions."""
    paths = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    write_image(paths[0], before)
    write_image(paths[1], after)
    (found,) = compare_image_files({"i": paths[0]}, {"i": paths[1]})
    return found.status


def test_by_how_much(tmp_path: Path) -> None:
    assert status(tmp_path, GREY, GREY) == "identical"
    assert status(tmp_path, GREY, changed((0, 0), 1)) == "close"  # RMSE 1/255 over the root of 24 texels
    assert status(tmp_path, GREY, changed((0, 0), 100)) == "different"
    assert status(tmp_path, GREY, GREY + np.uint8(1)) == "different"  # all of it: a whole step is above half a step
    assert status(tmp_path, GREY, GREY[:, :5]) == "resized"


def test_the_worst_texel_counts_from_the_lower_left(tmp_path: Path) -> None:
    write_image(tmp_path / "a.png", GREY)
    write_image(tmp_path / "b.png", changed((5, 1), 51))
    (found,) = compare_image_files({"i": tmp_path / "a.png"}, {"i": tmp_path / "b.png"})
    assert found.error is not None
    assert found.error.worst_texel == (5, 1)
    assert found.error.max == pytest.approx(0.2)


@pytest.mark.parametrize("suffix", ["npy", "exr"])
def test_float_images(tmp_path: Path, suffix: str) -> None:
    if suffix == "exr":
        pytest.importorskip("OpenEXR")
    values = np.linspace(0, 3, 4 * 6 * 4, dtype=np.float32).reshape(4, 6, 4)
    write_image(tmp_path / f"kept.{suffix}", values)
    np.testing.assert_array_equal(load_pixels(tmp_path / f"kept.{suffix}"), values)
    assert status(tmp_path, values, values, suffix) == "identical"
    assert status(tmp_path, values, values * 1.5, suffix) == "different"
    broken = values.copy()
    broken[0, 0, 0] = np.nan
    assert status(tmp_path, values, broken, suffix) == "different"


def test_missing_images_are_worse_and_new_ones_are_not(tmp_path: Path) -> None:
    write_image(tmp_path / "a.png", GREY)
    (gone,) = compare_image_files({"i": tmp_path / "a.png"}, {})
    (new,) = compare_image_files({}, {"i": tmp_path / "a.png"})
    assert (gone.status, gone.worse, new.status, new.worse) == ("missing", True, "extra", False)


@pytest.mark.parametrize("name", ["a.png", "a.npy"])
def test_broken_files_are_refused(tmp_path: Path, name: str) -> None:
    whole, cut = tmp_path / name, tmp_path / f"cut{Path(name).suffix}"
    write_image(whole, np.tile(GREY, (20, 20, 1)))
    for content in (whole.read_bytes()[:150], b"", b"not an image"):
        cut.write_bytes(content)
        with pytest.raises(RenderGraphError) as caught:
            compare_image_files({"i": whole}, {"i": cut})
        assert [d.code for d in caught.value.diagnostics] == ["RG563"]


def test_arrays_that_are_no_images_are_refused(tmp_path: Path) -> None:
    for array in (np.zeros(3), np.array([["a"]]), np.array([{}], dtype=object)):
        np.save(tmp_path / "a.npy", array, allow_pickle=True)
        with pytest.raises(RenderGraphError) as caught:
            load_pixels(tmp_path / "a.npy")
        assert [d.code for d in caught.value.diagnostics] == ["RG563"]


def test_images_of_folders_are_gated_with_exact(tmp_path: Path) -> None:
    for name, pixels in (("a", GREY), ("b", changed((2, 2), 200))):
        write(tmp_path / name / "resources.json", resources())
        (tmp_path / name / "frames").mkdir()
        Image.fromarray(pixels[::-1]).save(tmp_path / name / "frames" / "0.png")
    found = diff_records(str(tmp_path / "a"), str(tmp_path / "b"))
    assert found.compared == {"exact", "images"}
    assert [(i.name, i.status) for i in found.images] == [("frames/0.png", "different")]
    assert len(found.regressions("exact")) == 1
    assert found.regressions("time") == []
