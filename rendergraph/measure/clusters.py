"""Samples of one process resemble each other: memory layout, clock frequency and neighbours are drawn once a process.

The spread between the processes' means, against the spread of all samples, says how much less they are worth.

Source: Kish, "Survey Sampling", 1965, section 5.4 (design effect).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Final

import numpy as np

from rendergraph.measure.autocorrelation import autocorrelation_time
from rendergraph.measure.rank_tests import Floats, average_ranks

#: Processes a side from which the spread between them is trusted.
LEAST_PROCESSES: Final = 4


@dataclass(frozen=True, slots=True)
class Dependence:
    """``inflation`` samples (>= 1) are worth one independent one; ``freedom``: degrees of freedom of that figure."""

    inflation: float
    freedom: float


@dataclass(frozen=True, slots=True)
class Sampled:
    """Values of one side in order of time, 1-d, and the process of each."""

    values: Floats
    processes: Sequence[int]


def dependence_of_samples(a: Sampled, b: Sampled) -> Dependence:
    """The dependence inside two sides measured apart: whichever is larger, that in time or that by process."""
    return max(_in_time([a, b]), _by_process([a, b]), key=lambda found: found.inflation)


def dependence_of_pairs(pairs: Sampled) -> Dependence:
    """The dependence of paired differences. Interleaving has cancelled the drift in time, so what is left goes by
    process; with too few processes to tell, the order in time is all there is.
    """
    known = len(set(pairs.processes)) >= LEAST_PROCESSES
    return _by_process([pairs]) if known else _in_time([pairs])


def _in_time(sides: Sequence[Sampled]) -> Dependence:
    total = sum(len(side.values) for side in sides)
    time = autocorrelation_time([side.values for side in sides])
    return Dependence(time, total / time - len(sides))


def _by_process(sides: Sequence[Sampled]) -> Dependence:
    """From the ranks inside each side; nothing is known (no inflation) of sides with few processes."""
    if any(len(set(side.processes)) < LEAST_PROCESSES for side in sides):
        return Dependence(1.0, inf)
    between = within = 0.0
    groups = total = 0
    for side in sides:
        ranks, names = average_ranks(side.values), np.asarray(side.processes)
        middle = ranks.mean()
        for name in np.unique(names):
            own = ranks[names == name]
            between += len(own) * float(own.mean() - middle) ** 2
            within += float(((own - own.mean()) ** 2).sum())
            groups += 1
        total += len(ranks)
    free_between, free_within = groups - len(sides), total - groups
    everything = (between + within) / (free_between + free_within)
    inflation = max(1.0, between / free_between / everything) if everything else 1.0
    # Widened by the spread between processes, an error is known only as well as the processes are many.
    return Dependence(inflation, free_between if inflation > 1.0 else inf)
