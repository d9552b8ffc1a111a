"""Truths kept on disk by the content of what they were computed from.

An entry is one ``.npz``, written beside its place and renamed when whole, and read to its end, where the archive's
checksums are: a file that is cut or damaged is no entry. Processes that compute the same truth at the same time each
write a whole file of the same content, and the last one stays.

What a reference is given goes into the key. What it may ask for (the pass's outputs, an input supersampled) goes into
the entry, as hashes of what it did ask for: an entry holds only where asking again gives the same (a verifying trace;
Mokhov, Mitchell and Peyton Jones, "Build Systems a la Carte", 2018).
"""

from __future__ import annotations

import hashlib
import json
import os
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

import rendergraph
from rendergraph.document.messages import RenderGraphError
from rendergraph.document.whole_files import whole_file
from rendergraph.measure.truth.cache_folder import LIMIT, cache_folder, evict
from rendergraph.measure.truth.fingerprint import fingerprint, source_fingerprint
from rendergraph.node.contract import Node
from rendergraph.node.reference import PassRun, Truth

_LAYOUT: Final = 1  # of an entry; part of the key
_PARTS: Final = ("value", "judged", "mask", "standard_error")
_RESULTS: Final = ("outputs", "levels", "stencils")  # of a run: known only by running the pass


@dataclass(frozen=True, slots=True)
class CachedTruths:
    """Truths by measure, and the seconds they took when they were computed."""

    truths: Mapping[str, Truth]
    seconds: float


class TruthCache:
    """Truths on disk; ``hits`` and ``misses`` count. Nothing here raises: a cache that cannot be used is a miss."""

    def __init__(self, folder: Path, limit: int = LIMIT) -> None:
        self.folder = folder
        self.limit = limit
        self.hits = 0
        self.misses = 0
        self._scenes: dict[int, tuple[Any, str]] = {}  # the scene too: an id is an object's only while it lives

    def recall(
        self, node: type[Node[Any]], run: PassRun, compute: Callable[[PassRun], Mapping[str, Truth]]
    ) -> tuple[CachedTruths, bool]:
        """The truths of a run, and whether they were kept: else ``compute`` makes them, and they are from now on."""
        try:
            key = self._key(node, run)
        except (TypeError, ImportError, OSError, RenderGraphError):  # what cannot be hashed is computed anew
            self.misses += 1
            return compute_timed(compute, run), False
        found = self._load(key, run)
        if found is not None:
            self.hits += 1
            return found, True
        self.misses += 1
        asked = Asked(run)
        made = compute_timed(compute, asked.watched())
        self._store(key, made, asked.digests())
        return made, False

    def _key(self, node: type[Node[Any]], run: PassRun) -> str:
        scene = run.scene
        if id(scene) not in self._scenes:
            self._scenes = {id(scene): (scene, fingerprint(scene))}
        given = {
            "layout": _LAYOUT,
            "rendergraph": rendergraph.__version__,
            "node": f"{node.__module__}.{node.__qualname__}",
            "source": source_fingerprint(f"{node.__module__}.reference"),
            "judging": source_fingerprint(__name__),
            "params": run.params,
            "files": _named_files(run),
            "inputs": run.inputs,
            "before": run.before,
            "descs": run.descs,
            "frame": run.frame,
            "index": run.index,
            "camera": run.camera,
            "scene": self._scenes[id(scene)][1],
        }
        return fingerprint(given)

    def _load(self, key: str, run: PassRun) -> CachedTruths | None:
        path = self.folder / f"{key}.npz"
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                about = json.loads(bytes(stored["about"]))
                if Asked(run).digests_of(about["asked"]) != about["asked"]:
                    return None
                arrays = {name: stored[name] for name in stored.files if name != "about"}
            truths = {
                name: Truth(
                    **{part: arrays[f"{at}.{part}"] for part in _PARTS if f"{at}.{part}" in arrays},
                    tolerance=about["tolerances"][name],
                )
                for at, name in enumerate(about["measures"])
            }
            os.utime(path)  # the least recently used are given up first
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, RuntimeError):
            with suppress(OSError):
                path.unlink(missing_ok=True)
            return None
        return CachedTruths(truths, float(about["seconds"]))

    def _store(self, key: str, made: CachedTruths, asked: Mapping[str, str]) -> None:
        arrays: dict[str, Any] = {}
        for at, truth in enumerate(made.truths.values()):
            for part in _PARTS:
                if getattr(truth, part) is not None:
                    arrays[f"{at}.{part}"] = np.asarray(getattr(truth, part))
        if sum(array.nbytes for array in arrays.values()) > self.limit:
            return
        about = {
            "measures": list(made.truths),
            "tolerances": {name: truth.tolerance for name, truth in made.truths.items()},
            "seconds": made.seconds,
            "asked": asked,
        }
        arrays["about"] = np.frombuffer(json.dumps(about).encode(), np.uint8)
        with suppress(RenderGraphError, OSError, ValueError):  # no room, no permission: computed again next time
            with whole_file(self.folder / f"{key}.npz") as temporary:
                np.savez(temporary, **arrays)
            evict(self.folder, self.limit)


