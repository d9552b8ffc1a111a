"""When errors of several images fall, rise, or cannot be told apart."""

from __future__ import annotations

import math

import pytest

from rendergraph.conformance.quality_axes import knob_values
from rendergraph.conformance.trend import shape_over


@pytest.mark.parametrize(
    ("samples", "shape"),
    [
        # Falls in every image, by 1 of 10, whatever else differs between them.
        ([[10, 9, 8], [20, 19, 18], [31, 30, 29]], "falls"),
        ([[8, 9, 10], [18, 19, 20], [29, 30, 31]], "rises"),
        # 0.5 % of 30 is 0.15: less is nothing.
        ([[30.0, 29.95, 29.9], [30.0, 29.95, 29.9]], "flat"),
        # Rises by 2 of 10 in the last step of every image.
        ([[10, 2, 4], [10, 2, 4.1], [10, 2, 3.9]], "bumpy"),
        # The same mean rise, but from one image: -1, -1, +8 have mean 2 and standard error 3.
        ([[10, 2, 1], [10, 2, 1], [10, 2, 10]], "flat"),
        ([[10, 2, 1], [10, 2, 1], [10, 2, 1.5]], "falls"),
        ([[math.nan, 1], [2, 1]], "unknown"),
    ],
)
def test_shape(samples: list[list[float]], shape: str) -> None:
    assert shape_over(samples) == shape


@pytest.mark.parametrize(
    ("entry", "values"),
    [
        ({"accurate": "up", "type": "integer", "minimum": 1, "maximum": 32, "default": 12}, ("1", "12", "32")),
        ({"accurate": "down", "type": "integer", "minimum": 1, "maximum": 16, "default": 1}, ("16", "4", "1")),
        ({"accurate": "up", "type": "integer", "minimum": 1, "maximum": 4, "default": 4}, ("1", "2", "4")),
        ({"accurate": "down", "type": "number", "exclusiveMinimum": 0, "maximum": 1}, ("1", "0.5", "0.001")),
        ({"accurate": ["a", "b"]}, ("a", "b")),
        ({"accurate": [False, True]}, ("false", "true")),
        ({"accurate": "up", "type": "integer", "minimum": 1}, ()),
        ({"indifferent": True, "type": "number", "minimum": 0, "maximum": 1}, ()),
    ],
)
def test_values_of_a_knob(entry: dict[str, object], values: tuple[str, ...]) -> None:
    assert knob_values(entry) == values
