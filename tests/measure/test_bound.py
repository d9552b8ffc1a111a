"""Bound classification on made-up rounds whose class is known by construction."""

from dataclasses import replace

import pytest

from rendergraph.measure.bound import THRESHOLDS, bound_of, classify
from rendergraph.measure.bound_evidence import Evidence, RoundTimes, weigh
from rendergraph.report.bound_text import bound_text
from rendergraph.run.result import StepCounters


def frame(ms: float, submit: float = 0.0, readback: float = 0.0) -> RoundTimes:
    return RoundTimes(ms, submit + readback, submit, ms, readback, 0.0)


#: A frame of 4000 calls, 10 ms; one of heavy pixels; one that waits for a readback; one of Python alone.
CALLS = {
    "base": frame(10, 9), "half_resolution": frame(10, 9), "nothing_rasterised": frame(9.5, 9), "no_draws": frame(1, 1),
}  # fmt: skip
PIXELS = {
    "base": frame(10, 0.2), "half_resolution": frame(2.7, 0.2), "nothing_rasterised": frame(0.4, 0.2),
    "no_draws": frame(0.3, 0.2),
}  # fmt: skip
READBACK = {
    "base": frame(10, 0.5, 8), "half_resolution": frame(4, 0.5, 3), "nothing_rasterised": frame(6, 0.5, 5),
    "no_draws": frame(6, 0.5, 5), "no_readback": frame(5, 0.5),
}  # fmt: skip
HOST = {
    "base": frame(10, 9.8), "half_resolution": frame(10, 9.8), "nothing_rasterised": frame(9.9, 9.8),
    "no_draws": frame(9.5, 9.4),
}  # fmt: skip
MANY = [StepCounters("p.draw", draws=4000, triangles=4000 * 12)]
ONE = [StepCounters("p.draw", draws=1, triangles=48000)]
COPY = [StepCounters("p.draw", draws=1, triangles=1), StepCounters("q.copy", host_bytes=1 << 20)]


@pytest.mark.parametrize(
    ("rounds", "counters", "expected"),
    [
        (CALLS, MANY, "draw_calls"),
        (CALLS, ONE, "gpu"),  # the same times of one large draw: vertices, not calls
        (PIXELS, ONE, "gpu"),
        (PIXELS, MANY, "gpu"),  # small draws that cost nothing are not what binds
        (READBACK, COPY, "sync"),
        ({**READBACK, "no_readback": frame(9.8, 0.5)}, COPY, "gpu"),  # the wait only moved to the frame's end
        (HOST, ONE, "cpu"),
    ],
)
def test_classes(rounds: dict[str, RoundTimes], counters: list[StepCounters], expected: str) -> None:
    found = classify({name: [run] * 3 for name, run in rounds.items()}, counters)
    assert found["class"] == expected
    assert found["agreement"] == 1.0
    assert found["advice"]


def test_evidence_is_shares_of_the_frame() -> None:
    found = weigh(READBACK, COPY)
    assert found == Evidence(
        submit_share=0.05, readback_share=0.8, half_resolution=0.4, nothing_rasterised=0.6, no_draws=0.6,
        no_readback=0.5, draws=1, primitives_per_draw=1.0, readback_bytes=1 << 20,
    )  # fmt: skip


def test_the_device_s_own_count_of_primitives_goes_before_the_plan_s() -> None:
    step = StepCounters("p.draw", draws=2, triangles=0, statistics={"primitives": 10})
    assert weigh(PIXELS, [step]).primitives_per_draw == 5.0
    unknown = StepCounters("p.draw", draws=1, triangles=None)
    assert weigh(PIXELS, [unknown]).primitives_per_draw is None
    assert weigh(PIXELS, []).primitives_per_draw is None


def test_no_readback_without_bytes_read_back() -> None:
    waits = replace(weigh(READBACK, COPY), readback_bytes=0)
    assert bound_of(waits) != "sync"


def test_thresholds_part_the_classes() -> None:
    """Twins on either side of each threshold."""
    sync, calls = weigh(READBACK, COPY), weigh(CALLS, MANY)
    assert bound_of(replace(sync, readback_share=THRESHOLDS.waiting - 0.01)) != "sync"
    assert bound_of(replace(sync, no_readback=THRESHOLDS.recovered + 0.01)) != "sync"
    for changed in (
        {"nothing_rasterised": THRESHOLDS.calling - 0.01},
        {"half_resolution": THRESHOLDS.pixels},
        {"submit_share": THRESHOLDS.submitting - 0.01},
        {"primitives_per_draw": THRESHOLDS.small_draw},
    ):
        assert bound_of(replace(calls, **changed)) == "gpu"
    assert bound_of(replace(calls, no_draws=THRESHOLDS.drawing + 0.01)) == "cpu"


def test_rounds_that_disagree_are_told() -> None:
    """Medians decide; the record says how many rounds would have said so alone."""
    noisy = {name: [run, run, run] for name, run in CALLS.items()}
    noisy["no_draws"] = [frame(1, 1), frame(9, 9), frame(1, 1)]
    found = classify(noisy, MANY)
    assert found["class"] == "draw_calls"
    assert found["agreement"] == pytest.approx(2 / 3, abs=1e-3)
    assert len(found["runs"]["no_draws"]) == 3


def test_a_frame_of_no_time_divides_nothing_by_zero() -> None:
    nothing = {name: frame(0.0) for name in PIXELS}
    assert classify({name: [run] for name, run in nothing.items()}, [])["class"] in ("gpu", "cpu")


def test_a_graph_without_half_its_size_is_told_by_the_rest() -> None:
    """Sizes that are fixed and fit one frame alone: no figure for pixels, so none is made up."""
    for rounds, counters, expected in ((CALLS, MANY, "draw_calls"), (PIXELS, ONE, "gpu"), (HOST, ONE, "cpu")):
        kept = {name: [run] for name, run in rounds.items() if name != "half_resolution"}
        found = classify(kept, counters)
        assert found["evidence"]["half_resolution"] is None
        assert found["class"] == expected
        assert "half resolution " not in bound_text("the frame", found)
        assert "nothing rasterised" in bound_text("the frame", found)


def test_draws_are_counted_in_the_singular() -> None:
    assert bound_text("A", classify({name: [run] for name, run in PIXELS.items()}, ONE)).endswith(
        "1 draw of 48000 primitives"
    )
    few = [StepCounters("p.draw", draws=2, triangles=2)]
    assert bound_text("A", classify({name: [run] for name, run in PIXELS.items()}, few)).endswith(
        "2 draws of 1 primitive"
    )