def open_cache(limit: int = LIMIT) -> TruthCache | None:
    """The user's cache; None where its place is not known, see :func:`~rendergraph.measure.truth.cache_folder`."""
    folder = cache_folder()
    return TruthCache(folder, limit) if folder is not None else None


def compute_timed(compute: Callable[[PassRun], Mapping[str, Truth]], run: PassRun) -> CachedTruths:
    """Compute truths and take the time."""
    start = time.perf_counter()
    truths = compute(run)
    return CachedTruths(truths, time.perf_counter() - start)


@dataclass(slots=True)
class Asked:
    """What a reference asked of a run beyond what it was given: outputs by port, and supersampled inputs."""

    run: PassRun
    names: set[str] = field(default_factory=set)

    def watched(self) -> PassRun:
        """The run, noting what is asked."""
        original = self.run.supersampled

        def supersampled(port: str, factor: int) -> Any:
            assert original is not None
            self.names.add(f"supersampled:{port}:{factor}")
            return original(port, factor)

        noting: dict[str, Any] = {kind: _Noting(getattr(self.run, kind), kind, self.names.add) for kind in _RESULTS}
        return replace(self.run, **noting, supersampled=supersampled if original is not None else None)

    def digests(self) -> dict[str, str]:
        """What was asked, each with the hash of the answer."""
        return {name: self._answer(name) for name in sorted(self.names)}

    def digests_of(self, names: Mapping[str, str]) -> dict[str, str]:
        """The hashes of these answers on this run. Raises ``KeyError`` for what this run cannot answer."""
        return {name: self._answer(name) for name in names}

    def _answer(self, name: str) -> str:
        kind, port, *factor = name.split(":")
        if kind in _RESULTS:
            return fingerprint(getattr(self.run, kind)[port])
        if self.run.supersampled is None:
            raise KeyError(name)
        # What it would render is known by what it is rendered from, where the caller says: rendering it costs more
        # than most references.
        content = getattr(self.run.supersampled, "content", None)
        return content if content is not None else fingerprint(self.run.supersampled(port, int(factor[0])))


def _named_files(run: PassRun) -> dict[str, str]:
    """The content of the files that a pass's parameters name, and of Python beside them that tells their truth."""
    if run.folder is None:
        return {}
    named = [run.folder / value for _, value in run.params if isinstance(value, str)]
    paths = [*named, *(path.with_name(f"{path.stem}_reference.py") for path in named if path.name)]
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths if path.is_file()}


class _Noting(Mapping[str, Any]):
    """A mapping that tells what is read from it."""

    def __init__(self, inside: Mapping[str, Any], kind: str, note: Callable[[str], None]) -> None:
        self._inside = inside
        self._kind = kind
        self._note = note

    def __getitem__(self, key: str) -> Any:
        found = self._inside[key]
        self._note(f"{self._kind}:{key}")
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._inside)

    def __len__(self) -> int:
        return len(self._inside)
