"""Nodes are found by their folder's name, or by another package's entry point; anything else is refused."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from rendergraph.node import discovery
from rendergraph.node.contract import Node
from rendergraph.node.discovery import ENTRY_POINTS, find_node, node_folder, node_names, try_node
from rendergraph.node.params import Params

ONE = '''
from rendergraph.node import Node, Params

class {name}(Node[Params]):
    """Does nothing."""

    def build(self, b):
        pass
'''


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The ``__init__.py`` of a package that offers the node ``guest``."""
    folder = tmp_path / "guest_package"
    folder.mkdir()
    entry = EntryPoint("guest", "guest_package", ENTRY_POINTS)
    monkeypatch.setattr(discovery, "entry_points", lambda group: [entry] if group == ENTRY_POINTS else [])
    monkeypatch.syspath_prepend(str(tmp_path))
    caches = (node_names, find_node, try_node)
    for cached in caches:
        cached.cache_clear()
    yield folder / "__init__.py"
    for cached in caches:
        cached.cache_clear()
    sys.modules.pop("guest_package", None)


def test_shipped_nodes_are_the_folders() -> None:
    folders = {path.name for path in node_folder().iterdir() if (path / "__init__.py").is_file()}
    assert {"gbuffer", "tonemap", "fullscreen"} <= folders
    assert folders <= set(node_names())
    assert list(node_names()) == sorted(node_names())


@pytest.mark.parametrize("name", sorted(path.parent.name for path in node_folder().glob("*/__init__.py")))
def test_a_shipped_node_knows_its_name_and_folder(name: str) -> None:
    found = find_node(name)
    assert issubclass(found, Node)
    assert found.name == name
    assert found.folder == (node_folder() / name).resolve()
    assert found.summary()
    assert issubclass(found.params_type, Params)


def test_an_unknown_name() -> None:
    with pytest.raises(KeyError):
        find_node("no_such_node")
    reason = try_node("no_such_node")
    assert isinstance(reason, str)
    assert "KeyError" in reason


def test_a_node_of_another_package(package: Path) -> None:
    package.write_text(ONE.format(name="Guest"))
    assert "guest" in node_names()
    found = find_node("guest")
    assert (found.__name__, found.name, found.folder) == ("Guest", "guest", package.parent.resolve())
    assert try_node("guest") is found


@pytest.mark.parametrize(
    "text", ["", ONE.format(name="One") + ONE.format(name="Two"), "from rendergraph.node import Node"]
)
def test_a_package_must_define_one_node(package: Path, text: str) -> None:
    package.write_text(text)
    with pytest.raises(TypeError):
        find_node("guest")


def test_a_package_that_fails_is_told_apart(package: Path) -> None:
    package.write_text("raise OSError('no licence')")
    assert "guest" in node_names(), "names are listed without importing anything"
    reason = try_node("guest")
    assert isinstance(reason, str)
    assert "no licence" in reason
