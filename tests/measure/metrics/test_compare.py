"""Every metric of every quantity: by hand, with masks, where nothing is known, and where a number is none."""

import json
from math import inf, log10, nan, sqrt

import numpy as np
import numpy.typing as npt
import pytest

from rendergraph.measure.metrics import (
    HEADLINE,
    LARGER_IS_BETTER,
    METRICS,
    as_json,
    compare,
    error_map,
    unit,
    worst_texel,
)
from rendergraph.node.reference import Quantity

F64 = npt.NDArray[np.float64]


def row(*values: float) -> F64:
    return np.array(values, np.float64).reshape(1, -1, 1)


def pair(quantity: Quantity, shape: tuple[int, int] = (20, 30)) -> tuple[F64, F64]:
    draw = np.random.default_rng(5)
    channels = 3 if quantity in (Quantity.DISPLAY, Quantity.RADIANCE, Quantity.NORMAL) else 1
    truth = draw.random((*shape, channels))
    if quantity is Quantity.IDENTITY:
        truth = np.floor(8 * truth)
        return np.where(draw.random(truth.shape) > 0.2, truth, truth + 1), truth
    return truth + draw.normal(0.0, 0.05, truth.shape), truth


def test_the_table_is_whole() -> None:
    assert set(METRICS) == set(HEADLINE) == set(Quantity)
    for quantity in Quantity:
        assert HEADLINE[quantity] in METRICS[quantity]
        assert HEADLINE[quantity] not in LARGER_IS_BETTER
        assert "not_finite" in METRICS[quantity]
        assert set(compare(quantity, *pair(quantity))) == set(METRICS[quantity])
    assert (unit(Quantity.NORMAL, "p99"), unit(Quantity.DEPTH, "max_ulp")) == ("degrees", "ulp")
    assert (unit(Quantity.DISPLAY, "psnr"), unit(Quantity.DISPLAY, "max")) == ("dB", "")
    assert (unit(Quantity.NORMAL, "max_length"), unit(Quantity.NORMAL, "not_finite")) == ("", "texels")


def test_scalar_by_hand() -> None:
    # errors 1, 0, 2, 0 of truths 2, 5, -4, 0
    found = compare(Quantity.SCALAR, row(3, 5, -6, 0), row(2, 5, -4, 0))
    assert found == {
        "max": 2, "mean": 0.75, "rmse": sqrt(5 / 4), "p50": 0, "p99": 2,
        "max_relative": 0.5, "mean_relative": 0.25, "p99_relative": 0.5, "not_finite": 0,
    }  # fmt: skip


def test_depth_by_hand() -> None:
    # a step of float32 above 0.5 is 2^-24: 2 steps and 0
    found = compare(Quantity.DEPTH, row(0.5 + 2**-23, 0.25), row(0.5, 0.25))
    assert found["max"] == 2**-23
    assert (found["max_ulp"], found["mean_ulp"], found["p99_ulp"]) == (2, 1, 2)
    assert (found["max_relative"], found["mean_relative"]) == (2**-22, 2**-23)


def test_share_by_hand() -> None:
    # errors 0.5 and 0.1; squares 0.25 and 0.01
    found = compare(Quantity.SHARE, row(1.0, 0.4), row(0.5, 0.5))
    assert found["psnr"] == pytest.approx(10 * log10(2 / 0.26))
    assert found["p50"] == pytest.approx(0.1)


def test_radiance_by_hand() -> None:
    found = compare(Quantity.RADIANCE, row(11.0), row(10.0), metrics=["rel_mse", "max"])
    assert found == {"rel_mse": pytest.approx(1 / 100.001), "max": 1.0}


