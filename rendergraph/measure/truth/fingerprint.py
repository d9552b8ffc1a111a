"""Hashes what a truth was computed from: values of any shape, and the source of the modules that computed it."""

from __future__ import annotations

import hashlib
import importlib.util
import re
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel

_IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[^#\n(]*)|import[ \t]+([\w., \t]+))", re.MULTILINE
)


def fingerprint(value: Any) -> str:
    """SHA-256 over a value's content: arrays, dataclasses, pydantic models, mappings, sequences, paths' names and plain
    values. The order of mappings does not count. Raises ``TypeError`` for anything whose content is not known.
    """
    arrays: list[npt.NDArray[Any]] = []
    skeleton = _skeleton(value, arrays)
    # Hashing lets go of the interpreter lock, and images are most of it.
    with ThreadPoolExecutor() as pool:
        digests = pool.map(_hash_array, arrays)
        return hashlib.sha256("\n".join([skeleton, *digests]).encode()).hexdigest()


def _hash_array(array: npt.NDArray[Any]) -> str:
    return hashlib.sha256(np.ascontiguousarray(array).data).hexdigest()


def _skeleton(value: Any, arrays: list[npt.NDArray[Any]]) -> str:
    """Everything but the arrays' numbers, as unambiguous text; the arrays in the order they are met."""
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject:
            raise TypeError("an array of objects has no content of its own")
        arrays.append(value)
        return f"array({value.dtype.str},{value.shape})"
    if isinstance(value, np.generic):
        return f"{value.dtype.str}({value.item()!r})"
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    if value is None or isinstance(value, (bool, int, float, str, bytes)):
        return repr(value)
    if isinstance(value, Path):
        return f"path({value.name!r})"
    if isinstance(value, BaseModel):
        return f"{type(value).__qualname__}({_skeleton(dict(value), arrays)})"
    if isinstance(value, Mapping):
        inside = sorted(value.items(), key=lambda item: repr(item[0]))
        return "{" + ",".join(f"{_skeleton(k, arrays)}:{_skeleton(v, arrays)}" for k, v in inside) + "}"
    if isinstance(value, (set, frozenset)):
        return f"set{_skeleton(sorted(value, key=repr), arrays)}"
    if isinstance(value, Sequence):
        return "[" + ",".join(_skeleton(item, arrays) for item in value) + "]"
    if is_dataclass(value):
        inside = {field.name: getattr(value, field.name) for field in fields(value)}  # type: ignore[assignment]
        return f"{type(value).__qualname__}({_skeleton(inside, arrays)})"
    if hasattr(value, "pixels"):  # a scene's image, decoded when first asked for
        about = [value.name, value.srgb]
        return f"{type(value).__qualname__}({_skeleton([*about, value.pixels], arrays)})"
    raise TypeError(f"the content of {type(value).__qualname__} is not known")


@cache
def source_fingerprint(module: str) -> str:
    """SHA-256 over a module's source, its folder's other ``.py`` files, and all that they import, directly or not, of
    their own package: what a result may depend on that is no argument. Raises ``ImportError`` for an unknown module.
    """
    first = _file_of(module)
    if first is None:
        raise ImportError(f"no source of {module}", name=module)
    roots = {"rendergraph", module.partition(".")[0]}
    package = module.rpartition(".")[0]
    waiting = [(module, first), *((f"{package}.{p.stem}", p) for p in sorted(first.parent.glob("*.py")))]
    seen: dict[Path, str] = {}
    while waiting:
        name, path = waiting.pop()
        if path in seen:
            continue
        source = path.read_bytes()
        seen[path] = hashlib.sha256(source).hexdigest()
        inside = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for imported in _imports(source.decode("utf-8", "replace"), inside):
            if imported.partition(".")[0] in roots:
                found = _file_of(imported)
                if found is not None:
                    waiting.append((imported, found))
    return hashlib.sha256("\n".join(sorted(seen.values())).encode()).hexdigest()


def _imports(source: str, package: str) -> Iterator[str]:
    """Names of modules that may be imported by a source: ``from a import b`` names a, and perhaps a.b. A text search:
    parsing would cost more than reading the cached result, and a name too many does no harm.
    """
    for match in _IMPORT.finditer(source):
        origin, names, plain = match[1], match[2], match[3]
        if plain is not None:
            yield from (part.split()[0] for part in plain.split(",") if part.strip())
            continue
        base = origin
        if origin.startswith("."):
            up = len(origin) - len(origin.lstrip("."))
            base = ".".join([*package.split(".")[: len(package.split(".")) - up + 1], *filter(None, [origin[up:]])])
        yield base
        for name in names.strip("() \n").split(","):
            if name.strip() and name.strip() != "*":
                yield f"{base}.{name.split()[0]}"


@cache
def _file_of(module: str) -> Path | None:
    """The source file of a module by its name, without importing it: looked for beside its top package."""
    top, *rest = module.split(".")
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return None
    if spec is None or spec.origin is None:
        return None
    if not rest:
        return Path(spec.origin)
    place = Path(spec.origin).parent.joinpath(*rest)
    for candidate in (place / "__init__.py", place.with_name(f"{place.name}.py")):
        if candidate.is_file():
            return candidate
    return None
