"""Which models, and so which keys, belong at a location of a document."""

from __future__ import annotations

from typing import Any, get_args, get_origin

from pydantic import BaseModel

Loc = tuple[str | int, ...]


def keys_at(model: type[BaseModel], loc: Loc) -> set[str]:
    """The keys allowed in the mapping at ``loc``."""
    return {name for holder in _holders(model, loc) for name in holder.model_fields}


def help_of(model: type[BaseModel], loc: Loc, name: str) -> str:
    """The description of the key ``name`` of the mapping at ``loc``, as part of a sentence."""
    fields = [holder.model_fields[name] for holder in _holders(model, loc) if name in holder.model_fields]
    text = next((field.description for field in fields if field.description), "")
    return text[:1].lower() + text[1:].rstrip(".")


def _holders(model: type[BaseModel], loc: Loc) -> list[type[BaseModel]]:
    annotations: list[Any] = [model]
    for part in loc:
        annotations = [found for annotation in annotations for found in _inner(annotation, part)]
    return [found for annotation in annotations for found in _models(annotation)]


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for argument in get_args(annotation) for found in _models(argument)]


def _inner(annotation: Any, part: str | int) -> list[Any]:
    """The annotations of what lies at ``part`` of a value so annotated."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        field = annotation.model_fields.get(str(part))
        return [field.annotation] if field else []
    arguments, origin = get_args(annotation), get_origin(annotation)
    if origin is dict:
        return [arguments[1]]
    if origin in (list, tuple, set, frozenset):
        return [argument for argument in arguments if argument is not Ellipsis]
    return [found for argument in arguments for found in _inner(argument, part)]