def test_normals_by_hand() -> None:
    # 90 degrees with a length of 2, and equal
    judged = np.array([[[2.0, 0, 0], [0, 0, 1]]])
    found = compare(Quantity.NORMAL, judged, np.array([[[0.0, 1, 0], [0, 0, 1]]]))
    assert found == {
        "max": 90, "mean": 45, "rmse": pytest.approx(90 / sqrt(2)), "p50": 0, "p99": 90,
        "max_length": 1, "not_finite": 0,
    }  # fmt: skip


def test_identity_by_hand() -> None:
    assert compare(Quantity.IDENTITY, row(1, 2, 3, nan), row(1, 9, 3, 4)) == {"mismatch_rate": 0.5, "not_finite": 1}


@pytest.mark.parametrize("quantity", list(Quantity))
@pytest.mark.parametrize("held", [0.0, -7.0, 1e38, nan, inf])
def test_a_masked_texel_changes_no_number(quantity: Quantity, held: float) -> None:
    judged, truth = pair(quantity)
    mask = np.random.default_rng(9).random(truth.shape[:2]) > 0.3
    expected = compare(quantity, judged, truth, mask)
    mapped = error_map(quantity, judged, truth, mask)
    judged[~mask], truth[~mask] = held, 0.25
    assert compare(quantity, judged, truth, mask) == expected
    np.testing.assert_array_equal(error_map(quantity, judged, truth, mask), mapped)
    assert compare(quantity, judged, truth) != expected  # the twin: without the mask it does


@pytest.mark.parametrize("quantity", list(Quantity))
def test_only_known_texels_count(quantity: Quantity) -> None:
    judged, truth = pair(quantity)
    mask = np.zeros(truth.shape[:2], bool)
    mask[4:9, 6:21] = True
    whole, part = compare(quantity, judged, truth, mask), compare(quantity, judged[4:9, 6:21], truth[4:9, 6:21])
    pointwise = [name for name in part if name not in ("flip", "ssim")]
    assert {name: whole[name] for name in pointwise} == {name: part[name] for name in pointwise}
    if "ssim" in part:
        assert whole["ssim"] == pytest.approx(part["ssim"])


@pytest.mark.parametrize("quantity", list(Quantity))
def test_nothing_known(quantity: Quantity) -> None:
    judged, truth = pair(quantity)
    nothing = np.zeros(truth.shape[:2], bool)
    found = compare(quantity, judged, truth, nothing)
    assert found == dict.fromkeys(METRICS[quantity])
    errors = error_map(quantity, judged, truth, nothing)
    assert np.isnan(errors).all()
    assert worst_texel(errors) is None


@pytest.mark.parametrize("quantity", list(Quantity))
def test_equal_images(quantity: Quantity) -> None:
    truth = pair(quantity)[1]
    found = compare(quantity, truth, truth)
    special = {"psnr": None, "ssim": pytest.approx(1.0)}
    assert found == {name: special.get(name, 0) for name in METRICS[quantity]}


@pytest.mark.parametrize("quantity", list(Quantity))
@pytest.mark.parametrize("held", [nan, inf, -inf])
def test_a_number_that_is_none_is_infinitely_wrong(quantity: Quantity, held: float) -> None:
    judged, truth = pair(quantity)
    judged[7, 11, 0] = held
    found = compare(quantity, judged, truth)
    assert found["not_finite"] == 1
    middle = ("p50", "p99", "p99_ulp", "p99_relative", "not_finite", "mismatch_rate")
    for name in set(METRICS[quantity]) - set(middle):
        assert found[name] == (-inf if name in LARGER_IS_BETTER else inf), name
    assert worst_texel(error_map(quantity, judged, truth)) == (11, 7) or quantity is Quantity.IDENTITY
    truth[7, 11] = judged[7, 11]
    assert compare(quantity, judged, truth)["not_finite"] == 0


@pytest.mark.parametrize("quantity", [q for q in Quantity if "max" in METRICS[q]])
def test_the_largest_of_the_map_is_the_metric(quantity: Quantity) -> None:
    judged, truth = pair(quantity)
    for name in ("max", "max_ulp", "max_relative", "max_length"):
        if name in METRICS[quantity]:
            errors = error_map(quantity, judged, truth, metric=name)
            assert errors.shape == truth.shape[:2]
            assert errors.max() == compare(quantity, judged, truth)[name]


