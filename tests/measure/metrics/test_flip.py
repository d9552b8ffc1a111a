"""FLIP: the evaluator against the papers computed in float64, hand arithmetic, masks, and arguments it cannot bear.

The pictures behind the evaluator's own published numbers are not part of its package; a pair drawn by formula stands in
for them, judged by an evaluation of the papers that shares no code with the evaluator.
"""

import sys
from math import inf, log2, nan

import numpy as np
import numpy.typing as npt
import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.metrics import PIXELS_PER_DEGREE, compare, error_map, flip
from rendergraph.measure.metrics.flip import automatic_exposures, flip_version
from rendergraph.node.reference import Quantity
from tests.measure.metrics.flip_reference import colour_share, flip_map, hdr_flip_map

pytest.importorskip("flip_evaluator")

F64 = npt.NDArray[np.float64]


def pair(width: int = 64, height: int = 48, strength: float = 0.1) -> tuple[F64, F64]:
    """A truth of ramps, waves and a red box, and the same with a pattern over it and a white box: all by formula."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float64)
    truth = np.stack([x / (width - 1), y / (height - 1), 0.5 + 0.5 * np.sin(x / 5) * np.cos(y / 7)], axis=-1)
    truth[10:20, 20:40] = (0.9, 0.1, 0.2)
    pattern = np.stack([np.sin(x * 2.3 + y * 1.7), np.sin(x * y / 9), np.cos(x * 1.1 - y * 2.9)], axis=-1)
    judged = np.clip(truth + strength * pattern, 0.0, 1.0)
    judged[30:40, 5:15] = 1.0
    return judged, truth


@pytest.mark.parametrize("pixels_per_degree", [PIXELS_PER_DEGREE, 30.0])
def test_the_evaluator_computes_what_the_paper_says(pixels_per_degree: float) -> None:
    judged, truth = pair()
    found = flip(judged, truth, hdr=False, pixels_per_degree=pixels_per_degree)
    expected = flip_map(judged, truth, pixels_per_degree)
    np.testing.assert_allclose(found.map, expected, atol=1e-4)
    assert found.mean == pytest.approx(expected.mean(), abs=1e-5)
    assert found.pixels_per_degree == pixels_per_degree
    # the twin that must fail: the paper's answer for another distance, and for the pictures changed over a little
    assert abs(found.mean - flip_map(judged, truth, 1.5 * pixels_per_degree).mean()) > 1e-3
    assert abs(found.map - flip_map(judged**1.02, truth, pixels_per_degree)).max() > 1e-2


def test_hdr_is_the_worst_of_its_exposures() -> None:
    judged, truth = (image**6 * 50 for image in pair())
    found = flip(judged, truth, hdr=True)
    assert found.exposures is not None
    assert found.exposures[2] > 2
    expected = hdr_flip_map(judged, truth, PIXELS_PER_DEGREE, found.exposures)
    np.testing.assert_allclose(found.map, expected, atol=2e-4)
    first, last, count = found.exposures
    short = hdr_flip_map(judged, truth, PIXELS_PER_DEGREE, (first, last - 1, count))
    assert abs(short - expected).max() > 1e-2  # the twin


def test_pinned() -> None:
    judged, truth = pair()
    # made with flip-evaluator 1.7; its authors state that means agree to six decimals between systems
    assert flip(judged, truth, hdr=False).mean == pytest.approx(0.138927, abs=2e-6)
    assert flip(judged**2 * 50, truth**2 * 50, hdr=True).mean == pytest.approx(0.185922, abs=2e-6)


def test_black_against_white_by_hand() -> None:
    # HyAB of black and white is the lightness alone, 100, and 100^0.7 = 25.119. The largest difference is green
    # (87.735, -75.612, 72.977 after Hunt) against blue (32.297, 25.575, -34.836): 55.438 + hypot(101.187, 107.813)
    # = 203.30, and 203.30^0.7 = 41.276, of which 0.4 is 16.510. So 0.95 + 0.05 (25.119 - 16.510) / (41.276 - 16.510)
    # = 0.96738. Neither image has an edge.
    black, white = np.zeros((16, 16, 3)), np.ones((16, 16, 3))
    assert flip(white, black, hdr=False).mean == pytest.approx(0.96738, abs=2e-5)
    assert flip(black, white, hdr=False).mean == pytest.approx(0.96738, abs=2e-5)
    assert colour_share(100.0) == pytest.approx(0.96738, abs=1e-5)


@pytest.mark.parametrize("hdr", [False, True])
def test_equal_images_are_zero_and_stronger_patterns_larger(hdr: bool) -> None:
    means = [flip(*pair(strength=strength), hdr=hdr).mean for strength in (0.01, 0.05, 0.1, 0.2)]
    assert means == sorted(set(means))
    judged, truth = pair()
    assert flip(truth, truth, hdr=hdr).map.max() == 0.0
    assert flip(truth, judged, hdr=False).mean == pytest.approx(flip(judged, truth, hdr=False).mean, abs=1e-6)


def test_exposures_are_the_evaluators_own() -> None:
    import flip_evaluator

    judged, truth = (image**2 * 50 for image in pair())
    images = (np.ascontiguousarray(image, np.float32) for image in (truth, judged))
    used = flip_evaluator.evaluate(*images, "HDR", applyMagma=False)[2]
    first, last, count = automatic_exposures(truth @ (0.2126, 0.7152, 0.0722))
    assert first == pytest.approx(used["startExposure"], abs=1e-5)
    assert last == pytest.approx(used["stopExposure"], abs=1e-5)
    assert count == used["numExposures"]


def test_exposures_by_hand() -> None:
    # ACES shows x as 0.85 where 0.36 (2.51 - 0.85 * 2.43) x^2 + 0.6 (0.03 - 0.85 * 0.59) x - 0.85 * 0.14 = 0:
    # 0.16002 x^2 - 0.2829 x - 0.119 = 0, so x = (0.2829 + sqrt(0.080032 + 0.07617)) / 0.32004 = 2.11890
    white = log2(2.11890)
    first, last, count = automatic_exposures(np.array([0.25, 0.25, 0.25, 16.0]))
    assert first == pytest.approx(white - 4, abs=1e-4)
    assert last == pytest.approx(white + 2, abs=1e-4)
    assert count == 6
    assert automatic_exposures(np.zeros(4)) == (0.0, 0.0, 2)
    assert automatic_exposures(np.array([0.0, 0.0, 1e30]))[1] == pytest.approx(white - log2(1e30) + 40, abs=1e-4)


@pytest.mark.parametrize("hdr", [False, True])
@pytest.mark.parametrize("held", [0.0, 1.0, 1e30, -5.0, nan, inf])
def test_a_masked_texel_changes_nothing(hdr: bool, held: float) -> None:
    judged, truth = pair()
    mask = np.ones(truth.shape[:2], bool)
    mask[5:25, 8:30] = False
    expected = flip(judged, truth, hdr=hdr, mask=mask)
    a, b = judged.copy(), truth.copy()
    a[~mask], b[~mask] = held, 1.0 - held
    found = flip(a, b, hdr=hdr, mask=mask)
    assert found.mean == expected.mean == pytest.approx(found.map[mask].mean())
    assert found.mean != pytest.approx(found.map.mean(), rel=1e-3)
    np.testing.assert_array_equal(found.map, expected.map)
    # the twin: unmasked, the same content does change the number
    assert flip(a, b, hdr=hdr).mean != flip(judged, truth, hdr=hdr).mean


def test_masked_sky_is_no_error_of_its_neighbours() -> None:
    truth = np.full((32, 32, 3), 0.5)
    judged = truth.copy()
    mask = np.ones((32, 32), bool)
    mask[16:] = False
    judged[16:] = 1.0
    assert flip(judged, truth, hdr=False, mask=mask).mean == 0.0


@pytest.mark.parametrize("hdr", [False, True])
@pytest.mark.parametrize("held", [nan, inf, -inf])
def test_not_finite_is_infinitely_wrong_unless_both_are(hdr: bool, held: float) -> None:
    judged, truth = pair()
    judged[3, 4, 1] = held
    found = flip(judged, truth, hdr=hdr)
    assert found.mean == inf
    assert np.argwhere(np.isinf(found.map)).tolist() == [[3, 4]]
    truth[3, 4] = judged[3, 4]
    assert np.isfinite(flip(judged, truth, hdr=hdr).map).all()
    assert flip(judged * nan, truth, hdr=hdr).mean == inf
    assert flip(judged, truth, hdr=hdr, mask=np.zeros((48, 64), bool)).mean is None


@pytest.mark.parametrize(
    ("judged", "truth"),
    [(1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (1e37, 1e30), (1e30, 1e-30), (1e-30, 1e-20), (65504.0, 6e-8), (-3.0, -1.0)],
)
def test_radiance_at_the_ends_of_its_range(judged: float, truth: float) -> None:
    a, b = np.full((9, 12, 3), judged), np.full((9, 12, 3), truth)
    b[0, 0] *= 2.0  # a uniform truth has one exposure only
    found = flip(a, b, hdr=True)
    assert np.isfinite(found.map).all()
    assert 0.0 <= found.mean <= 1.0


def test_values_that_no_screen_shows_are_those_at_the_end() -> None:
    truth = pair()[1] ** 6 * 50
    judged = truth.copy()
    found = []
    for negative, bright in ((-3.0, 1e38), (-1e30, 1e30), (0.0, 1e6)):
        judged[2, 3], judged[40, 50] = negative, bright
        found.append(flip(judged, truth, hdr=True).map)
    np.testing.assert_array_equal(found[0], found[2])
    np.testing.assert_array_equal(found[1], found[2])
    judged[2, 3], judged[40, 50] = 1.0, truth[40, 50]
    assert flip(judged, truth, hdr=True).mean != found[2].mean()  # the twin
    display = [flip(np.full((9, 9, 3), v), np.full((9, 9, 3), 0.5), hdr=False).mean for v in (-1.0, 0.0, 1.0, 7.0)]
    assert display[0] == display[1] != display[2] == display[3]


@pytest.mark.parametrize("shape", [(1, 1, 3), (3, 5, 3), (1, 70, 3), (16, 16, 1), (16, 16, 2), (16, 16, 4)])
@pytest.mark.parametrize("hdr", [False, True])
def test_sizes_and_channels(shape: tuple[int, ...], hdr: bool) -> None:
    truth = np.linspace(0.1, 0.9, int(np.prod(shape))).reshape(shape)
    found = flip(truth * 0.5, truth, hdr=hdr)
    assert found.map.shape == shape[:2]
    assert 0.0 < found.mean < 1.0
    assert flip(truth, truth, hdr=hdr).mean == 0.0


def test_one_channel_is_grey_and_a_fourth_does_not_count() -> None:
    grey = np.linspace(0.0, 1.0, 256).reshape(16, 16, 1)
    both = [
        flip(np.repeat(g, n, axis=-1) ** 1.5, np.repeat(g, n, axis=-1), hdr=False) for g, n in ((grey, 1), (grey, 3))
    ]
    np.testing.assert_array_equal(both[0].map, both[1].map)
    alpha = [
        np.concatenate([np.repeat(grey, 3, -1) ** p, np.full_like(grey, v)], -1) for p, v in ((1.5, 0.2), (1, 0.9))
    ]
    np.testing.assert_array_equal(flip(*alpha, hdr=False).map, both[0].map)


def test_by_quantity() -> None:
    judged, truth = pair()
    assert compare(Quantity.DISPLAY, judged, truth)["flip"] == flip(judged, truth, hdr=False).mean
    assert compare(Quantity.RADIANCE, judged, truth)["flip"] == flip(judged, truth, hdr=True).mean
    seen = error_map(Quantity.DISPLAY, judged, truth, metric="flip")
    np.testing.assert_array_equal(seen, flip(judged, truth, hdr=False).map)


def test_an_evaluator_that_prints_and_ends_the_process_is_an_error(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    import flip_evaluator

    def end(*_: object, **__: object) -> None:
        print("No good.\nExiting.")  # noqa: T201
        sys.exit(1)

    monkeypatch.setattr(flip_evaluator, "evaluate", end)
    with pytest.raises(RenderGraphError) as raised:
        flip(*pair(), hdr=False)
    assert raised.value.diagnostics[0].code == "RG748"
    assert raised.value.diagnostics[0].data["reason"] == "No good. Exiting."
    assert capfd.readouterr() == ("", "")


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    judged, truth = pair()
    with pytest.raises(RenderGraphError) as raised:
        flip_version()
    assert (raised.value.diagnostics[0].code, raised.value.exit_code) == ("RG749", 3)
    metrics = compare(Quantity.DISPLAY, judged, truth)
    assert "flip" not in metrics
    assert "ssim" in metrics
    with pytest.raises(RenderGraphError):
        compare(Quantity.DISPLAY, judged, truth, metrics=["flip"])


@pytest.mark.parametrize("pixels_per_degree", [0.0, -1.0, nan, inf])
def test_pixels_per_degree_are_positive(pixels_per_degree: float) -> None:
    with pytest.raises(ValueError):
        flip(*pair(), hdr=False, pixels_per_degree=pixels_per_degree)
