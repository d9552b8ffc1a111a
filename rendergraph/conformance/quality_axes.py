"""What a node says trades accuracy: its quality knobs, and axes of its own graph, with the values to try."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from rendergraph.conformance.subject import Subject
from rendergraph.measure.sweep.axes import parse_axes

_BOUNDS: Final = ("minimum", "exclusiveMinimum"), ("maximum", "exclusiveMaximum")


@dataclass(frozen=True, slots=True)
class QualityAxis:
    """What is swept: the paths that ``--set`` takes, and their values from cheap to accurate. ``measure`` is the one
    whose error falls along it; empty for the ideal ones of the node's reference.
    """

    name: str
    paths: tuple[str, ...]
    values: tuple[str, ...]
    measure: str = ""


def quality_axes(subject: Subject) -> Iterator[QualityAxis]:
    """The quality knobs of the node's ``Params``, then its ``accuracy_axes``.

    :raises RenderGraphError: RG750 to RG752 for an axis that is none.
    """
    properties: dict[str, Any] = subject.node.params_type.model_json_schema().get("properties", {})
    for name, entry in properties.items():
        values = knob_values(entry)
        if values:
            paths = tuple(f"passes.{passed}.set.{name}" for passed in subject.passes)
            yield QualityAxis(name, paths, values)
    for text, measure in subject.node.accuracy_axes.items():
        for axis in parse_axes(subject.document, [text]):
            yield QualityAxis(axis.name, (axis.path,), axis.values, measure)


def knob_values(entry: dict[str, Any]) -> tuple[str, ...]:
    """A knob's choices, or three numbers from the cheap end of its range to the accurate one: over its default, or
    where that is an end, over the middle (of the ratios, where the range spans more than ten of them).
    """
    accurate = entry.get("accurate")
    if isinstance(accurate, list):
        return tuple(str(value).lower() if isinstance(value, bool) else str(value) for value in accurate)
    low, high = (next((float(entry[key]) for key in keys if key in entry), None) for keys in _BOUNDS)
    if accurate not in ("up", "down") or low is None or high is None:
        return ()
    default = entry.get("default")
    if isinstance(default, int | float) and low < default < high:
        middle = float(default)
    else:
        middle = math.sqrt(low * high) if low > 0 and high > 10 * low else (low + high) / 2
    # Bounds that are left out are come near to.
    gap = (high - low) * 1e-3
    low += gap * ("exclusiveMinimum" in entry)
    high -= gap * ("exclusiveMaximum" in entry)
    whole = entry.get("type") == "integer"
    texts = [str(round(number)) if whole else f"{number:.6g}" for number in (low, middle, high)]
    return tuple(dict.fromkeys(texts if accurate == "up" else reversed(texts)))
