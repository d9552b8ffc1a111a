"""Names of the files a run writes: inside the output folder, of a known kind, and no two the same."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Annotated, Final

from pydantic import AfterValidator

from rendergraph.document.field_types import mistake

IMAGE_SUFFIXES: Final = (".png", ".exr", ".npy")
_LONGEST = 230  # bytes; file systems take 255, and a file being written has a longer name
_NUMBER = re.compile(r"\d{4,}")  # what {frame} becomes


def _output_file(name: str) -> str:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or "\\" in name or "\0" in name:
        raise mistake(f"'{name}' does not stay inside the output folder", "give a relative path without `..`")
    if path.suffix.lower() not in IMAGE_SUFFIXES:
        raise mistake(f"'{name}' has no known image suffix", f"end the name in {', '.join(IMAGE_SUFFIXES)}")
    if any(len(part.encode()) > _LONGEST for part in path.parts):
        raise mistake(f"'{name}' is too long for a file's name", f"use at most {_LONGEST} bytes between slashes")
    return str(path)


#: A file name inside the output folder, its path normalised; ``{frame}`` stands for the frame's number.
OutputFile = Annotated[str, AfterValidator(_output_file)]


def find_clash(files: Mapping[str, str]) -> tuple[str, str, str] | None:
    """(first output, second output, problem) of the first two of ``files``, by output, that cannot both be written."""
    plain: dict[str, str] = {}
    framed: dict[str, str] = {}
    folders: dict[str, str] = {}
    numbered: dict[str, str] = {}  # plain ones by what they look like with their number replaced
    for name, file in files.items():
        shape = _NUMBER.sub("{frame}", file)
        same = framed.get(shape) or (numbered.get(shape) if "{frame}" in file else plain.get(file))
        if same is not None:
            return same, name, f"outputs '{same}' and '{name}' both write {file}"
        inside = [str(parent) for parent in PurePosixPath(file).parents]
        across = folders.get(file) or next((plain[parent] for parent in inside if parent in plain), None)
        if across is not None:
            return across, name, f"outputs '{across}' and '{name}' need one name as a file and as a folder"
        for parent in inside:
            folders.setdefault(parent, name)
        (framed if "{frame}" in file else plain)[shape if "{frame}" in file else file] = name
        numbered.setdefault(shape, name)
    return None
