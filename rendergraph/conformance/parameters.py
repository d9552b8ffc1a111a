"""Demand `parameters`: each is documented, has its range, and says whether it trades accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from rendergraph.conformance.demand import Shortfall
from rendergraph.conformance.subject import Subject
from rendergraph.node.params import NEITHER

_LOWER: Final = ("minimum", "exclusiveMinimum")
_UPPER: Final = ("maximum", "exclusiveMaximum")


def check_parameters(subject: Subject) -> Iterator[Shortfall]:
    """Help, unit, range and ``accurate`` of every field of the node's ``Params``."""
    properties: dict[str, Any] = subject.node.params_type.model_json_schema().get("properties", {})
    for name, entry in properties.items():
        if len(str(entry.get("description", "")).split()) < 2:
            yield Shortfall("undocumented", f"`{name}` has no help")
        if "unit" not in entry:
            yield Shortfall("no_unit", f'`{name}` has no unit: declare it with knob(), unit="" for pure numbers')
        if not is_number(entry):
            continue
        if not any(key in entry for key in (*_LOWER, *_UPPER)):
            yield Shortfall("no_range", f"`{name}` is a number of any size: give it ge, le, gt or lt")
        if not entry.get("accurate") and not entry.get("indifferent"):
            text = f'`{name}` does not say which way it is accurate: accurate="up", "down" or "{NEITHER}"'
            yield Shortfall("accuracy_untold", text)
        elif entry.get("accurate") in ("up", "down") and not (
            any(key in entry for key in _LOWER) and any(key in entry for key in _UPPER)
        ):
            yield Shortfall("no_range", f"`{name}` is a quality knob, which is swept over its range: give it both ends")


def is_number(entry: dict[str, Any]) -> bool:
    """Whether a parameter's JSON schema is that of one number (or none)."""
    kinds = {option.get("type") for option in entry.get("anyOf", [entry])} - {"null"}
    return bool(kinds) and kinds <= {"integer", "number"}
