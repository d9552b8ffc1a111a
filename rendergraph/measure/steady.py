"""When a run has warmed up: found in its frame times, not guessed.

Caches fill, drivers compile variants and clocks ramp up for a number of frames that nobody can know beforehand. A trace
is steady from the first frame on after which its running median stays within a band round the level it ends at.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt
from statistics import median
from typing import Final

#: Frames in the running median: single slow frames, as other processes cause them, do not move it.
WINDOW: Final = 5
#: Running medians in a row that must agree before the trace counts as settled.
HOLD: Final = 5
#: Half width of the band as a share of the level, and in standard errors of a running median where noise is larger.
BAND: Final = 0.05
ERRORS: Final = 2.0


def steady_from(trace: Sequence[float], window: int = WINDOW, hold: int = HOLD, band: float = BAND) -> int | None:
    """Index of the first steady frame, or ``None`` while the last ``hold`` running medians do not yet agree.

    The level is the median of the last ``hold`` running medians of ``window`` frames. The band round it is ``band`` of
    the level or ``ERRORS`` standard errors of a running median, whichever is wider; the noise is estimated from
    differences of neighbouring frames, which a slow drift hardly enters, so that a drift is not taken for noise.
    Medians that cross more than half of the band's half width in one direction are not settled either.
    """
    if len(trace) < window + hold - 1:
        return None
    medians = [median(trace[i : i + window]) for i in range(len(trace) - window + 1)]
    level = median(medians[-hold:])
    tail = trace[-(window + hold - 1) :]
    width = max(band * level, ERRORS * _error_of_median(tail, window))
    inside = [abs(m - level) <= width for m in medians]
    if not all(inside[-hold:]) or _drifts(medians[-hold:], width / 2):
        return None
    first = len(inside) - 1
    while first > 0 and inside[first - 1]:
        first -= 1
    return first


def _drifts(medians: Sequence[float], width: float) -> bool:
    """Whether running medians move one way all along, by more than ``width``: within the band, but not settled."""
    steps = [b - a for a, b in pairwise(medians)]
    one_way = all(step > 0 for step in steps) or all(step < 0 for step in steps)
    return one_way and abs(medians[-1] - medians[0]) > width


def _error_of_median(samples: Sequence[float], window: int) -> float:
    """Standard error of a median of ``window`` samples, for normal noise of the scale that neighbours differ by."""
    steps = [abs(b - a) for a, b in pairwise(samples)]
    sigma = median(steps) / (0.6745 * sqrt(2.0))  # 0.6745: the median of |x| for a standard normal x
    return 1.2533 * sigma / sqrt(window)  # sqrt(pi / 2): a median's error over a mean's
