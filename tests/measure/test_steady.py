"""Warm-up detection on traces whose steady frame is known."""

import math
import random

import pytest

from rendergraph.measure.steady import BAND, HOLD, WINDOW, steady_from

LEAST = WINDOW + HOLD - 1


def detected(trace: list[float]) -> tuple[int, int | None]:
    """Frames run until a run that asks after every frame stops, and the first steady one."""
    for count in range(1, len(trace) + 1):
        found = steady_from(trace[:count])
        if found is not None:
            return count, found
    return len(trace), None


def test_a_constant_trace_is_steady_from_the_start() -> None:
    assert detected([10.0] * 40) == (LEAST, 0)
    assert steady_from([10.0] * (LEAST - 1)) is None, "too few frames to tell"
    assert steady_from([]) is None


@pytest.mark.parametrize("slow", [1, 3, 8, 15])
def test_a_step_is_found_where_it_is(slow: int) -> None:
    """The running median is at the new level once most of its window is: at most half a window before the step."""
    trace = [50.0] * slow + [10.0] * 60
    found = steady_from(trace)
    assert found is not None
    assert slow - WINDOW // 2 <= found <= slow


def test_an_exponential_warm_up() -> None:
    trace = [10.0 * (1.0 + 5.0 * math.exp(-i / 4.0)) for i in range(80)]
    count, found = detected(trace)
    assert found is not None
    assert trace[found + WINDOW // 2] < 10.0 * 1.15, "what is left of the warm-up is small"
    assert count < 60
    whole = steady_from(trace)
    assert whole is not None
    assert trace[whole + WINDOW // 2] <= 10.0 * (1.0 + BAND) * 1.0001


def test_a_drift_is_never_steady() -> None:
    assert detected([10.0 + 0.5 * i for i in range(100)])[1] is None
    random_ = random.Random(1)
    assert detected([10.0 + 0.8 * i + random_.gauss(0.0, 0.1) for i in range(100)])[1] is None


@pytest.mark.parametrize("noise", [0.01, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("seed", range(5))
def test_noise_alone_is_steady_soon(noise: float, seed: int) -> None:
    random_ = random.Random(seed)
    trace = [10.0 * math.exp(random_.gauss(0.0, noise)) for _ in range(60)]
    count, found = detected(trace)
    assert found is not None
    assert count <= 4 * LEAST


def test_single_spikes_do_not_matter() -> None:
    trace = [10.0] * 40
    for index in (4, 11, 23):
        trace[index] = 500.0
    assert detected(trace) == (LEAST, 0)


def test_frames_of_two_kinds_in_turn_are_steady() -> None:
    """A graph with history may take turns between two costs."""
    assert detected([10.0 if i % 2 else 14.0 for i in range(60)])[1] is not None


def test_noise_does_not_hide_a_step() -> None:
    random_ = random.Random(3)
    trace = [(30.0 if i < 12 else 10.0) * math.exp(random_.gauss(0.0, 0.05)) for i in range(60)]
    found = steady_from(trace)
    assert found is not None
    assert 12 - WINDOW // 2 <= found <= 14
