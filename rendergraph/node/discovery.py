"""Finds nodes: every folder of ``rendergraph.nodes``, and other packages' through the entry-point group."""

from __future__ import annotations

import importlib
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from rendergraph.node.contract import Node

ENTRY_POINTS = "rendergraph.nodes"


def node_folder() -> Path:
    """The folder whose sub-folders are the shipped nodes."""
    return Path(__file__).resolve().parent.parent / "nodes"


@cache
def node_names() -> tuple[str, ...]:
    """All node names, sorted: shipped ones and those of installed packages. Imports none of them."""
    shipped = {p.parent.name for p in node_folder().glob("*/__init__.py")}
    return tuple(sorted(shipped | {e.name for e in entry_points(group=ENTRY_POINTS)}))


@cache
def try_node(name: str) -> type[Node[Any]] | str:
    """The node class, or why there is none: other people's packages may fail in any way when imported."""
    try:
        return find_node(name)
    except Exception as error:
        return f"{type(error).__name__}: {error}"


@cache
def find_node(name: str) -> type[Node[Any]]:
    """The node class of that name.

    Raises ``KeyError`` for an unknown name, ``TypeError`` when the package defines no single ``Node`` subclass.
    """
    if (node_folder() / name / "__init__.py").is_file():
        module_name = f"rendergraph.nodes.{name}"
    else:
        matches = [e for e in entry_points(group=ENTRY_POINTS) if e.name == name]
        if not matches:
            raise KeyError(name)
        module_name = matches[0].module
    module = importlib.import_module(module_name)
    classes = [
        value for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Node) and value is not Node and value.__module__ == module_name
    ]  # fmt: skip
    if len(classes) != 1:
        raise TypeError(f"{module_name} must define exactly one Node, found {len(classes)}")
    found = classes[0]
    found.name = name
    found.folder = Path(module.__file__ or "").resolve().parent
    return found
