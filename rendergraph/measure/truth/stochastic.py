"""Judges a random pass by many frames of it: the mean over frames against the truth, by a z-test a texel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rendergraph.measure.truth.fingerprint import fingerprint
from rendergraph.measure.truth.judge import broken, judge_scored, recall_truths
from rendergraph.measure.truth.judgement import F64, Judgement, Verdict
from rendergraph.measure.truth.score import SIGMAS, lay_out, score
from rendergraph.measure.truth.ztest import Moments, standard_error, z_test
from rendergraph.node.contract import Node
from rendergraph.node.reference import Measure, PassRun, Reference, Truth

if TYPE_CHECKING:
    from rendergraph.measure.truth.cache import TruthCache

#: Frames that a random pass is judged by.
FRAMES: Final = 16


@dataclass(slots=True)
class _Sums:
    """What is gathered of one measure, frame by frame."""

    judged: Moments = field(default_factory=Moments)
    truth: Moments = field(default_factory=Moments)
    deviation: Moments = field(default_factory=Moments)
    known: Any = None
    error: F64 | float = 0.0
    tolerance: float | None = None


def judge_frames(
    name: str, node: type[Node[Any]], runs: Iterable[PassRun], cache: TruthCache | None = None, *, flip: bool = True
) -> tuple[Judgement, ...]:
    """As :func:`~rendergraph.measure.truth.judge.judge_pass`, of a stochastic node's pass in at least two frames.

    The metrics are those of the mean over frames, and a measure's tolerance is the bias that a value may have. Truths
    of frames whose inputs are the same are computed once.

    :raises RenderGraphError: as there.
    """
    reference = node.reference
    assert reference is not None, "a stochastic node has a reference"
    sums = {key: _Sums() for key in reference.measures}
    first: tuple[str, Mapping[str, Truth]] | None = None
    seconds, cached, last = 0.0, True, None
    for run in runs:
        inputs = fingerprint([run.inputs, run.before])
        if first is None or first[0] != inputs or any(truth.judged is not None for truth in first[1].values()):
            kept, hit = recall_truths(name, node, reference, run, cache)
            first, seconds, cached = (inputs, kept.truths), seconds + kept.seconds, cached and hit
        for key, measure in reference.measures.items():
            try:
                _add(sums[key], measure, first[1][key], run)
            except (ValueError, KeyError, TypeError) as error:
                raise broken(name, node, f"measure '{key}': {error}") from error
        last = run
    assert last is not None, "no frame was run"
    return tuple(
        replace(_judge(name, node, reference, key, sums[key], last, flip), seconds=seconds, cached=cached)
        for key in reference.measures
    )


def _add(sums: _Sums, measure: Measure, truth: Truth, run: PassRun) -> None:
    pictures = lay_out(measure, truth, run)
    sums.judged.add(pictures.judged)
    sums.truth.add(pictures.truth)
    sums.deviation.add(pictures.judged - pictures.truth)
    if pictures.mask is not None:
        sums.known = pictures.mask if sums.known is None else sums.known & pictures.mask
    sums.error, sums.tolerance = truth.standard_error, truth.tolerance


def _judge(
    name: str, node: type[Node[Any]], reference: Reference, key: str, sums: _Sums, run: PassRun, flip: bool
) -> Judgement:
    measure = reference.measures[key]
    mean = Truth(sums.truth.mean, sums.judged.mean, sums.known, tolerance=sums.tolerance)
    scored = score(measure, mean, run, flip=flip)
    error = np.broadcast_to(np.asarray(sums.error, np.float64), sums.deviation.mean.shape)
    frames = sums.deviation.count
    test = z_test(
        sums.deviation.mean,
        sums.deviation.variance,
        frames,
        truth_error=error,
        allowance=scored.tolerance,
        mask=sums.known,
    )
    own = float(np.sqrt(np.mean(np.square(error))))
    verdict: Verdict = "within" if test.passed else "above"
    reason = "z_test"
    if scored.verdict == "cannot_judge":
        verdict, reason = scored.verdict, scored.reason
    elif own > max(scored.tolerance / SIGMAS, standard_error(sums.deviation.variance, frames)):
        # A truth noisier than the mean that it judges would accept anything.
        verdict, reason = "cannot_judge", "standard_error"
    elif scored.reason == "not_finite":
        verdict, reason = "above", "not_finite"
    judged = judge_scored(name, node, reference, key, scored)
    pictures = replace(scored.pictures, variance=sums.deviation.variance)
    return replace(
        judged, verdict=verdict, reason=reason, standard_error=SIGMAS * own, z_test=test.score, pictures=pictures
    )
