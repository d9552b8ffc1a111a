"""Demand `knobs`: the error falls as quality rises, along each knob and axis that the node says trades accuracy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.quality_axes import QualityAxis, quality_axes
from rendergraph.conformance.subject import Subject
from rendergraph.conformance.trend import shape_over
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.errors import judged_error
from rendergraph.measure.sweep.trend import Shape, shape_of
from rendergraph.measure.truth.judgement import Judgement

Size = tuple[int, int]

#: Larger than for other demands: with a quarter as many texels, which of them fall on an outline decides a trend.
SIZE: Final = (160, 90)
#: Where one image does not show it, these are asked too: each size samples the scene elsewhere.
MORE_SIZES: Final = ((128, 72), (144, 80), (176, 100), (192, 108))


@dataclass(frozen=True, slots=True)
class Line:
    """One measure of one pass along an axis: what its metric gives at each value (None: cannot be judged), the same as
    errors that fall, and their shape.
    """

    pass_name: str
    measure: str
    metric: str
    unit: str
    ideal: bool
    values: tuple[float | None, ...]
    errors: tuple[float | None, ...]
    shape: Shape


def check_knobs(subject: Subject) -> Iterator[Shortfall | Note]:
    """Three values of each quality knob, and the axes of ``accuracy_axes``; on the node's own graph."""
    axes = list(quality_axes(subject))
    if not axes and subject.node.exact:
        yield Note("the node is exact: there is no error to trade")
    elif not axes:
        text = "no knob is marked accurate=..., nor is there an axis in accuracy_axes: say how accuracy is bought"
        yield Shortfall("no_knob", text)
    for axis in axes:
        try:
            yield from _judge(axis, settled(subject, axis))
        except RenderGraphError as error:
            yield Shortfall("refused", f"{axis.name}: {'; '.join(d.text for d in error.diagnostics)}")


def _judge(axis: QualityAxis, lines: Sequence[Line]) -> Iterator[Shortfall | Note]:
    wrong = [line for line in lines if line.shape in ("rises", "bumpy")]
    falling = [line for line in lines if line.shape == "falls"]
    for line in wrong:
        yield Shortfall(line.shape, f"{axis.name}: {told(axis, line)} does not fall all along")
    if not falling and not wrong:
        shown = "; ".join(told(axis, line) for line in lines if line.shape != "unknown")
        if shown:
            yield Shortfall("flat", f"{axis.name} changes no error: {shown}")
        else:
            yield Shortfall("no_error", f"{axis.name}: no measure is judged along it")
    for line in falling:
        yield Note(f"{axis.name}: {told(axis, line)}")


def told(axis: QualityAxis, line: Line) -> str:
    """A line's values in words."""
    shown = zip(axis.values, line.values, strict=True)
    return f"{line.pass_name}.{line.measure} {line.metric} (" + ", ".join(
        f"{value}: {'none' if error is None else format(error, '.4g')}" for value, error in shown
    ) + ")"  # fmt: skip


def settled(subject: Subject, axis: QualityAxis) -> tuple[Line, ...]:
    """The lines that count: of one image, or where that shows no fall, of the mean over several sizes of it.

    :raises RenderGraphError: where the graph refuses a value.
    """
    first = counting(axis, swept(subject, axis))
    if not any(line.shape in ("rises", "bumpy") for line in first):
        return first
    rounds = [first, *map(partial(_counted, subject, axis), MORE_SIZES)]
    settled = []
    for line in first:
        same = [
            next((o for o in r if (o.pass_name, o.measure) == (line.pass_name, line.measure)), None) for r in rounds
        ]
        known = [other for other in same if other is not None and None not in other.errors]
        samples = [[error for error in other.errors if error is not None] for other in known]
        settled.append(line if len(samples) < len(rounds) else _averaged(line, known, samples))
    return tuple(settled)


def _counted(subject: Subject, axis: QualityAxis, size: Size) -> tuple[Line, ...]:
    return counting(axis, swept(subject, axis, size))


def _averaged(line: Line, known: Sequence[Line], samples: Sequence[Sequence[float]]) -> Line:
    def mean(rows: Sequence[Sequence[float | None]]) -> tuple[float | None, ...]:
        return tuple(sum(v or 0.0 for v in column) / len(rows) for column in zip(*rows, strict=True))

    values = mean([other.values for other in known])
    return Line(
        line.pass_name, line.measure, line.metric, line.unit, line.ideal, values, mean(samples), shape_over(samples)
    )  # fmt: skip


def counting(axis: QualityAxis, lines: Sequence[Line]) -> tuple[Line, ...]:
    """The lines of the axis's measure; without one the ideal ones, or all where none is ideal."""
    if axis.measure:
        return tuple(line for line in lines if line.measure == axis.measure)
    return tuple(line for line in lines if line.ideal) or tuple(lines)


def swept(subject: Subject, axis: QualityAxis, size: Size = SIZE) -> tuple[Line, ...]:
    """All of the node's measures along an axis. Raises RenderGraphError where the graph refuses a value."""
    found: dict[tuple[str, str], list[Judgement]] = {}
    for value in axis.values:
        document = subject.with_overrides(*(f"{path}={value}" for path in axis.paths))
        for entry in subject.judge(document, size):
            for judged in entry.judgements:
                found.setdefault((entry.name, judged.measure), []).append(judged)
    whole = [judged for judged in found.values() if len(judged) == len(axis.values)]
    return tuple(_line(judged) for judged in whole)


def _line(judged: Sequence[Judgement]) -> Line:
    first = judged[0]
    errors = tuple(judged_error(one).value for one in judged)
    values = tuple(None if one.verdict == "cannot_judge" else one.value for one in judged)
    noise = max(one.standard_error for one in judged)  # the truths' own, at three sigma
    return Line(
        first.pass_name, first.measure, first.metric, first.unit, first.ideal, values, errors, shape_of(errors, noise)
    )  # fmt: skip
