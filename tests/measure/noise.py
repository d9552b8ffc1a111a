"""Made-up frame times: autocorrelated noise, in processes and interleaved blocks as `rg bench` measures them."""

from __future__ import annotations

import numpy as np

from rendergraph.measure.rank_tests import Floats
from rendergraph.measure.run_shift import Runs


def autoregression(rng: np.random.Generator, count: int, coefficient: float) -> Floats:
    """A first-order autoregression of variance 1, in equilibrium from the start."""
    steps = rng.standard_normal(count)
    steps[1:] *= np.sqrt(1 - coefficient**2)
    values = np.empty(count)
    last = 0.0
    for index, step in enumerate(steps.tolist()):
        last = coefficient * last + step if index else step
        values[index] = last
    return values


def one_run(rng: np.random.Generator, count: int, coefficient: float, noise: float, middle: float = 1.0) -> Runs:
    """Frames of one process, lognormal about ``middle`` ms."""
    return Runs((middle * np.exp(noise * autoregression(rng, count, coefficient)),), (0,))


def interleaved(
    rng: np.random.Generator,
    coefficient: float,
    noise: float,
    *,
    slowdown: float = 1.0,
    layout: float = 0.0,
    shape: tuple[int, int, int] = (10, 3, 5),
) -> tuple[Runs, Runs]:
    """Two sides in turn: ``shape`` is processes, blocks of each side, frames a block, as `rg bench` has them by itself.
    ``layout`` is the spread of what each process draws anew for either side.
    """
    processes, blocks, frames = shape
    sides: tuple[list[Floats], list[Floats]] = ([], [])
    for process in range(processes):
        timeline = noise * autoregression(rng, 2 * blocks * frames, coefficient)
        drawn = layout * rng.standard_normal(2)
        for block in range(blocks):
            first = (process + block) % 2
            for turn, side in enumerate((first, 1 - first)):
                start = (2 * block + turn) * frames
                times = np.exp(timeline[start : start + frames] + drawn[side])
                sides[side].append(times * (slowdown if side else 1.0))
    of = tuple(process for process in range(processes) for _ in range(blocks))
    return Runs(tuple(sides[0]), of), Runs(tuple(sides[1]), of)
