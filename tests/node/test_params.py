"""Knobs: what one declaration puts into the model and its JSON Schema, and what parameters refuse."""

from __future__ import annotations

import math
from typing import Any, Literal

import pytest
from pydantic import ValidationError

from rendergraph.node.params import GraphFile, Params, knob


class Example(Params):
    """One knob of each sort."""

    radius: float = knob(0.5, "How far.", unit="m", gt=0.0, le=2.0)
    taps: int = knob(4, "How many.", unit="texel", ge=1, lt=10, accurate="up")
    error: float = knob(0.1, "How wrong.", accurate="down")
    filter: Literal["box", "tent"] = knob("box", "Which.", accurate=("box", "tent"))
    shader: GraphFile = knob("a.frag", "A file of the graph's folder.")


def schema(name: str) -> dict[str, Any]:
    found: dict[str, Any] = Example.model_json_schema()["properties"][name]
    return found


def test_default_help_unit_and_range_are_in_the_schema() -> None:
    radius, taps = schema("radius"), schema("taps")
    assert (radius["default"], radius["description"], radius["unit"]) == (0.5, "How far.", "m")
    assert (radius["exclusiveMinimum"], radius["maximum"]) == (0.0, 2.0)
    assert (taps["minimum"], taps["exclusiveMaximum"], taps["unit"]) == (1, 10, "texel")


def test_quality_knobs_say_which_way_is_accurate() -> None:
    assert [schema(name).get("accurate") for name in ("taps", "error", "filter", "radius")] == [
        "up", "down", ["box", "tent"], None,
    ]  # fmt: skip


def test_a_pure_number_has_no_unit_and_a_file_is_marked() -> None:
    assert schema("error")["unit"] == ""
    assert schema("shader")["rg_file"] is True
    assert "rg_file" not in schema("filter")


@pytest.mark.parametrize(
    "values",
    [
        {"radius": 0.0}, {"radius": 2.1}, {"radius": math.nan}, {"radius": math.inf}, {"taps": 0}, {"taps": 10},
        {"filter": "disc"}, {"raduis": 1.0},
    ],
)  # fmt: skip
def test_what_is_out_of_range_or_unknown_is_refused(values: dict[str, Any]) -> None:
    with pytest.raises(ValidationError) as caught:
        Example(**values)
    assert [error["loc"] for error in caught.value.errors()] == [tuple(values)]


def test_the_ends_of_the_ranges_are_taken_and_values_are_frozen() -> None:
    found = Example(radius=2.0, taps=1)
    assert (found.radius, found.taps, found.filter) == (2.0, 1, "box")
    with pytest.raises(ValidationError):
        found.taps = 2
