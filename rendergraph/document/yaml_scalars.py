"""What an unquoted YAML scalar means: the YAML 1.2 core schema (section 10.3.2), instead of PyYAML's YAML 1.1.

The difference bites in practice: PyYAML reads ``1e-3`` as text, ``on`` and ``no`` as booleans, ``12:30`` as 750,
``010`` as 8 and ``2024-01-01`` as a date.
"""

from __future__ import annotations

import math
import re
from typing import Final

Scalar = str | int | float | bool | None

#: Words that YAML 1.1 reads as booleans and YAML 1.2 as text, with the boolean that was probably meant.
YAML_1_1_BOOLEANS: Final[dict[str, str]] = {
    spelling: meaning
    for word, meaning in (("yes", "true"), ("on", "true"), ("no", "false"), ("off", "false"))
    for spelling in (word, word.capitalize(), word.upper())
}

_CONSTANTS: Final[dict[str, Scalar]] = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False,
    ".nan": math.nan, ".NaN": math.nan, ".NAN": math.nan,
}  # fmt: skip
_INFINITY = re.compile(r"([-+]?)\.(?:inf|Inf|INF)\Z")
_INTEGER = re.compile(r"[-+]?[0-9]+\Z")
_BASED = re.compile(r"0o[0-7]+\Z|0x[0-9a-fA-F]+\Z")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?\Z")
_NUMERIC_START = frozenset("+-.0123456789")
_LONGEST_INTEGER = 40  # characters; int() is quadratic in them, and 64 bits need at most 22


class AmbiguousNumberError(ValueError):
    """A scalar that looks like a number but has no single sensible value. ``guess`` is the likeliest."""

    def __init__(self, problem: str, hint: str, guess: int | float) -> None:
        super().__init__(problem)
        self.problem = problem
        self.hint = hint
        self.guess = guess


def resolve(text: str) -> Scalar:
    """The value of an unquoted scalar. Raises ``AmbiguousNumberError`` for ``010`` and for numbers beyond 64 bits."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if text[0] not in _NUMERIC_START:
        return text
    if _INTEGER.match(text):
        digits = text.lstrip("+-")
        if len(digits) > 1 and digits[0] == "0":
            plain = (digits.lstrip("0") or "0")[:_LONGEST_INTEGER]
            octal = "" if set(plain) & {"8", "9"} else f", 0o{plain} for the octal one"
            hint = f"write {plain} for the decimal number{octal}, or quote it for text"
            raise AmbiguousNumberError("YAML versions differ on leading zeros", hint, _integer(plain, 10))
        return _integer(text, 10)
    if _BASED.match(text):
        return _integer(text[2:], 8 if text[1] == "o" else 16)
    if _FLOAT.match(text):
        value = float(text)
        if math.isinf(value):
            raise AmbiguousNumberError("too large for a 64-bit float", "write a number below 1.8e308", 0.0)
        return value
    if sign := _INFINITY.match(text):
        return -math.inf if sign[1] == "-" else math.inf
    return text


def _integer(digits: str, base: int) -> int:
    value = int(digits, base) if len(digits) <= _LONGEST_INTEGER else 2**64
    if not -(2**63) <= value < 2**63:
        raise AmbiguousNumberError("too large for a 64-bit integer", "write a smaller number, or quote it for text", 0)
    return value
