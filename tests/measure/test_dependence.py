"""How many samples are worth one: known answers of autoregressions and of processes that differ."""

import numpy as np
import pytest

from rendergraph.measure.autocorrelation import autocorrelation_time
from rendergraph.measure.clusters import Sampled, dependence_of_pairs, dependence_of_samples
from tests.measure.noise import autoregression


@pytest.mark.parametrize(("coefficient", "time"), [(0.0, 1.0), (0.5, 3.0), (0.8, 9.0), (0.9, 19.0)])
def test_the_time_of_an_autoregression(coefficient: float, time: float) -> None:
    """(1 + c) / (1 - c), somewhat less for ranks; of long sequences, so that the estimate settles."""
    rng = np.random.default_rng(5)
    found = np.median([autocorrelation_time([autoregression(rng, 4000, coefficient)]) for _ in range(9)])
    assert 0.85 * time <= found <= 1.25 * time + 0.1


def test_alternating_samples_are_worth_one_each() -> None:
    assert autocorrelation_time([np.tile([1.0, 2.0], 50)]) == 1.0


def test_a_trend_is_worth_next_to_nothing() -> None:
    assert autocorrelation_time([np.arange(100.0)]) > 20


def test_a_stutter_hides_no_drift() -> None:
    drifting = autoregression(np.random.default_rng(2), 400, 0.9)
    stuttering = drifting.copy()
    stuttering[::97] += 1000.0
    assert autocorrelation_time([stuttering]) > 0.5 * autocorrelation_time([drifting])


def test_constant_and_tiny_sequences_say_nothing() -> None:
    assert autocorrelation_time([np.full(50, 3.0)]) == 1.0
    assert autocorrelation_time([np.array([1.0, 2.0])]) == 1.0


def test_processes_that_differ_count_as_few_samples() -> None:
    rng = np.random.default_rng(7)
    processes = np.repeat(np.arange(5), 20)
    apart = Sampled(rng.normal(size=100) + 100.0 * processes, processes.tolist())
    found = dependence_of_pairs(apart)
    # All the variance is between the five: 100 samples are worth 99 / 20, and the figure rests on four.
    assert found.inflation == pytest.approx(99 / 4, rel=0.05)
    assert found.freedom == pytest.approx(4, rel=0.2)
    alike = Sampled(rng.normal(size=100), processes.tolist())
    assert dependence_of_pairs(alike).inflation < 3


def test_a_figure_from_processes_is_known_as_well_as_they_are_many() -> None:
    """However small the part of the variance that is between them: its estimate rests on their number alone."""
    rng = np.random.default_rng(8)
    for count in (4, 10):
        processes = np.repeat(np.arange(count), 40)
        values = rng.normal(size=40 * count) + 0.7 * rng.normal(size=count)[processes]
        found = dependence_of_pairs(Sampled(values, processes.tolist()))
        assert 1.5 < found.inflation < 39
        assert found.freedom == count - 1


def test_sides_measured_apart_see_drift_within_a_process_too() -> None:
    rng = np.random.default_rng(9)
    processes = np.repeat(np.arange(5), 20).tolist()
    drifting = [Sampled(autoregression(rng, 100, 0.9), processes) for _ in range(2)]
    assert dependence_of_samples(*drifting).inflation > 4


def test_one_process_leaves_the_order_in_time() -> None:
    trend = Sampled(np.arange(50.0), [0] * 50)
    assert dependence_of_pairs(trend).inflation > 10
    assert dependence_of_samples(trend, trend).inflation > 10
