"""URIs of buffers and images: data: URIs, and files in the scene's folder. Nothing outside it can be named."""

from __future__ import annotations

import base64
import binascii
import re
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from rendergraph.scene.gltf.container import read_file
from rendergraph.scene.gltf.items import Item, gltf_error, printable

_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.\-]*):")


def read_uri(uri: Item, folder: Path) -> bytes:
    """The bytes a URI stands for. ``RenderGraphError``: RG611 not allowed or malformed, RG601 unreadable."""
    text = uri.as_text()
    if text[:5].lower() == "data:":
        return _decode_data(text, uri)
    return read_file(resolve(uri, folder), str(uri))


def resolve(uri: Item, folder: Path) -> Path:
    """The file a relative URI names, percent-decoded and with links followed; RG611 if that leaves ``folder``."""
    text = uri.as_text()
    name = unquote(text)
    if scheme := _SCHEME.match(name):
        raise _refused(uri, f"it has the scheme '{scheme[1]}:'")
    if name.startswith(("/", "\\")):
        raise _refused(uri, "it is absolute")
    if not name.strip("./") or not name.isprintable():
        raise _refused(uri, "it is not a file name")
    try:
        home = folder.resolve()
        path = (home / name).resolve()
    except (OSError, RuntimeError, ValueError):
        raise _refused(uri, "it cannot be resolved") from None
    if not path.is_relative_to(home):
        raise _refused(uri, "it leads out of the scene's folder")
    return path


def _decode_data(text: str, uri: Item) -> bytes:
    head, comma, body = text.partition(",")
    if not comma:
        raise _refused(uri, "a data: URI needs a comma")
    if not head.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    try:
        return base64.b64decode(unquote(body), validate=True)
    except (binascii.Error, ValueError):
        raise _refused(uri, "its base64 data is malformed") from None


def _refused(uri: Item, reason: str) -> Exception:
    text = printable(uri.as_text())
    return gltf_error("RG611", str(uri), uri=text if len(text) <= 80 else text[:77] + "...", reason=reason)