def test_maps_and_their_worst_texel() -> None:
    judged, truth = np.zeros((4, 5, 2)), np.zeros((4, 5, 2))
    judged[3, 1], judged[0, 4] = (0.1, -0.5), (0.3, 0.3)
    mask = np.ones((4, 5), bool)
    errors = error_map(Quantity.SCALAR, judged, truth, mask)
    assert (errors[3, 1], errors[0, 4], errors.sum()) == (0.5, 0.3, 0.8)
    assert worst_texel(errors) == (1, 3)
    mask[3, 1] = False
    errors = error_map(Quantity.SCALAR, judged, truth, mask)
    assert np.isnan(errors[3, 1])
    assert worst_texel(errors) == (4, 0)


def test_the_map_of_ssim_is_its_distance_from_likeness() -> None:
    judged, truth = pair(Quantity.SHARE)
    assert 1 - error_map(Quantity.SHARE, judged, truth, metric="ssim").mean() == pytest.approx(
        compare(Quantity.SHARE, judged, truth)["ssim"]
    )


def test_identities_map_to_ones() -> None:
    assert error_map(Quantity.IDENTITY, row(1, 5), row(1, 2)).tolist() == [[0, 1]]


def test_json_has_no_infinities_and_tells_its_nones_apart() -> None:
    truth = row(0.5, 0.25)
    equal = as_json(compare(Quantity.SHARE, truth, truth))
    lost = as_json(compare(Quantity.SHARE, row(nan, 0.25), truth))
    unknown = as_json(compare(Quantity.SHARE, truth, truth, np.zeros((1, 2), bool)))
    untrue = as_json(compare(Quantity.SHARE, truth, truth * nan))
    for metrics in (equal, lost, unknown, untrue):
        json.dumps(metrics, allow_nan=False)
    assert (equal["psnr"], equal["rmse"]) == (None, 0)
    assert (lost["psnr"], lost["rmse"], lost["p50"]) == (None, None, 0)
    assert set(unknown.values()) == {None}
    assert (untrue["rmse"], untrue["p50"], untrue["not_finite"]) == (None, None, 0)


def test_images_without_channels_and_of_integers() -> None:
    assert compare(Quantity.SCALAR, np.array([[1, 4]]), np.array([[1, 2]]))["max"] == 2
    big = np.array([[2**32 - 1]], np.uint32)
    assert compare(Quantity.IDENTITY, big, big - np.uint32(1))["mismatch_rate"] == 1


@pytest.mark.parametrize(
    ("judged", "truth", "mask", "metrics"),
    [
        (np.zeros((2, 3, 1)), np.zeros((3, 2, 1)), None, None),
        (np.zeros((0, 3, 1)), np.zeros((0, 3, 1)), None, None),
        (np.zeros(3), np.zeros(3), None, None),
        (np.zeros((1, 2, 3, 1)), np.zeros((1, 2, 3, 1)), None, None),
        (np.zeros((2, 3, 1)), np.zeros((2, 3, 1)), np.ones((3, 2), bool), None),
        (np.zeros((2, 3, 1)), np.zeros((2, 3, 1)), np.ones((2, 3)), None),
        (np.zeros((2, 3, 1)), np.zeros((2, 3, 1)), None, ["psnr"]),
    ],
)
def test_what_fits_not_is_refused(judged: F64, truth: F64, mask: F64 | None, metrics: list[str] | None) -> None:
    with pytest.raises(ValueError):
        compare(Quantity.SCALAR, judged, truth, mask, metrics)  # type: ignore[arg-type]
    if metrics:
        with pytest.raises(ValueError):
            error_map(Quantity.SCALAR, judged, truth, metric=metrics[0])
