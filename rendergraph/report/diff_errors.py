"""Errors of two accuracy records, measure by measure: deterministic, so compared exactly, above a floor of rounding."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isnan
from typing import Final

from rendergraph.measure.metrics.table import LARGER_IS_BETTER
from rendergraph.report.diff_exact import Direction, ExactChange
from rendergraph.report.diff_names import Matching
from rendergraph.report.record_models import AccuracyRecord, MeasureModel, PassErrorsModel

#: An error counts as changed when it changed by more than both.
RELATIVE_FLOOR: Final = 0.01
ABSOLUTE_FLOOR: Final = 1e-9
_VERDICTS: Final = ("within", "cannot_judge", "above")


def compare_errors(a: AccuracyRecord, b: AccuracyRecord, names: Matching) -> Iterator[ExactChange]:
    """Measures whose error or verdict changed, that are new or gone, and invariants that broke or hold again."""
    old = {names.after_name(entry.name): entry for entry in a.passes}
    new = {entry.name: entry for entry in b.passes}
    for name in new:
        if name in old:
            yield from _compare_pass(name, old[name], new[name])


def _compare_pass(name: str, a: PassErrorsModel, b: PassErrorsModel) -> Iterator[ExactChange]:
    old, new = ({m.name: m for m in entry.measures} for entry in (a, b))
    for measure in sorted(old.keys() | new.keys()):
        subject = f"{name}.{measure}"
        before, after = old.get(measure), new.get(measure)
        if before is None or after is None:
            said, now = ("is not judged any more", None) if after is None else ("is judged now", after.value)
            was = before.value if before is not None else None
            # What is judged no more can get worse unseen.
            direction = Direction.WORSE if after is None else Direction.CHANGED
            yield ExactChange("error", subject, direction, was, now, f"pass {name}: {measure} {said}")
        else:
            yield from _compare_measure(name, before, after)
    if a.broken != b.broken:
        direction = _direction(len(a.broken), len(b.broken))
        text = f"pass {name} breaks {len(b.broken)} invariants, before {len(a.broken)}"
        yield ExactChange("error", name, direction, len(a.broken), len(b.broken), text)


def _compare_measure(name: str, a: MeasureModel, b: MeasureModel) -> Iterator[ExactChange]:
    subject = f"{name}.{b.name}"
    what = f"error of pass {name}, {b.name} ({b.metric})"
    if a.metric != b.metric:
        text = f"pass {name}: {b.name} is judged by {b.metric} now, before by {a.metric}"
        yield ExactChange("error", subject, Direction.CHANGED, a.metric, b.metric, text)
        return
    if a.verdict != b.verdict:
        direction = _direction(_VERDICTS.index(a.verdict), _VERDICTS.index(b.verdict))
        text = (
            f"{what} is {_words(b.verdict)} its tolerance {b.tolerance:g}, before {_words(a.verdict)} {a.tolerance:g}"
        )
        yield ExactChange("error", subject, direction, a.verdict, b.verdict, f"{text}: {_shown(a)} -> {_shown(b)}")
        return
    before, after = (_badness(measure) for measure in (a, b))
    if a.z_test is None and _changed(before, after):
        share = f" ({100 * (after - before) / abs(before):+.1f} %)" if before and abs(before) + abs(after) < inf else ""
        direction = _direction(before, after)
        yield ExactChange("error", subject, direction, a.value, b.value, f"{what}: {_shown(a)} -> {_shown(b)}{share}")
    elif a.tolerance != b.tolerance:
        text = f"tolerance of pass {name}, {b.name}: {a.tolerance:g} -> {b.tolerance:g}"
        yield ExactChange("error", subject, Direction.CHANGED, a.tolerance, b.tolerance, text)


def _changed(before: float, after: float) -> bool:
    if before == after or inf in (abs(before), abs(after)):
        return before != after
    return abs(after - before) > max(ABSOLUTE_FLOOR, RELATIVE_FLOOR * abs(before))


def _badness(measure: MeasureModel) -> float:
    """The error as a number that grows as things get worse: NaN is the worst, the PSNR of equal images the best."""
    sign = -1.0 if measure.metric in LARGER_IS_BETTER else 1.0
    if measure.value is None:
        return sign * inf
    value = sign * float(measure.value)
    return inf if isnan(value) else value


def _direction(before: float, after: float) -> Direction:
    if before == after:
        return Direction.CHANGED
    return Direction.WORSE if after > before else Direction.BETTER


def _words(verdict: str) -> str:
    return {"within": "within", "above": "above", "cannot_judge": "not to be judged by"}[verdict]


def _shown(measure: MeasureModel) -> str:
    return f"{measure.value:.6g}" if isinstance(measure.value, float) else str(measure.value)
