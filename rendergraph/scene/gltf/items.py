"""Checked access to the file's JSON: every value knows its path, every wrong type or range is a diagnostic."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rendergraph.document.messages import RenderGraphError, diagnose

FLOAT_MAX = 3.4e38  # what float32, and so the GPU, can hold

#: The file cannot be read as glTF at all, as against holding something wrong: exit code 2.
_UNREADABLE = ("RG601", "RG602", "RG603")
_JSON_NAMES = {dict: "an object", list: "an array", bool: "a boolean", type(None): "null"}


def gltf_error(code: str, where: str, **data: Any) -> RenderGraphError:
    """A diagnostic at ``where``: ``file: /json/path``."""
    return RenderGraphError([diagnose(code, where=where, **data)], exit_code=2 if code in _UNREADABLE else 1)


def printable(text: str) -> str:
    """The text without what no terminal or file can show: lone surrogates (legal in JSON) and control characters."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


class Item:
    """One JSON value, and where it is: ``str(item)`` is ``file: path``, as diagnostics name it.

    Every method raises ``RenderGraphError``: RG604 for a wrong type or range, RG605 for a missing member.
    """

    __slots__ = ("_key", "_owner", "file", "value")

    def __init__(self, value: Any, file: str, owner: Item | None = None, key: str | int = "") -> None:
        self.value = value
        self.file = file
        self._owner = owner
        self._key = key

    @property
    def path(self) -> str:
        """The JSON pointer, put together only when something is to be said: files have tens of thousands of values."""
        keys: list[str] = []
        item = self
        while item._owner is not None:
            keys.append(f"/{printable(str(item._key))}")
            item = item._owner
        return "".join(reversed(keys))

    def __str__(self) -> str:
        return f"{self.file}: {self.path or '/'}"

    def wrong(self, expected: str) -> RenderGraphError:
        """The error for a value of another type or range."""
        if isinstance(self.value, str):
            got = f"'{printable(self.value)[:40]}'"
        else:
            got = _JSON_NAMES.get(type(self.value)) or str(self.value)[:40]
        return gltf_error("RG604", str(self), expected=expected, got=got)

    # ---- structure

    def members(self) -> dict[str, Any]:
        """The value as an object."""
        if not isinstance(self.value, dict):
            raise self.wrong("an object")
        return self.value

    def get(self, name: str) -> Item | None:
        """A member, or none when it is absent."""
        members = self.members()
        return Item(members[name], self.file, self, name) if name in members else None

    def require(self, name: str) -> Item:
        """A member that must be there."""
        item = self.get(name)
        if item is None:
            raise gltf_error("RG605", str(self), name=name)
        return item

    def elements(self, name: str) -> list[Item]:
        """The elements of an array member; none when it is absent."""
        item = self.get(name)
        return [] if item is None else list(item)

    def __iter__(self) -> Iterator[Item]:
        if not isinstance(self.value, list):
            raise self.wrong("an array")
        for index, value in enumerate(self.value):
            yield Item(value, self.file, self, index)

    def extension(self, name: str) -> Item | None:
        """An extension object, or none."""
        extensions = self.get("extensions")
        return None if extensions is None else extensions.get(name)

    # ---- the value itself

    def as_text(self) -> str:
        """The value as a string."""
        if not isinstance(self.value, str):
            raise self.wrong("a string")
        return self.value

    def as_integer(self, low: int = 0, high: int = 2**53) -> int:
        """The value as an integer in ``low..high``; 3.0 counts as 3, as in JSON Schema."""
        value = self.value
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or value != int(value)
            or not low <= value <= high
        ):
            raise self.wrong(f"an integer from {low} to {high}" if high < 2**53 else f"an integer not below {low}")
        return int(value)

    def as_number(self, low: float = -FLOAT_MAX, high: float = FLOAT_MAX) -> float:
        """The value as a number in ``low..high``, by default what float32 holds."""
        value = self.value
        if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
            raise self.wrong(
                "a number" + (f" from {low:g} to {high:g}" if (low, high) != (-FLOAT_MAX, FLOAT_MAX) else "")
            )
        return float(value)

    def as_numbers(self, count: int, low: float = -FLOAT_MAX, high: float = FLOAT_MAX) -> tuple[float, ...]:
        """The value as an array of exactly ``count`` numbers."""
        if not isinstance(self.value, list) or len(self.value) != count:
            raise self.wrong(f"an array of {count} numbers")
        return tuple(item.as_number(low, high) for item in self)

    # ---- optional members with a default

    def text(self, name: str, default: str = "") -> str:
        """A string member, cleaned for printing."""
        item = self.get(name)
        return default if item is None else printable(item.as_text())

    def number(self, name: str, default: float, low: float = -FLOAT_MAX, high: float = FLOAT_MAX) -> float:
        """A number member."""
        item = self.get(name)
        return default if item is None else item.as_number(low, high)

    def numbers(
        self, name: str, default: tuple[float, ...], low: float = -FLOAT_MAX, high: float = FLOAT_MAX
    ) -> tuple[float, ...]:
        """A member that is an array of as many numbers as ``default``."""
        item = self.get(name)
        return default if item is None else item.as_numbers(len(default), low, high)

    def integer(self, name: str, default: int, low: int = 0, high: int = 2**53) -> int:
        """An integer member."""
        item = self.get(name)
        return default if item is None else item.as_integer(low, high)

    def boolean(self, name: str, default: bool = False) -> bool:
        """A boolean member."""
        item = self.get(name)
        if item is None:
            return default
        if not isinstance(item.value, bool):
            raise item.wrong("a boolean")
        return item.value
