"""The settings a sweep measures: every combination of its axes' values, or a Latin hypercube of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from random import Random
from typing import Final

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.sweep.axes import Axis

#: Combinations above this are refused: nobody waits for them, and a hypercube shows as much.
MOST_POINTS: Final = 2000


@dataclass(frozen=True, slots=True)
class Point:
    """One setting: the index of each axis's value."""

    index: int
    choice: tuple[int, ...]

    def overrides(self, axes: Sequence[Axis]) -> tuple[str, ...]:
        """As ``--set`` takes them."""
        return tuple(f"{axis.path}={axis.values[at]}" for axis, at in zip(axes, self.choice, strict=True))


def all_points(axes: Sequence[Axis]) -> tuple[Point, ...]:
    """Every combination, the last axis fastest.

    :raises RenderGraphError: RG753 above :data:`MOST_POINTS`, with the count and what to do; exit code 2.
    """
    count = prod(len(axis.values) for axis in axes)
    if count > MOST_POINTS:
        sizes = " x ".join(str(len(axis.values)) for axis in axes)
        raise RenderGraphError([diagnose("RG753", count=count, sizes=sizes, most=MOST_POINTS)], exit_code=2)
    choices = product(*(range(len(axis.values)) for axis in axes))
    return tuple(Point(index, choice) for index, choice in enumerate(choices))


def hypercube(axes: Sequence[Axis], count: int, seed: int = 0) -> tuple[Point, ...]:
    """``count`` settings of which each axis sees its values equally often, as far as ``count`` divides: a Latin
    hypercube (McKay, Beckman, Conover 1979) over the axes' values. Settings that coincide are measured once.

    :raises RenderGraphError: RG753 above :data:`MOST_POINTS`.
    """
    if count > MOST_POINTS:
        raise RenderGraphError(
            [diagnose("RG753", count=count, sizes=f"{count} samples", most=MOST_POINTS)], exit_code=2
        )
    random = Random(seed)
    columns = []
    for axis in axes:
        strata = [sample * len(axis.values) // count for sample in range(count)]
        random.shuffle(strata)
        columns.append(strata)
    distinct = dict.fromkeys(zip(*columns, strict=True))
    return tuple(Point(index, choice) for index, choice in enumerate(distinct))
