"""Finds and reads a graph file: a path, or the name of a graph shipped with the package."""

from __future__ import annotations

import errno
from pathlib import Path
from typing import Final

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import closest
from rendergraph.plan.graph import Position

MAX_BYTES: Final = 8 << 20
UNREADABLE: Final = 2  # exit code

_BOM = b"\xef\xbb\xbf"
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def graph_folder() -> Path:
    """The folder of the shipped graphs."""
    return Path(__file__).resolve().parent.parent / "graphs"


def shipped_graphs() -> tuple[str, ...]:
    """Names of the graphs that come with the package, sorted."""
    return tuple(sorted(path.stem for path in graph_folder().glob("*.yaml")))


def find_graph(path: str | Path) -> Path:
    """The file to read: ``path`` itself, or the shipped graph of that bare name when there is no such file."""
    given = Path(path)
    if given.name == str(path) and not given.suffix and given.name in shipped_graphs() and not _is_file(given):
        return graph_folder() / f"{given.name}.yaml"
    return given


def read_source(path: Path) -> bytes:
    """The file's content as UTF-8 without byte-order mark.

    Raises ``RenderGraphError``, exit code 2: RG100 not found, RG101 unreadable, RG102 not UTF-8, RG103 too large.
    """
    data = _read(path)
    if len(data) > MAX_BYTES:
        raise _unreadable("RG103", path, what="file size in bytes", limit=MAX_BYTES)
    bom = len(_BOM) if data.startswith(_BOM) else 0
    try:
        data[bom:].decode("utf-8")
    except UnicodeDecodeError as error:
        offset = error.start + bom
        before = data[bom:offset].decode("utf-8")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        hint = "save the file as UTF-8"
        if data.startswith(_UTF_16):
            hint = "the file is UTF-16: save it as UTF-8"
        elif b"\0" in data[:4096]:
            hint = "this looks like a binary file, not like a graph"
        found = diagnose(
            "RG102", Position(str(path), line, column), byte=f"0x{data[offset]:02X}", offset=offset, hint=hint
        )
        raise RenderGraphError([found], UNREADABLE) from None
    return data[bom:]


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except (FileNotFoundError, NotADirectoryError):
        raise _unreadable("RG100", path, hint=_neighbour(path)) from None
    except IsADirectoryError:
        raise _unreadable("RG101", path, reason="it is a directory", hint="name a file inside it") from None
    except PermissionError:
        raise _unreadable("RG101", path, reason="no permission", hint="check the file's permissions") from None
    except (OSError, ValueError) as error:
        reason = error.strerror or str(error) if isinstance(error, OSError) else str(error)
        if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG:
            reason = "the name is too long"
        raise _unreadable("RG101", path, reason=reason, hint="check the name") from None


def _unreadable(code: str, path: Path, **data: object) -> RenderGraphError:
    shown = str(path).encode("utf-8", "backslashreplace").decode("utf-8").replace("\0", "\\0")
    return RenderGraphError([diagnose(code, Position(shown, 1, 1), **({"path": shown} | data))], UNREADABLE)


def _neighbour(path: Path) -> str:
    """What was probably meant: a shipped graph, or another YAML file of the folder."""
    shipped = shipped_graphs()
    near = closest(path.stem, shipped) if path.parent == Path() else None
    try:
        files = [p.name for p in path.parent.iterdir() if p.suffix in (".yaml", ".yml")]
    except OSError:
        return f"there is no folder '{path.parent}'"
    file = closest(path.name, files)
    if file is not None:
        return f"did you mean '{path.parent / file}'?"
    if near is not None:
        return f"did you mean the shipped graph '{near}'?"
    return f"give a graph file, or a shipped graph: {', '.join(shipped)}" if shipped else "give a graph file"


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False
