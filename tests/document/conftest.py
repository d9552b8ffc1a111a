"""Graph files written on the spot, over the nodes of ``sample_graph``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from sample_graph import Fail, Load, find_node

from rendergraph.document import node_checks
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.node import discovery


@pytest.fixture
def made_nodes(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The nodes above in place of the shipped ones."""
    monkeypatch.setattr(discovery, "find_node", find_node)
    monkeypatch.setattr(node_checks, "node_names", lambda: ("blur", "broken", "open"))
    discovery.try_node.cache_clear()
    yield
    discovery.try_node.cache_clear()


@pytest.fixture
def load(tmp_path: Path, made_nodes: None) -> Load:
    """``load(text, *overrides)`` writes a graph file and loads it."""

    def loaded(text: str | bytes, *overrides: str) -> Document:
        path = tmp_path / "graph.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
        return load_document(path, overrides)

    return loaded


@pytest.fixture
def fail(load: Load) -> Fail:
    """``fail(text, *overrides)`` gives the diagnostics of a graph that does not load."""

    def failed(text: str | bytes, *overrides: str) -> list[Diagnostic]:
        with pytest.raises(RenderGraphError) as error:
            load(text, *overrides)
        return list(error.value.diagnostics)

    return failed
