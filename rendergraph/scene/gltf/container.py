"""From a path to the file's JSON and its binary chunk: .gltf and .glb (glTF 2.0, chapter 4)."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, NoReturn

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Position
from rendergraph.scene.gltf.items import Item, gltf_error

MAX_FILE = 2**32 - 1  # a .glb cannot be longer
MAX_JSON = 2**28

_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")


def read_file(path: Path, where: str) -> bytes:
    """A regular file's bytes. ``RenderGraphError`` RG601 when it cannot be read, RG617 when it is over 4 GiB."""
    try:
        # Devices and pipes are refused before opening: reading one may never end.
        if not path.is_file():
            reason = (
                "it is a directory" if path.is_dir() else "no such file" if not path.exists() else "not a regular file"
            )
            raise gltf_error("RG601", where, path=path.name, reason=reason)
        size = path.stat().st_size
        if size > MAX_FILE:
            raise gltf_error("RG617", where, what="bytes", count=size, limit=MAX_FILE)
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or "not a file name"
        raise gltf_error("RG601", where, path=path.name, reason=reason) from None


def read_container(path: Path) -> tuple[Item, bytes | None]:
    """The JSON root, and the binary chunk of a .glb. The content decides which it is, not the name.

    ``RenderGraphError``: RG601 unreadable, RG602 not glTF, RG603 broken JSON.
    """
    file = path.name or str(path)
    content = read_file(path, file)
    if content[:4] == b"glTF":
        text, chunk = _split_glb(content, file)
    elif content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{":
        text, chunk = content, None
    else:
        reason = "it is empty" if not content else "it starts with neither 'glTF' (.glb) nor '{' (.gltf)"
        raise gltf_error("RG602", file, reason=reason)
    root = Item(_parse(text, path, chunk is None), file)
    root.members()
    return root, chunk


def _split_glb(content: bytes, file: str) -> tuple[bytes, bytes | None]:
    if len(content) < _HEADER.size + _CHUNK.size:
        raise gltf_error("RG602", file, reason=f"it ends inside the header, after {len(content)} bytes")
    _, version, length = _HEADER.unpack_from(content)
    if version != 2:
        raise gltf_error("RG602", file, reason=f"it is version {version} of the binary format")
    if length > len(content):
        raise gltf_error("RG602", file, reason=f"it is cut short: {len(content)} of {length} bytes")
    chunks: dict[bytes, bytes] = {}
    offset = _HEADER.size
    while offset + _CHUNK.size <= length:
        size, kind = _CHUNK.unpack_from(content, offset)
        start, offset = offset + _CHUNK.size, offset + _CHUNK.size + size
        if offset > length:
            raise gltf_error("RG602", file, reason=f"a chunk of {size} bytes runs past the end at {length}")
        if not chunks and kind != b"JSON":
            raise gltf_error("RG602", file, reason="its first chunk is not JSON")
        chunks.setdefault(kind, content[start:offset])
    if b"JSON" not in chunks:
        raise gltf_error("RG602", file, reason="it has no JSON chunk")
    return chunks[b"JSON"], chunks.get(b"BIN\0", b"")


def _parse(text: bytes, path: Path, positioned: bool) -> Any:
    def not_a_number(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a JSON number")

    if len(text) > MAX_JSON:
        raise gltf_error("RG617", path.name, what="bytes of JSON", count=len(text), limit=MAX_JSON)
    position = None
    try:
        return json.loads(text.decode("utf-8-sig"), parse_constant=not_a_number, parse_float=_finite)
    except RecursionError:
        reason = "it is nested too deeply"
    except UnicodeDecodeError as error:
        reason = f"byte {error.start} is not UTF-8"
    except json.JSONDecodeError as error:
        reason = error.msg
        if positioned:
            position = Position(str(path), error.lineno, error.colno)
        else:
            reason += f" at byte {error.pos} of the JSON chunk"
    except ValueError as error:  # not_a_number, _finite, or an integer of thousands of digits
        reason = str(error).split(";")[0]
    raise RenderGraphError([diagnose("RG603", position, where=path.name, reason=reason)], exit_code=2)


def _finite(digits: str) -> float:
    value = float(digits)
    if value in (float("inf"), float("-inf")):
        raise ValueError(f"the number {digits[:20]} is out of range")
    return value
