"""Error maps as pictures."""

from math import inf, nan
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.metrics import error_picture, picture_range, write_error_picture
from rendergraph.measure.metrics.picture import HATCH, INFINITE, colours


def lightness(colour: np.ndarray) -> float:
    """CIE L* of sRGB in 0..255."""
    share = colour / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    y = float(linear @ (0.2126, 0.7152, 0.0722))
    return 116 * np.cbrt(y) - 16 if y > (6 / 29) ** 3 else y * (29 / 3) ** 3


def test_first_middle_and_last_colour() -> None:
    shown = error_picture(np.array([[0.0, 1.0, 2.0, 3.0]]), (0.0, 2.0))
    assert shown.dtype == np.uint8
    assert shown.tolist() == [[[0, 0, 4], [182, 54, 121], [252, 253, 191], [252, 253, 191]]]


def test_a_larger_error_is_lighter_by_even_steps() -> None:
    steps = np.diff([lightness(colour.astype(float)) for colour in colours(np.linspace(0, 1, 33))])
    assert (steps > 0).all()
    assert 1.5 < steps.min() < steps.max() < 4.5  # 98 in 32 steps is 3.1


def test_close_to_the_map_that_flip_draws() -> None:
    evaluator = pytest.importorskip("flip_evaluator")
    levels = np.linspace(0.0, 1.0, 60, dtype=np.float32)
    truth = np.zeros((1, 60, 3), np.float32)
    judged = np.repeat(levels[None, :, None], 3, axis=-1)
    coloured, plain = (evaluator.evaluate(truth, judged, "LDR", applyMagma=magma)[0] for magma in (True, False))
    assert plain.max() - plain.min() > 0.3
    np.testing.assert_allclose(colours(plain[..., 0].astype(np.float64)) / 255.0, coloured, atol=0.03)


def test_range() -> None:
    assert picture_range(np.array([[0.25, nan, inf, 0.5]])) == (0.0, 0.5)
    assert picture_range(np.array([[0.0, nan]])) == (0.0, 1.0)
    assert picture_range(np.array([[nan]])) == (0.0, 1.0)


def test_masked_is_hatched_and_infinite_stands_out() -> None:
    errors = np.linspace(0, 1, 256).reshape(16, 16)
    errors[:8, :8] = nan
    errors[15, 15] = inf
    shown = error_picture(errors)
    assert {tuple(colour) for colour in shown[:8, :8].reshape(-1, 3)} == set(HATCH)
    assert tuple(shown[15, 15]) == INFINITE
    scale = colours(np.linspace(0, 1, 1000)).astype(float)
    for special in (*HATCH, INFINITE):
        assert np.abs(scale - special).max(axis=1).min() > 30  # no error has such a colour


@pytest.mark.parametrize("limits", [(1.0, 1.0), (1.0, 0.0), (0.0, nan), (0.0, inf), (-inf, 0.0)])
def test_no_range(limits: tuple[float, float]) -> None:
    with pytest.raises(ValueError):
        error_picture(np.zeros((2, 2)), limits)


def test_written_with_its_first_row_on_top(tmp_path: Path) -> None:
    errors = np.array([[0.0, 0.5], [1.0, nan]])
    assert write_error_picture(tmp_path / "error.png", errors) == (0.0, 1.0)
    read = np.asarray(Image.open(tmp_path / "error.png").convert("RGB"))
    np.testing.assert_array_equal(read, error_picture(errors)[::-1])
    assert write_error_picture(tmp_path / "error.png", errors, (0.0, 4.0)) == (0.0, 4.0)
    with pytest.raises(RenderGraphError) as raised:
        write_error_picture(tmp_path / "error.gif", errors)
    assert raised.value.diagnostics[0].code == "RG561"
