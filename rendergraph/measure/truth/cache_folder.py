"""The folder of cached truths: where it is, how large it may grow, and what is given up when it is full."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path
from typing import Final

VARIABLE: Final = "RENDERGRAPH_CACHE"
#: Bytes of all entries together.
LIMIT: Final = 2 << 30
_ABANDONED_S: Final = 3600.0  # a temporary file as old as this belongs to a process that was killed


def cache_folder() -> Path | None:
    """``$RENDERGRAPH_CACHE``, else the user's cache folder; None where neither is known: without the variable that
    takes platformdirs, of the extra ``reference``.
    """
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named) / "truth"
    try:
        from platformdirs import user_cache_path
    except ImportError:
        return None
    return Path(user_cache_path("rendergraph")) / "truth"


def folder_bytes(folder: Path) -> int:
    """Bytes of all entries; 0 for a folder that is not there."""
    return sum(size for _, size, _ in _entries(folder))


def evict(folder: Path, limit: int) -> None:
    """Delete the least recently used entries until the rest takes at most ``limit`` bytes, and what killed processes
    left behind. Others may do the same at the same time.
    """
    entries = sorted(_entries(folder))
    total = sum(size for _, size, _ in entries)
    for _, size, path in entries:
        if total <= limit:
            break
        _delete(path)
        total -= size
    for path in _listed(folder, ".*.npz"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > _ABANDONED_S:
                _delete(path)


def _entries(folder: Path) -> list[tuple[float, int, Path]]:
    """When each entry was last used, its bytes and its path."""
    found = []
    for path in _listed(folder, "[!.]*.npz"):
        with suppress(OSError):  # another process evicted it meanwhile
            facts = path.stat()
            found.append((facts.st_mtime, facts.st_size, path))
    return found


def _listed(folder: Path, pattern: str) -> list[Path]:
    try:
        return list(folder.glob(pattern))
    except OSError:
        return []


def _delete(path: Path) -> None:
    with suppress(OSError):
        path.unlink(missing_ok=True)
