"""pydantic's errors in the words of this tool: where, what was expected, what was found, what to write instead."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from rendergraph.document.model_fields import Loc, help_of, keys_at
from rendergraph.document.suggest import did_you_mean
from rendergraph.document.yaml_scalars import YAML_1_1_BOOLEANS

MAX_MISTAKES: Final = 100  # described in one document: nobody reads more, and looking for suggestions takes time

ModelT = TypeVar("ModelT", bound=BaseModel)


@dataclass(frozen=True, slots=True)
class Mistake:
    """One mistake in a model's data.

    ``kind`` is ``missing``, ``unknown``, ``type``, ``range``, ``choice``, ``name``, ``length``, ``consistency``, or a
    code of the message table, for which ``data`` holds the template's values. ``loc`` leads to the value, or to its key
    where ``at_key``. ``expected`` completes "must be ..."; for the kinds ``missing`` and ``unknown`` it is the key, for
    ``consistency`` the whole problem.
    """

    kind: str
    loc: Loc
    expected: str = ""
    hint: str = ""
    found: str = ""
    at_key: bool = False
    data: Mapping[str, Any] = field(default_factory=dict)


_MAPPING = ("a mapping", "write `key: value` lines below it, or remove the key for its default")
_LIST = ("a list", "write it in brackets: [a, b]")
_WHOLE = ("a whole number", "write digits only, without quotes or decimal point")
_NUMBER = ("a number", "write digits without quotes")
_BOOLEAN = ("true or false", "write true or false without quotes")
_TYPES: Final[dict[str, tuple[str, str]]] = {
    "int_type": _WHOLE,
    "int_from_float": _WHOLE,
    "int_parsing": _WHOLE,
    "float_type": _NUMBER,
    "float_parsing": _NUMBER,
    "finite_number": ("a finite number", "infinities and NaN are not allowed"),
    "bool_type": _BOOLEAN,
    "bool_parsing": _BOOLEAN,
    "string_type": ("text", "quote it to make it text"),
    "dict_type": _MAPPING,
    "model_type": _MAPPING,
    "model_attributes_type": _MAPPING,
    "list_type": _LIST,
    "tuple_type": _LIST,
    "set_type": _LIST,
    "frozen_set_type": _LIST,
    "none_required": ("nothing", "leave the value empty"),
}
_RANGES: Final[dict[str, tuple[str, str]]] = {
    "greater_than": ("above", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("below", "lt"),
    "less_than_equal": ("at most", "le"),
    "multiple_of": ("a multiple of", "multiple_of"),
}
_LENGTHS: Final[dict[str, tuple[str, str, str]]] = {
    "too_short": ("at least", "min_length", "value"),
    "too_long": ("at most", "max_length", "value"),
    "string_too_short": ("at least", "min_length", "character"),
    "string_too_long": ("at most", "max_length", "character"),
}
_MERGEABLE = ("type", "range", "choice", "length")
_CODE = re.compile(r"RG\d{3}\Z")
_CHOICE = re.compile(r"'([^']*)'|([^\s,']+)(?=,| or |\Z)")


def validate_strictly(model: type[ModelT], data: Any) -> tuple[ModelT | None, list[Mistake]]:
    """Validate plain YAML data without coercions (JSON's strict mode: a list may become a tuple, text no number).

    Data must hold only mappings with text keys, lists and scalars. The model is ``None`` when there are mistakes.
    Of very many mistakes only the first are described.
    """
    try:
        return model.model_validate_json(json.dumps(data), strict=True), []
    except ValidationError as error:
        details = error.errors(include_url=False)[: MAX_MISTAKES + 1]
        return None, _one_a_place([_mistake(detail, model, data) for detail in details])


def describe(value: Any) -> str:
    """A value in a few words."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"the text '{value if len(value) <= 40 else value[:37] + '...'}'"
    if isinstance(value, dict):
        return "a mapping"
    return "a list" if isinstance(value, list) else str(value)


# ---------------------------------------------------------------- one error


def _mistake(detail: ErrorDetails, model: type[BaseModel], data: Any) -> Mistake:
    kind, context, value = detail["type"], detail.get("ctx", {}), detail["input"]
    loc, missing = _resolved(detail["loc"], data)
    if kind == "missing" and isinstance(missing, str):
        return Mistake("missing", loc, missing, help_of(model, loc, missing), at_key=True)
    if kind == "missing":
        return Mistake("length", loc, "longer", "values are missing at its end", _counted(_at(data, loc)))
    if kind == "extra_forbidden":
        key = str(loc[-1])
        return Mistake(
            "unknown", loc, key, did_you_mean(key, keys_at(model, loc[:-1]), "known: {choices}"), at_key=True
        )
    if kind == "mistake" or _CODE.match(kind):
        return _own(kind, loc, context, data)
    if kind in _TYPES:
        expected, hint = _TYPES[kind]
        return Mistake("type", loc, expected, _type_hint(expected, value) or hint, describe(value))
    if kind in _RANGES:
        phrase, bound = _RANGES[kind]
        limit = f"{phrase} {context[bound]:.10g}"
        return Mistake("range", loc, limit, f"give {limit}", describe(value))
    if kind in _LENGTHS:
        phrase, bound, unit = _LENGTHS[kind]
        limit = f"{phrase} {context[bound]} {unit}{'' if context[bound] == 1 else 's'}"
        return Mistake("length", loc, f"{limit} long", f"give {limit}", _counted(value))
    if kind in ("literal_error", "enum"):
        choices = [quoted or bare for quoted, bare in _CHOICE.findall(str(context["expected"]))]
        expected = choices[0] if len(choices) == 1 else f"one of {', '.join(choices)}"
        return Mistake("choice", loc, expected, did_you_mean(str(value), choices, "write {choices}"), describe(value))
    if kind == "string_pattern_mismatch":
        at_key, pattern = detail["loc"][-1:] == ("[key]",), str(context["pattern"])
        name = pattern.startswith("^[A-Za-z_]")
        expected, hint = ("a name", "") if name else (f"text that matches {pattern}", "check the spelling")
        return Mistake("name" if name else "choice", loc, expected, hint, describe(value), at_key)
    whole = isinstance(_at(data, loc), dict)
    if kind == "value_error":
        return Mistake("consistency", loc, str(context["error"]), "change one of the values", at_key=whole)
    return Mistake("consistency", loc, str(detail["msg"]), "see docs/yaml.md for what is allowed", at_key=whole)


def _own(kind: str, loc: Loc, context: Mapping[str, Any], data: Any) -> Mistake:
    """An error raised by this project's own validators (``models.mistake``), which may name the key to point at."""
    inner = tuple(part for part in str(context.get("key", "")).split("/") if part)
    at_key = bool(inner) or isinstance(_at(data, loc), dict)
    if kind == "mistake":
        return Mistake("consistency", loc + inner, str(context["problem"]), str(context["hint"]), at_key=at_key)
    return Mistake(kind, loc + inner, at_key=at_key, data={k: v for k, v in context.items() if k != "key"})


def _type_hint(expected: str, value: Any) -> str:
    if value is None:
        return "nothing follows the colon: write a value, or remove the key for its default"
    if not isinstance(value, str):
        return ""
    if expected == "true or false" and value in YAML_1_1_BOOLEANS:
        return f"write {YAML_1_1_BOOLEANS[value]}: `{value}` is text in YAML 1.2"
    if expected.endswith("number") and re.fullmatch(r"[-+]?\d[\d_]*", value):
        return f"write {value.replace('_', '')}, without quotes or underscores"
    return ""


def _counted(value: Any) -> str:
    if isinstance(value, str):
        return f"{len(value)} characters"
    return f"{len(value)}" if isinstance(value, (list, dict)) else describe(value)


def _resolved(loc: Sequence[str | int], data: Any) -> tuple[Loc, str | int | None]:
    """The part of pydantic's ``loc`` that leads through ``data``, for it also names the branches of unions; and its
    last part when that leads nowhere.
    """
    path: list[str | int] = []
    missing: str | int | None = None
    for part in loc:
        inside = part in data if isinstance(data, dict) else isinstance(data, list) and part in range(len(data))
        if inside:
            path.append(part)
            data = data[part]
        missing = None if inside else part
    return tuple(path), missing


def _at(data: Any, loc: Loc) -> Any:
    for part in loc:
        data = data[part]
    return data


# ---------------------------------------------------------------- several errors of one value


def _one_a_place(found: Sequence[Mistake]) -> list[Mistake]:
    """The branches of a union each complain about the same value: one mistake that names all they would take."""
    groups: dict[tuple[Loc, str], list[Mistake]] = {}
    for mistake in found:
        groups.setdefault((mistake.loc, mistake.expected if mistake.kind == "missing" else ""), []).append(mistake)
    return [_united(group) for group in groups.values()]


def _united(group: Sequence[Mistake]) -> Mistake:
    best = next((m for m in group if m.kind != "type"), group[0])
    expected = dict.fromkeys(m.expected for m in group if m.kind in _MERGEABLE)
    if best.kind not in _MERGEABLE or len(expected) == 1:
        return best
    return replace(
        best, expected=" or ".join(expected), hint=best.hint if best.kind == "choice" else "write one of these"
    )
