"""Whether the error falls along each quality axis, as its node says it does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from statistics import fmean
from typing import Final, Literal

from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.errors import PointError
from rendergraph.measure.sweep.points import Point

Shape = Literal["falls", "flat", "rises", "bumpy", "unknown"]

#: What a step may rise, and the whole must fall, as a share of the largest error: less is rounding and noise.
SLACK: Final = 0.005
#: And of standard errors, where the graph is random.
SIGMAS: Final = 3.0


@dataclass(frozen=True, slots=True)
class Trend:
    """The error at each value of an axis, cheap first (None: not known), and its ``shape``: it ``falls`` all along,
    stays ``flat``, ``rises`` from the first to the last, is ``bumpy`` (falls in the end, but rises on the way), or
    cannot be told. ``method``: ``slice`` at the other axes' values ``at``, or ``mean`` over all settings of each value.
    """

    axis: Axis
    errors: tuple[float | None, ...]
    shape: Shape
    method: Literal["slice", "mean"]
    at: tuple[str, ...] = ()


def trends(
    axes: Sequence[Axis],
    points: Sequence[Point],
    errors: Mapping[int, PointError],
    held: Sequence[int],
) -> tuple[Trend, ...]:
    """One trend for each quality axis with two values or more. ``errors`` are by point, ``held`` the value of each axis
    (by index) that it is held at while another varies.
    """
    by_choice = {point.choice: errors.get(point.index) for point in points}
    found = []
    for at, axis in enumerate(axes):
        if not axis.quality or len(axis.values) < 2:
            continue
        line = [by_choice.get((*held[:at], value, *held[at + 1 :])) for value in range(len(axis.values))]
        whole = len(by_choice) > 0 and all(
            (*held[:at], value, *held[at + 1 :]) in by_choice for value in range(len(axis.values))
        )
        if whole:
            others = tuple(f"{a.name}={a.values[k]}" for a, k in zip(axes, held, strict=True) if a is not axis)
            values = tuple(error.value if error is not None else None for error in line)
            noise = max((error.standard_error for error in line if error is not None), default=0.0)
            found.append(Trend(axis, values, shape_of(values, SIGMAS * noise), "slice", others))
        else:
            values = tuple(_mean_at(points, errors, at, value) for value in range(len(axis.values)))
            found.append(Trend(axis, values, shape_of(values), "mean"))
    return tuple(found)


def shape_of(errors: Sequence[float | None], noise: float = 0.0) -> Shape:
    """The shape of errors along an axis, cheap first, that are each uncertain by ``noise``."""
    known = [error for error in errors if error is not None]
    if len(known) < len(errors) or not all(isfinite(error) for error in known):
        return "unknown"
    slack = max(SLACK * max(known), noise)
    if max(known) - min(known) <= slack:
        return "flat"
    if known[-1] >= known[0] - slack:
        return "rises" if known[-1] > known[0] + slack else "bumpy"
    return "bumpy" if any(b - a > slack for a, b in pairwise(known)) else "falls"


def _mean_at(points: Sequence[Point], errors: Mapping[int, PointError], at: int, value: int) -> float | None:
    found = [errors[p.index].value for p in points if p.choice[at] == value and p.index in errors]
    known = [error for error in found if error is not None]
    return fmean(known) if known else None
