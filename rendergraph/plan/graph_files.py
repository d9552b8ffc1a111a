"""Files a graph names: they lie inside the graph's own folder, and they exist."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Any, get_args

from pydantic.fields import FieldInfo

from rendergraph.node.params import Params

MISSING = "does not exist"


def locate(folder: Path, name: str) -> Path | None:
    """The file's path when it stays inside the resolved ``folder`` (symbolic links followed), else ``None``."""
    try:
        found = (folder / name).resolve()
        return found if found.is_relative_to(folder) else None
    except (OSError, ValueError, RuntimeError):  # a name with a NUL, or a loop of links
        return None


def file_problem(folder: Path, name: str) -> str | None:
    """What is wrong with a file named in a graph that lies in ``folder``, to stand after its name; or ``None``."""
    path = locate(folder, name)
    if path is None:
        return "lies outside the graph's folder"
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return MISSING
    except OSError as error:
        return f"cannot be read: {error.strerror}"
    return None if S_ISREG(mode) else "is a folder" if S_ISDIR(mode) else "is no regular file"


def named_files(params: Params) -> Iterator[tuple[str, str]]:
    """(field, file name) of every parameter of type ``GraphFile``, also inside optionals, lists and mappings."""
    for field in _file_fields(type(params)):
        yield from ((field, name) for name in _strings(getattr(params, field)))


@cache
def _file_fields(params_type: type[Params]) -> tuple[str, ...]:
    return tuple(
        name
        for name, field in params_type.model_fields.items()
        if _is_file(field) or any(_holds_file(argument) for argument in get_args(field.annotation))
    )


def _is_file(info: object) -> bool:
    extra = info.json_schema_extra if isinstance(info, FieldInfo) else None
    return isinstance(extra, dict) and bool(extra.get("rg_file"))


def _holds_file(annotation: Any) -> bool:
    return any(_is_file(m) for m in getattr(annotation, "__metadata__", ())) or any(
        _holds_file(argument) for argument in get_args(annotation)
    )


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for item in value.values():
            yield from _strings(item)
    elif isinstance(value, (tuple, list)):
        for item in value:
            yield from _strings(item)
