"""How many samples are worth one independent sample: frames of one run resemble their neighbours.

Ignoring it is the commonest cause of false alarms: 200 frames that drift together carry the evidence of ten.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from rendergraph.measure.rank_tests import Floats, average_ranks


def autocorrelation_time(sequences: Sequence[Floats]) -> float:
    """The integrated autocorrelation time of 1-d sequences in order of time, >= 1; infinite when nothing can be said.

    Of ranks, so that one stutter does not hide the drift, and pooled over the sequences (each about its own middle).
    The larger of two estimates: Geyer's initial monotone sequence, and that of a first-order autoregression with the
    small-sample bias of its coefficient taken back (Kendall 1954; Marriott and Pope 1954).

    Source: Geyer, "Practical Markov chain Monte Carlo", 1992, section 3.3.
    """
    used = [sequence for sequence in sequences if len(sequence) > 3 and np.ptp(sequence) > 0]
    if not used:
        return 1.0
    lags = max(2, min(len(sequence) for sequence in used) // 2)
    total = sum(len(sequence) for sequence in used)
    covariance = sum((_autocovariance(average_ranks(sequence), lags) for sequence in used), np.zeros(lags))
    correlation = covariance / covariance[0]
    pairs = correlation[: lags - lags % 2].reshape(-1, 2).sum(axis=1)
    pairs = np.minimum.accumulate(pairs)
    stop = int(np.argmax(pairs <= 0)) if (pairs <= 0).any() else len(pairs)
    geyer = 2.0 * float(pairs[:stop].sum()) - 1.0
    per_sequence = total / len(used)
    coefficient = (float(correlation[1]) + 1 / per_sequence) / (1 - 3 / per_sequence)
    autoregressive = (1 + coefficient) / (1 - coefficient) if coefficient < 1 else inf
    return max(1.0, geyer, autoregressive)


def _autocovariance(values: Floats, lags: int) -> Floats:
    """Sums of products at lags 0 .. ``lags`` - 1, each scaled to the sequence's full length."""
    centred = values - values.mean()
    length = len(centred)
    padded = np.fft.rfft(centred, 2 * length)
    sums = np.fft.irfft(padded * padded.conj(), 2 * length)[:lags]
    return np.asarray(sums / (length - np.arange(lags)) * length, dtype=np.float64)
