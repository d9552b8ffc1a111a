"""Demand `knobs`: the error falls as quality rises, along each knob and axis that the node says trades accuracy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.axes import parse_axes
from rendergraph.measure.sweep.errors import judged_error
from rendergraph.measure.sweep.trend import SIGMAS, Shape, shape_of
from rendergraph.measure.truth.judgement import Judgement

_BOUNDS: Final = ("minimum", "exclusiveMinimum"), ("maximum", "exclusiveMaximum")


@dataclass(frozen=True, slots=True)
class QualityAxis:
    """What is swept, and its values from cheap to accurate, as ``--set`` takes them (paths without ``=VALUE``)."""

    name: str
    paths: tuple[str, ...]
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Line:
    """One measure of one pass along an axis: its errors as the metric gives them, and their shape."""

    pass_name: str
    measure: str
    metric: str
    ideal: bool
    values: tuple[float | None, ...]
    shape: Shape


def check_knobs(subject: Subject) -> Iterator[Shortfall | Note]:
    """Three values of each quality knob, and the axes of ``accuracy_axes``; on the node's own graph."""
    axes = list(quality_axes(subject))
    if not axes and subject.node.exact:
        yield Note("the node is exact: there is no error to trade")
    elif not axes:
        text = (
            "no knob says accurate=..., and there is no axis in accuracy_axes: say how accuracy is bought, or exempt it"
        )
        yield Shortfall("no_knob", text)
    for axis in axes:
        try:
            lines = swept(subject, axis)
        except RenderGraphError as error:
            yield Shortfall("refused", f"{axis.name}: {'; '.join(d.text for d in error.diagnostics)}")
            continue
        yield from _judge(axis, lines)


def _judge(axis: QualityAxis, lines: Sequence[Line]) -> Iterator[Shortfall | Note]:
    for line in lines:
        if line.ideal and line.shape in ("rises", "bumpy"):
            yield Shortfall(line.shape, f"{axis.name}: {_told(axis, line)} does not fall all along")
    falling = [line for line in lines if line.shape == "falls"]
    if any(line.ideal and line.shape in ("rises", "bumpy") for line in lines):
        return
    if not falling and lines and all(line.shape in ("flat", "unknown") for line in lines):
        shown = "; ".join(_told(axis, line) for line in lines)
        yield Shortfall("flat", f"{axis.name} changes no error: {shown}")
    elif not falling:
        yield Shortfall("no_error", f"{axis.name}: no measure is judged along it")
    for line in falling:
        yield Note(f"{axis.name}: {_told(axis, line)}")


def _told(axis: QualityAxis, line: Line) -> str:
    shown = ", ".join(
        f"{k}: {'none' if v is None else format(v, '.4g')}" for k, v in zip(axis.values, line.values, strict=True)
    )
    return f"{line.pass_name}.{line.measure} {line.metric} ({shown})"


def quality_axes(subject: Subject) -> Iterator[QualityAxis]:
    """The quality knobs of the node's ``Params``, and what else it says trades accuracy in its own graph."""
    properties: dict[str, Any] = subject.node.params_type.model_json_schema().get("properties", {})
    for name, entry in properties.items():
        values = knob_values(entry)
        if values:
            paths = tuple(f"passes.{passed}.set.{name}" for passed in subject.passes)
            yield QualityAxis(name, paths, values)
    for axis in parse_axes(subject.document, subject.node.accuracy_axes) if subject.node.accuracy_axes else ():
        yield QualityAxis(axis.name, (axis.path,), axis.values)


def knob_values(entry: dict[str, Any]) -> tuple[str, ...]:
    """A knob's choices, or three numbers from the cheap end of its range to the accurate one: over its default, or
    where that is an end, over the middle (of the ratios, where the range spans more than ten of them).
    """
    accurate = entry.get("accurate")
    if isinstance(accurate, list):
        return tuple(str(value).lower() if isinstance(value, bool) else str(value) for value in accurate)
    ends = [next((float(entry[key]) for key in keys if key in entry), None) for keys in _BOUNDS]
    if accurate not in ("up", "down") or ends[0] is None or ends[1] is None:
        return ()
    low, high, default = ends[0], ends[1], entry.get("default")
    inside = default is not None and low < default < high
    middle = default if inside else (low * high) ** 0.5 if low > 0 and high > 4 * low else (low + high) / 2
    # Bounds that are left out are come near to.
    gap = (high - low) * 1e-3
    low += gap * ("exclusiveMinimum" in entry)
    high -= gap * ("exclusiveMaximum" in entry)
    whole = entry.get("type") == "integer"
    texts = [str(round(number)) if whole else f"{number:.6g}" for number in (low, middle, high)]
    return tuple(dict.fromkeys(texts if accurate == "up" else reversed(texts)))


def swept(subject: Subject, axis: QualityAxis) -> tuple[Line, ...]:
    """The node's measures along an axis. Raises RenderGraphError where the graph refuses a value."""
    found: dict[tuple[str, str], list[Judgement]] = {}
    for value in axis.values:
        document = subject.at_size(*(f"{path}={value}" for path in axis.paths))
        for entry in subject.judge(document):
            for judged in entry.judgements:
                found.setdefault((entry.name, judged.measure), []).append(judged)
    whole = {key: judged for key, judged in found.items() if len(judged) == len(axis.values)}
    return tuple(_line(judged) for judged in whole.values())


def _line(judged: Sequence[Judgement]) -> Line:
    first = judged[0]
    errors = [judged_error(one).value for one in judged]
    noise = max(SIGMAS * one.standard_error / 3.0 for one in judged)
    known = [None if one.verdict == "cannot_judge" else one.value for one in judged]
    return Line(first.pass_name, first.measure, first.metric, first.ideal, tuple(known), shape_of(errors, noise))
