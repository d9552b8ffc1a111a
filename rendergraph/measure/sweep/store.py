"""What a sweep has measured so far, in its folder: one line a setting, so that nothing is lost and work goes on."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import cannot_write, require_folder
from rendergraph.measure.sweep.errors import PointError

#: The index of the document's own setting, which every chunk measures.
CONTROL: Final = -1
FILE: Final = "sweep.jsonl"
_LOCK: Final = ".sweep.lock"


@dataclass(frozen=True, slots=True)
class PointResult:
    """One setting, measured in chunk ``chunk``: bytes of transient memory, error, frame times in ms by round, whether
    it was steady, and the ms of all its frames; or why it was refused.
    """

    index: int
    chunk: int
    bytes: int = 0
    error: PointError | None = None
    rounds: tuple[tuple[float, ...], ...] = ()
    steady: bool = False
    run_ms: float = 0.0
    refused: str = ""


@dataclass(frozen=True, slots=True)
class ChunkResult:
    """Settings measured in turn with each other, and with the document's own (``control``)."""

    number: int
    control: PointResult
    points: tuple[PointResult, ...]
    contended: bool = False


@dataclass(slots=True)
class Stored:
    """What a file holds: the header, who measured, and the chunks by number."""

    header: dict[str, Any] = field(default_factory=dict)
    device: dict[str, Any] = field(default_factory=dict)
    chunks: dict[int, ChunkResult] = field(default_factory=dict)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for one sweep; the system lets go of it when the process ends, however that is.

    :raises RenderGraphError: RG755 where another sweep holds it, RG560 where it cannot be written.
    """
    require_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / _LOCK).open("w")
    except OSError as error:
        raise cannot_write(folder, error) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise RenderGraphError([diagnose("RG755", folder=str(folder))], exit_code=2) from None
        yield


class Store:
    """``sweep.jsonl`` of a folder that is :func:`locked`."""

    def __init__(self, folder: Path, header: Mapping[str, Any], *, fresh: bool = False) -> None:
        """Open it, or begin it; ``fresh`` begins anew.

        :raises RenderGraphError: RG754 where it belongs to another sweep, naming what differs; RG560.
        """
        self.folder = folder
        self._path = folder / FILE
        try:
            if fresh:
                self._path.unlink(missing_ok=True)
            data = self._path.read_bytes() if self._path.exists() else b""
            whole = data[: data.rfind(b"\n") + 1]  # a process that was killed leaves half a line
            if whole != data:
                os.truncate(self._path, len(whole))
        except OSError as error:
            raise cannot_write(self._path, error) from None
        self.stored = read_lines(whole.decode("utf-8", "replace"))
        if whole and self.stored.header != dict(header):
            self._refuse(differing(self.stored.header, header))
        if not whole:
            self.stored.header = dict(header)
            self._append({"header": self.stored.header})

    def take_device(self, facts: Mapping[str, Any]) -> None:
        """Note who measures. Raises RenderGraphError RG754 where somebody else measured what is there."""
        if self.stored.device and self.stored.device != dict(facts):
            self._refuse(differing(self.stored.device, facts))
        if not self.stored.device:
            self.stored.device = dict(facts)
            self._append({"device": self.stored.device})

    def add(self, chunk: ChunkResult) -> None:
        """Keep a chunk, on the disk when this returns."""
        self.stored.chunks[chunk.number] = chunk
        control = {"control": asdict(chunk.control), "contended": chunk.contended}
        self._append(control, *({"point": asdict(point)} for point in chunk.points))

    def next_number(self) -> int:
        """A number for a chunk that none has yet."""
        return max(self.stored.chunks, default=-1) + 1

    def _append(self, *lines: Mapping[str, Any]) -> None:
        text = "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines)
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise cannot_write(self._path, error) from None

    def _refuse(self, what: str) -> None:
        raise RenderGraphError([diagnose("RG754", folder=str(self.folder), what=what)], exit_code=2)


def read_lines(text: str) -> Stored:
    """The content of a file, as far as it makes sense: what comes after a line that does not is measured again."""
    found = Stored()
    for line in text.splitlines():
        try:
            entry = json.loads(line)
            if "header" in entry:
                found.header = entry["header"]
            elif "device" in entry:
                found.device = entry["device"]
            elif "control" in entry:
                control = _point(entry["control"])
                found.chunks[control.chunk] = ChunkResult(control.chunk, control, (), entry["contended"])
            else:
                point = _point(entry["point"])
                chunk = found.chunks[point.chunk]
                points = (*chunk.points, point)
                found.chunks[point.chunk] = ChunkResult(chunk.number, chunk.control, points, chunk.contended)
        except (ValueError, KeyError, TypeError):
            break
    return found


def chunk_of_json(data: dict[str, Any]) -> ChunkResult:
    """A chunk that :func:`dataclasses.asdict` made plain."""
    points = tuple(_point(point) for point in data["points"])
    return ChunkResult(data["number"], _point(data["control"]), points, data["contended"])


def _point(data: dict[str, Any]) -> PointResult:
    error = PointError(**data["error"]) if data["error"] is not None else None
    rounds = tuple(tuple(frames) for frames in data["rounds"])
    return PointResult(**{**data, "error": error, "rounds": rounds})


def differing(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """What two headers differ in, in words."""
    names = [key for key in dict.fromkeys([*before, *now]) if before.get(key) != now.get(key)]

    def said(value: Any) -> str:
        text = value if isinstance(value, str) else json.dumps(value)
        return text if len(text) <= 40 else f"{text[:37]}..."

    return "; ".join(f"{name} was {said(before.get(name))}, is {said(now.get(name))}" for name in names)
