"""Node packages made for one test, found as other people's are: by entry points."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from rendergraph.measure.truth.fingerprint import _file_of, source_fingerprint
from rendergraph.node import discovery
from rendergraph.node.discovery import ENTRY_POINTS, find_node, node_names, try_node

Install = Callable[..., Path]
_CACHES = (node_names, find_node, try_node, source_fingerprint, _file_of)


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """``install(name, {file: text})`` makes the node ``name`` of a package ``judged_name``; its folder."""
    root = tmp_path / "packages"
    root.mkdir()
    entries: list[EntryPoint] = []
    monkeypatch.setattr(discovery, "entry_points", lambda group: entries if group == ENTRY_POINTS else [])
    monkeypatch.syspath_prepend(str(root))

    def forget() -> None:
        for cached in _CACHES:
            cached.cache_clear()
        for module in [m for m in sys.modules if m.startswith("judged_")]:
            del sys.modules[module]
        importlib.invalidate_caches()

    def make(name: str, files: Mapping[str, str]) -> Path:
        folder = root / f"judged_{name}"
        folder.mkdir(exist_ok=True)
        for file, text in files.items():
            (folder / file).write_text(text)
        if all(entry.name != name for entry in entries):
            entries.append(EntryPoint(name, f"judged_{name}", ENTRY_POINTS))
        forget()
        return folder

    forget()
    yield make
    forget()
