"""The YAML 1.2 core schema, number by number."""

from __future__ import annotations

import math

import pytest

from rendergraph.document.yaml_scalars import AmbiguousNumberError, resolve


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("", None), ("~", None), ("null", None), ("NULL", None), ("nUll", "nUll"),
        ("true", True), ("False", False), ("tRue", "tRue"),
        ("yes", "yes"), ("no", "no"), ("on", "on"), ("OFF", "OFF"), ("y", "y"),
        ("0", 0), ("12", 12), ("-7", -7), ("+3", 3), ("0o10", 8), ("0x1F", 31), ("0b11", "0b11"), ("1_000", "1_000"),
        ("9223372036854775807", 2**63 - 1), ("-9223372036854775808", -(2**63)),
        ("1e-3", 1e-3), ("1E5", 1e5), (".5", 0.5), ("5.", 5.0), ("-1.5e+2", -150.0), ("0.0", 0.0), ("1e-400", 0.0),
        (".inf", math.inf), ("-.INF", -math.inf), ("inf", "inf"), ("nan", "nan"),
        ("12:30", "12:30"), ("2024-01-01", "2024-01-01"), ("1.2.3", "1.2.3"), ("-", "-"), (".", "."), ("+", "+"),
        ("-x", "-x"), ("1e", "1e"), ("0x", "0x"), ("0o9", "0o9"), ("--1", "--1"), ("٣", "٣"),
    ],
)  # fmt: skip
def test_core_schema(text: str, value: object) -> None:
    found = resolve(text)
    assert found == value
    assert type(found) is type(value)


def test_not_a_number() -> None:
    found = resolve(".nan")
    assert isinstance(found, float)
    assert math.isnan(found)


@pytest.mark.parametrize(
    ("text", "guess"),
    [
        ("010", 10),
        ("-08", 8),
        ("00", 0),
        ("9223372036854775808", 0),
        ("9" * 5000, 0),
        ("0x" + "f" * 17, 0),
        ("1e400", 0.0),
    ],
)
def test_numbers_without_one_meaning(text: str, guess: float) -> None:
    with pytest.raises(AmbiguousNumberError) as error:
        resolve(text)
    assert error.value.guess == guess
