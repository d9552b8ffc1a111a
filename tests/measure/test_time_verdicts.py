"""Verdicts by simulation: false alarms stay rare, true slowdowns are found, and doubt is never called unchanged."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from rendergraph.measure.intervals import shift_of_pairs
from rendergraph.measure.rank_tests import signed_rank
from rendergraph.measure.run_shift import Runs
from rendergraph.measure.statistics import Change, Thresholds, Verdict, compare_blocks, compare_runs
from tests.measure.noise import autoregression, interleaved, one_run

USUAL = Thresholds()


def stored(before: Runs, after: Runs, thresholds: Thresholds = USUAL) -> Change:
    """The verdict on one pair of stored runs."""
    return compare_runs({"frame": before}, {"frame": after}, thresholds)["frame"]


def paired(sides: tuple[Runs, Runs], thresholds: Thresholds = USUAL) -> Change:
    """The verdict on interleaved blocks."""
    return compare_blocks({"frame": sides[0]}, {"frame": sides[1]}, thresholds)["frame"]


def of(values: np.ndarray) -> Runs:
    """One run of one process."""
    return Runs((values,), (0,))


# ---- false alarms and power


@pytest.mark.parametrize("coefficient", [0.3, 0.6, 0.9])
def test_a_thousand_stored_pairs_without_change(coefficient: float) -> None:
    rng = np.random.default_rng(11)
    verdicts = Counter(
        stored(one_run(rng, 100, coefficient, 0.1), one_run(rng, 100, coefficient, 0.1)).verdict for _ in range(1000)
    )
    assert verdicts[Verdict.SLOWER] <= 10
    assert verdicts[Verdict.FASTER] <= 10


@pytest.mark.parametrize(("coefficient", "layout"), [(0.5, 0.0), (0.9, 0.0), (0.5, 0.02), (0.5, 0.1)])
def test_a_thousand_interleaved_pairs_without_change(coefficient: float, layout: float) -> None:
    rng = np.random.default_rng(13)
    verdicts = Counter(paired(interleaved(rng, coefficient, 0.08, layout=layout)).verdict for _ in range(1000))
    assert verdicts[Verdict.SLOWER] <= 10
    assert verdicts[Verdict.FASTER] <= 10


def test_a_thousand_frames_of_thirteen_passes_without_change() -> None:
    """Holm at work: one false alarm among all passes of a frame counts against the frame."""
    rng = np.random.default_rng(17)
    alarms = 0
    for _ in range(250):
        sides = {f"pass_{i}": interleaved(rng, 0.5, 0.08) for i in range(13)}
        changes = compare_blocks({n: s[0] for n, s in sides.items()}, {n: s[1] for n, s in sides.items()}, USUAL)
        alarms += any(change.verdict is Verdict.SLOWER for change in changes.values())
    assert alarms <= 2


def test_processes_that_differ_by_a_tenth_are_not_passes_that_changed() -> None:
    """Thirteen passes, for each of which either side draws its own shift in every process."""
    alarms = {}
    for shape in ((10, 3, 5), (5, 6, 5)):
        rng = np.random.default_rng(23)
        alarms[shape] = 0
        for _ in range(150):
            sides = {f"pass_{i}": interleaved(rng, 0.5, 0.04, layout=0.1, shape=shape) for i in range(13)}
            changes = compare_blocks({n: s[0] for n, s in sides.items()}, {n: s[1] for n, s in sides.items()}, USUAL)
            alarms[shape] += any(change.verdict is Verdict.SLOWER for change in changes.values())
    assert alarms[10, 3, 5] <= 1
    assert alarms[10, 3, 5] <= alarms[5, 6, 5], "as many blocks of fewer processes know no more"


def test_naive_independence_would_raise_false_alarms() -> None:
    """The twin that must fail: the same noise shuffled, so that nothing tells how alike neighbours were."""
    rng = np.random.default_rng(11)
    alarms = 0
    for _ in range(200):
        shuffled = [rng.permutation(one_run(rng, 100, 0.9, 0.1).samples[0]) for _ in range(2)]
        alarms += stored(*(of(values) for values in shuffled)).verdict is Verdict.SLOWER
    assert alarms >= 6  # of 200; the rate above allows 2


@pytest.mark.parametrize(("noise", "layout"), [(0.05, 0.0), (0.05, 0.01), (0.04, 0.02)])
def test_a_slowdown_of_a_tenth_is_found_interleaved(noise: float, layout: float) -> None:
    rng = np.random.default_rng(19)
    found = Counter(paired(interleaved(rng, 0.5, noise, slowdown=1.1, layout=layout)).verdict for _ in range(300))
    assert found[Verdict.SLOWER] >= 285


def test_a_slowdown_of_a_tenth_is_found_among_thirteen_passes() -> None:
    rng = np.random.default_rng(23)
    found = 0
    for _ in range(100):
        sides = {f"pass_{i}": interleaved(rng, 0.5, 0.04, slowdown=1.0 if i else 1.1, layout=0.01) for i in range(13)}
        changes = compare_blocks({n: s[0] for n, s in sides.items()}, {n: s[1] for n, s in sides.items()}, USUAL)
        found += changes["pass_0"].verdict is Verdict.SLOWER
    assert found >= 95


def test_a_slowdown_of_a_tenth_is_found_in_stored_runs() -> None:
    rng = np.random.default_rng(29)
    found = Counter(stored(one_run(rng, 100, 0.5, 0.03), one_run(rng, 100, 0.5, 0.03, 1.1)).verdict for _ in range(300))
    assert found[Verdict.SLOWER] >= 285


def test_a_speedup_is_faster() -> None:
    rng = np.random.default_rng(31)
    assert paired(interleaved(rng, 0.3, 0.03, slowdown=0.8)).verdict is Verdict.FASTER
    assert stored(one_run(rng, 100, 0.3, 0.03), one_run(rng, 100, 0.3, 0.03, 0.8)).verdict is Verdict.FASTER


# ---- unchanged is a finding, not a default


def test_quiet_equal_runs_are_unchanged() -> None:
    rng = np.random.default_rng(37)
    assert stored(one_run(rng, 200, 0.2, 0.02), one_run(rng, 200, 0.2, 0.02)).verdict is Verdict.UNCHANGED
    assert paired(interleaved(rng, 0.2, 0.01)).verdict is Verdict.UNCHANGED


def test_a_real_slowdown_is_hardly_ever_unchanged() -> None:
    rng = np.random.default_rng(41)
    found = Counter(paired(interleaved(rng, 0.7, 0.3, slowdown=1.1)).verdict for _ in range(300))
    assert found[Verdict.UNCHANGED] <= 3
    assert found[Verdict.INCONCLUSIVE] >= 200


def test_a_significant_change_below_the_floor_is_unchanged() -> None:
    rng = np.random.default_rng(43)
    change = paired(interleaved(rng, 0.2, 0.003, slowdown=1.01))
    assert change.p is not None
    assert change.p < 1e-3
    assert (change.verdict, change.reason) == (Verdict.UNCHANGED, "inside_floor")
    tight = paired(interleaved(rng, 0.2, 0.003, slowdown=1.01), Thresholds(relative=0.004, absolute_ms=0.0))
    assert tight.verdict is Verdict.SLOWER


def test_the_absolute_floor_spares_tiny_passes() -> None:
    rng = np.random.default_rng(47)
    before, after = interleaved(rng, 0.2, 0.02, slowdown=1.5)
    tiny = [Runs(tuple(run * 0.010 for run in side.samples), side.processes) for side in (before, after)]
    change = paired((tiny[0], tiny[1]))  # 10 us -> 15 us
    assert change.verdict is Verdict.UNCHANGED
    assert change.floor == 0.010


def test_one_process_a_side_has_a_wider_floor() -> None:
    rng = np.random.default_rng(53)
    before, after = one_run(rng, 200, 0.1, 0.01), one_run(rng, 200, 0.1, 0.01, 1.04)
    assert stored(before, after).verdict is Verdict.UNCHANGED
    spread = [Runs(tuple(np.split(r.samples[0], 5)), (0, 1, 2, 3, 4)) for r in (before, after)]
    assert stored(spread[0], spread[1]).verdict is Verdict.SLOWER


# ---- too little to tell


@pytest.mark.parametrize("count", [1, 5, 9])
def test_few_samples_are_inconclusive_however_far_apart(count: int) -> None:
    change = stored(of(np.linspace(1, 1.01, count)), of(np.linspace(9, 9.01, count)))
    assert (change.verdict, change.reason) == (Verdict.INCONCLUSIVE, "too_few_samples")


def test_few_blocks_are_inconclusive_however_many_frames() -> None:
    rng = np.random.default_rng(59)
    change = paired(interleaved(rng, 0.1, 0.01, slowdown=2.0, shape=(3, 2, 100)))
    assert (change.verdict, change.reason) == (Verdict.INCONCLUSIVE, "too_few_samples")


def test_no_samples() -> None:
    change = stored(of(np.array([])), of(np.ones(20)))
    assert (change.verdict, change.reason, change.before, change.shift) == (
        Verdict.INCONCLUSIVE,
        "no_samples",
        None,
        None,
    )
    empty = Runs((), ())
    assert compare_blocks({"frame": empty}, {"frame": empty}, USUAL)["frame"].reason == "no_samples"


def test_two_drifting_runs_are_not_evidence() -> None:
    change = stored(of(1 + np.linspace(0, 1, 60)), of(1.5 + np.linspace(0, 1, 60)))
    assert (change.verdict, change.reason) == (Verdict.INCONCLUSIVE, "dependent")


def test_identical_constant_times_are_unchanged() -> None:
    constant = of(np.full(30, 2.0))
    assert stored(constant, constant).verdict is Verdict.UNCHANGED
    blocks = Runs(tuple(np.full(5, 2.0) for _ in range(20)), tuple(i // 4 for i in range(20)))
    assert paired((blocks, blocks)).verdict is Verdict.UNCHANGED


def scattered(rng: np.random.Generator, count: int, middle: float) -> Runs:
    return Runs(tuple(middle * np.exp(rng.normal(0, 1.2, (count, 1)))), tuple(range(count)))


@pytest.mark.parametrize("compare", [compare_blocks, compare_runs])
def test_nothing_gets_faster_than_no_time_at_all(compare: Callable[..., dict[str, Change]]) -> None:
    """Pairs that scatter: their differences reach far below minus the time before, their ratios never below nothing."""
    rng = np.random.default_rng(73)
    beyond = 0
    for _ in range(50):
        before, after = scattered(rng, 20, 1.0), scattered(rng, 20, 0.3)
        change = compare({"f": before}, {"f": after}, USUAL)["f"]
        assert change.before is not None
        assert change.low is not None
        assert change.relative is not None
        assert -1 < change.low / change.before <= change.relative <= (change.high or np.inf) / change.before
        a, b = (np.concatenate(side.samples) for side in (before, after))
        difference = shift_of_pairs(b - a, signed_rank(b - a), USUAL.alpha)
        beyond += difference.low < -change.before
    assert beyond > 25, "the same as differences would have said more than -100 %"


def test_a_change_and_its_reverse_are_one_another_s_inverse() -> None:
    rng = np.random.default_rng(79)
    before, after = interleaved(rng, 0.5, 0.2, slowdown=2.0)
    for compare in (compare_blocks, compare_runs):
        there, back = compare({"f": before}, {"f": after}, USUAL)["f"], compare({"f": after}, {"f": before}, USUAL)["f"]
        assert there.relative is not None
        assert back.relative is not None
        assert (1 + there.relative) * (1 + back.relative) == pytest.approx(1.0)
        assert there.p == pytest.approx(back.p)


def test_with_times_of_zero_the_limits_stay_above_no_time() -> None:
    rng = np.random.default_rng(83)
    a, b = np.abs(rng.normal(1, 0.9, 40)), np.zeros(40)
    change = stored(of(a), of(b))
    assert change.verdict is Verdict.FASTER
    assert change.before is not None
    assert change.low == -change.before


def test_times_of_zero_need_no_division() -> None:
    """A pass below the clock's resolution."""
    rng = np.random.default_rng(61)
    change = stored(of(np.zeros(40)), of(np.abs(rng.normal(0.2, 0.01, 40))))
    assert change.verdict is Verdict.SLOWER
    assert change.relative is None


def test_long_runs_are_cut_into_stretches() -> None:
    rng = np.random.default_rng(67)
    change = stored(one_run(rng, 10_007, 0.9, 0.1), one_run(rng, 10_007, 0.9, 0.1, 1.1))
    assert change.verdict is Verdict.SLOWER
    assert 200 <= change.compared <= 260
    assert change.samples == (10_007, 10_007)


def test_only_names_of_both_sides_are_compared() -> None:
    rng = np.random.default_rng(71)
    run = of(np.exp(autoregression(rng, 20, 0.1)))
    assert list(compare_runs({"a": run, "b": run}, {"b": run, "c": run}, USUAL)) == ["b"]
