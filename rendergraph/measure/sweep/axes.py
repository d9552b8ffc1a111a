"""What a sweep varies: ``--over occlude.preset,occlude.radius=0.5:4:5`` as axes with their values."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Final, Literal

from rendergraph.document.formats import FORMATS
from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.discovery import find_node
from rendergraph.plan.graph import Position

#: Values of a numeric knob that is named without any.
DEFAULT_STEPS: Final = 5
_SECTIONS: Final = ("passes", "resources", "scene", "frame")
_RANGE: Final = re.compile(r"([^:|]+):([^:|]+):([^:|]+)(:log)?")

Direction = Literal["up", "down", "order", ""]


@dataclass(frozen=True, slots=True)
class Axis:
    """One thing varied: the name it was given, the path ``--set`` takes, and its values as YAML scalars.

    ``quality`` says how accuracy goes along the values: ``up`` and ``down`` for numbers, ``order`` where the node lists
    its choices from cheap to accurate, empty where it claims nothing. ``values`` of the first three run from cheap to
    accurate; so do those of a resource's format, scale and fixed size, by how much it holds. ``passed`` is the pass
    whose knob it is, or the only one that writes the resource; empty for any other path.
    """

    name: str
    path: str
    values: tuple[str, ...]
    quality: Direction = ""
    passed: str = ""


def parse_axes(document: Document, over: Sequence[str]) -> tuple[Axis, ...]:
    """The axes of ``--over``, several to an argument with commas between them.

    An axis is ``PASS.KNOB`` or any path of ``--set``, alone (a knob's own choices, or its range in five steps) or with
    ``=low:high:count`` (``:log`` for even ratios) or ``=a|b|c``.

    :raises RenderGraphError: RG750 for an unknown pass or knob, RG751 for a range or list that is none, RG752 for an
        axis named twice, each with what was meant; exit code 2.
    """
    axes: list[Axis] = []
    errors: list[Diagnostic] = []
    for text in (part.strip() for argument in over for part in _split(argument)):
        try:
            axis = _axis(document, text)
        except RenderGraphError as error:
            errors += error.diagnostics
            continue
        if any(axis.path == other.path for other in axes):
            errors.append(diagnose("RG752", _place(text), path=axis.path))
        axes.append(axis)
    if not axes and not errors:
        errors.append(diagnose("RG751", text="", problem="no axis is named", hint="name one: --over PASS.KNOB"))
    if errors:
        raise RenderGraphError(errors, exit_code=2)
    return tuple(axes)


def _split(argument: str) -> list[str]:
    """At commas outside brackets: a value may be a YAML list."""
    parts, depth = [""], 0
    for letter in argument:
        depth += (letter in "[{(") - (letter in "]})")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def _place(text: str) -> Position:
    return Position(f"--over {text}", 1, 1)


def _axis(document: Document, text: str) -> Axis:
    name, equals, given = (part.strip() for part in text.partition("="))
    first, _, rest = name.partition(".")
    if first in _SECTIONS and rest and not (first in document.model.passes and "." not in rest):
        knob = re.fullmatch(r"passes\.([^.]+)\.set\.([^.]+)", name)
        if knob is None:
            if not equals:
                raise _bad(text, "a path that is no knob has no values of its own", "give some: PATH=a|b|c")
            return _any_path(document, name, _values(text, given))
        first, rest = knob.groups()
    entry = _knob(document, text, first, rest)
    values = _values(text, given) if equals else _own_values(text, entry)
    quality = entry.get("accurate") or ""
    ordered, direction = _from_cheap_to_accurate(values, quality)
    return Axis(f"{first}.{rest}", f"passes.{first}.set.{rest}", ordered, direction, first)


def _any_path(document: Document, path: str, values: tuple[str, ...]) -> Axis:
    resource = re.fullmatch(r"resources\.([^.]+)\.(format|scale|fixed)", path)
    if resource is None:
        return Axis(path, path, values)
    amounts = {value: amount_held(resource[2], value) for value in values}
    writers = [name for name, model in document.model.passes.items() if resource[1] in model.write.values()]
    passed = writers[0] if len(writers) == 1 else ""
    if None in amounts.values() or len(set(amounts.values())) < len(amounts):
        return Axis(path, path, values, passed=passed)
    ordered = sorted(values, key=lambda value: amounts[value] or 0.0)
    return Axis(path, path, tuple(ordered), "order", passed)


def amount_held(key: str, value: str) -> float | None:
    """How much a resource holds by its format (bits a channel), scale or fixed size (texels), to compare settings of
    one key by; None where the value is none of these.
    """
    if key == "format":
        known = FORMATS.get(value)
        return None if known is None else known.texel_bytes / known.channels
    numbers = re.fullmatch(r"\[?\s*([0-9.]+)\s*(?:,\s*([0-9.]+)\s*)?\]?", value)
    try:
        return None if numbers is None else float(numbers[1]) * float(numbers[2] or 1.0)
    except ValueError:
        return None


def _knob(document: Document, text: str, name: str, knob: str) -> dict[str, Any]:
    """The JSON schema entry of a knob."""
    passes = document.model.passes
    if name not in passes:
        hint = did_you_mean(name, passes)
        raise RenderGraphError([diagnose("RG750", _place(text), problem=f"there is no pass '{name}'", hint=hint)])
    node = find_node(passes[name].node)
    properties: dict[str, Any] = node.params_type.model_json_schema().get("properties", {})
    if knob not in properties:
        problem = f"'{passes[name].node}' has no parameter '{knob}'"
        hint = did_you_mean(knob, properties) if properties else "it has none"
        raise RenderGraphError([diagnose("RG750", _place(text), problem=problem, hint=hint)])
    return dict(properties[knob])


def _own_values(text: str, entry: dict[str, Any]) -> tuple[str, ...]:
    if isinstance(entry.get("accurate"), list):
        return tuple(_scalar(value) for value in entry["accurate"])
    if "enum" in entry:
        return tuple(_scalar(value) for value in entry["enum"])
    if entry.get("type") == "boolean":
        return ("false", "true")
    low = entry.get("minimum", entry.get("exclusiveMinimum"))
    high = entry.get("maximum", entry.get("exclusiveMaximum"))
    if entry.get("type") not in ("integer", "number") or low is None or high is None:
        raise _bad(text, "it has no range of its own", "give its values: =low:high:count or =a|b|c")
    values = _spaced(float(low), float(high), DEFAULT_STEPS, even_ratios=False)
    inside = [v for v in values if v != entry.get("exclusiveMinimum") and v != entry.get("exclusiveMaximum")]
    return _numbers(inside, entry["type"] == "integer")


def _values(text: str, given: str) -> tuple[str, ...]:
    ranged = _RANGE.fullmatch(given)
    if ranged is None:
        values = tuple(part.strip() for part in given.split("|"))
        if not all(values):
            raise _bad(text, "a value is empty", "write =a|b|c or =low:high:count")
        if len(set(values)) < len(values):
            raise _bad(text, "a value stands twice", "each setting is measured once")
        return values
    try:
        low, high, count = float(ranged[1]), float(ranged[2]), int(ranged[3])
    except ValueError:
        raise _bad(text, f"'{given}' is no range of numbers", "write =low:high:count, as in 0.5:4:5") from None
    if not (isfinite(low) and isfinite(high)):
        raise _bad(text, "a bound is not finite", "give two numbers")
    if count < 1 or low > high or (low == high) != (count == 1):
        raise _bad(text, f"the range from {low:g} to {high:g} in {count} steps is empty", "low < high, two or more")
    if ranged[4] and low <= 0:
        raise _bad(text, "even ratios need positive bounds", "leave :log out, or raise the lower bound")
    whole = all("." not in ranged[k] and "e" not in ranged[k].lower() for k in (1, 2)) and high - low >= count - 1
    return _numbers(_spaced(low, high, count, even_ratios=bool(ranged[4])), whole)


def _spaced(low: float, high: float, count: int, *, even_ratios: bool) -> list[float]:
    if count == 1:
        return [low]
    shares = [index / (count - 1) for index in range(count)]
    if even_ratios:
        return [low * (high / low) ** share for share in shares]
    return [low + (high - low) * share for share in shares]


def _numbers(values: Sequence[float], whole: bool) -> tuple[str, ...]:
    """Distinct scalars; six digits are enough to tell settings apart and short enough to paste."""
    texts = [str(round(value)) if whole else f"{value:.6g}" for value in values]
    return tuple(dict.fromkeys(text.replace("e+", "e") for text in texts))


def _from_cheap_to_accurate(values: tuple[str, ...], accurate: Any) -> tuple[tuple[str, ...], Direction]:
    if isinstance(accurate, list):
        rank = {_scalar(value): index for index, value in enumerate(accurate)}
        if all(value in rank for value in values):
            return tuple(sorted(values, key=rank.__getitem__)), "order"
        return values, ""
    if accurate in ("up", "down"):
        try:
            return tuple(sorted(values, key=float, reverse=accurate == "down")), accurate
        except ValueError:
            return values, ""
    return values, ""


def _scalar(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _bad(text: str, problem: str, hint: str) -> RenderGraphError:
    return RenderGraphError([diagnose("RG751", _place(text), text=text, problem=problem, hint=hint)])
