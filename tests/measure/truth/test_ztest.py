"""The z-test by simulation: false alarms as often as stated, a bias of a few sigma caught, no variance survived."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rendergraph.measure.truth.stochastic import judge_frames
from rendergraph.measure.truth.ztest import Moments, ZTest, sidak, z_test
from rendergraph.node.reference import Quantity, Truth
from tests.measure.truth.made_up_runs import image, make_node, measure, run


def simulate(
    seed: int, *, frames: int = 16, bias: float = 0.0, size: tuple[int, int] = (24, 24), **options: Any
) -> ZTest:
    """Normal noise of standard deviation 0.2 about the truth, off by ``bias`` of those."""
    noise = np.random.default_rng(seed).normal(0.2 * bias, 0.2, (frames, *size, 1))
    return z_test(noise.mean(0), noise.var(0, ddof=1), frames, **{"floor": 0.0, **options})


@pytest.mark.parametrize("frames", [4, 16, 64])
def test_any_texel_is_refused_by_chance_as_often_as_stated(frames: int) -> None:
    alarms = sum(simulate(seed, frames=frames, alpha=0.1).score.accepted < 1.0 for seed in range(600))
    # 600 runs of 0.1: 60, give or take 4 standard deviations of 7.3; Wallace's approximation is a little wide at 3
    # degrees of freedom.
    assert 24 <= alarms <= 90


def test_an_image_without_bias_passes() -> None:
    assert all(simulate(seed).passed for seed in range(200))


def test_a_bias_of_a_few_sigma_is_caught_and_one_far_below_chance_is_not() -> None:
    assert not any(simulate(seed, bias=3.0).passed for seed in range(50))
    assert all(simulate(seed, bias=0.05).passed for seed in range(50))


def test_more_frames_catch_a_smaller_bias() -> None:
    caught = [sum(not simulate(s, frames=n, bias=0.7).passed for s in range(10)) for n in (8, 256)]
    assert caught == [0, 10]


def test_a_few_outliers_pass_and_a_wrong_region_does_not() -> None:
    deviation, variance = np.zeros((40, 40, 1)), np.full((40, 40, 1), 0.04)
    deviation.flat[:4] = 10.0  # 0.25 %
    assert z_test(deviation, variance, 16).passed
    deviation.flat[:5] = 10.0
    assert not z_test(deviation, variance, 16).passed
    mask = deviation[..., 0] == 0.0
    assert z_test(deviation, variance, 16, mask=mask).score.accepted == 1.0


def test_without_variance_a_rare_event_is_forgiven_and_a_plain_error_is_not() -> None:
    still = np.zeros((20, 20, 1))
    assert z_test(still + 0.01, still, 16).passed
    assert not z_test(still + 0.1, still, 16).passed
    assert z_test(still, still, 16, floor=0.0).passed  # nothing over nothing
    assert not z_test(still + 1e-9, still, 16, floor=0.0).passed


def test_what_is_not_finite_is_never_accepted() -> None:
    deviation = np.zeros((4, 4, 1))
    deviation[0, 0] = np.nan
    found = z_test(deviation, np.full((4, 4, 1), 0.1), 16)
    assert not found.passed
    assert found.score.accepted == 15 / 16


def test_the_truths_own_error_and_an_allowed_bias_widen_what_is_accepted() -> None:
    deviation, variance = np.full((10, 10, 1), 0.3), np.full((10, 10, 1), 1e-3)
    assert not z_test(deviation, variance, 16).passed
    assert z_test(deviation, variance, 16, truth_error=0.1).passed
    assert z_test(deviation, variance, 16, allowance=0.3).passed
    assert not z_test(deviation, variance, 16, allowance=0.2).passed


def test_sidak_is_what_leaves_the_family_its_significance() -> None:
    each = sidak(0.01, 10_000)
    assert 1 - (1 - each) ** 10_000 == pytest.approx(0.01, rel=1e-9)
    assert sidak(0.01, 1) == pytest.approx(0.01)


def test_one_frame_has_no_variance() -> None:
    with pytest.raises(ValueError):
        z_test(image(), image(), 1)


def test_moments_equal_those_of_all_images_at_once() -> None:
    images = np.random.default_rng(3).normal(1e6, 1.0, (9, 4, 5, 2))  # far from zero: sums of squares would cancel
    moments = Moments()
    for one in images:
        moments.add(one)
    np.testing.assert_allclose(moments.mean, images.mean(0), rtol=1e-12)
    np.testing.assert_allclose(moments.variance, images.var(0, ddof=1), rtol=1e-6)


# ---- nodes


def frames_of(bias: float, seed: int = 1, count: int = 16, **more: Any) -> list[Any]:
    noise = np.random.default_rng(seed).normal(bias, 0.1, (count, 20, 20, 1))
    return [run({"out": 0.5 + frame}, index=index, **more) for index, frame in enumerate(noise)]


@pytest.mark.parametrize(
    ("bias", "tolerance", "verdict"), [(0.0, 0.0, "within"), (0.3, 0.0, "above"), (0.3, 0.31, "within")]
)
def test_a_random_nodes_tolerance_is_its_bias(bias: float, tolerance: float, verdict: str) -> None:
    truth = Truth(image(0.5, (20, 20, 1)))
    node = make_node(lambda run: {"it": truth}, {"it": measure("rmse", tolerance, Quantity.SHARE)}, stochastic=True)
    (judged,) = judge_frames("p", node, frames_of(bias))
    assert (judged.verdict, judged.reason) == (verdict, "z_test")
    assert judged.value == pytest.approx(abs(bias) or 0.025, rel=0.2)  # of the mean: noise over the root of 16


def test_the_truth_of_unchanged_inputs_is_computed_once_and_of_changed_ones_anew() -> None:
    asked = []

    def judge(run: Any) -> dict[str, Truth]:
        asked.append(run.index)
        return {"it": Truth(run.inputs["x"])}

    node = make_node(judge, {"it": measure("rmse", 0.0, Quantity.SHARE)}, stochastic=True)
    same = image(0.5, (20, 20, 1))
    judge_frames("p", node, frames_of(0.0, inputs={"x": same}))
    assert asked == [0]
    asked.clear()
    moving = [
        run({"out": r.outputs["out"] + 0.01 * i}, index=i, inputs={"x": same + 0.01 * i})
        for i, r in enumerate(frames_of(0.0))
    ]
    (judged,) = judge_frames("p", node, moving)
    assert asked == list(range(16))
    assert judged.verdict == "within"


def test_a_truth_noisier_than_the_mean_it_judges_cannot_judge() -> None:
    for error, verdict in ((1.0, "cannot_judge"), (0.001, "within")):
        truth = Truth(image(0.5, (20, 20, 1)), standard_error=error)
        node = make_node(lambda run, t=truth: {"it": t}, {"it": measure("rmse", 0.0, Quantity.SHARE)}, stochastic=True)
        (judged,) = judge_frames("p", node, frames_of(0.0))
        assert judged.verdict == verdict
