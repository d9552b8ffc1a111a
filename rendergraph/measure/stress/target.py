"""What `rg stress` is asked to try: a graph with all its passes, or a node on its own graph."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rendergraph.document.load import Document, load_document, shipped_graphs
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.source_file import find_graph, graph_folder
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.discovery import find_node, node_names

#: Targets of a fixed size are shrunk to this many texels a side: what goes wrong at an extreme does so in small ones.
MOST_FIXED = 256
#: The frame, likewise.
MOST_FRAME = 48
MOST_FRAMES = 2


@dataclass(frozen=True, slots=True)
class StressTarget:
    """``file`` is the graph's; ``node`` is set where one node alone is reported on; ``own`` are the nodes whose own
    graph this is, whose declared extremes fit it.
    """

    file: Path
    node: str = ""
    own: tuple[str, ...] = ()


def find_target(name: str) -> StressTarget:
    """A node's name, a graph file, or a shipped graph's name; a name that is both means the node.

    :raises RenderGraphError: RG768 for a name that is none of them, RG771 for a node without a graph.
    """
    if name in node_names():
        return StressTarget(_graph_of(name), name, (name,))
    file = find_graph(name)
    bare = Path(name).name == name and not Path(name).suffix
    if bare and not file.exists():
        choices = sorted({*node_names(), *shipped_graphs()})
        raise RenderGraphError([diagnose("RG768", name=name, hint=did_you_mean(name, choices))], exit_code=2)
    own = tuple(node for node in node_names() if _own_graph(node) == file.resolve())
    return StressTarget(file, "", own)


def _graph_of(node: str) -> Path:
    file = _own_graph(node)
    if file is None:
        raise RenderGraphError([diagnose("RG771", name=node)], exit_code=2)
    return file


def _own_graph(node: str) -> Path | None:
    """The graph shipped under the node's name, else one beside the node (``example.yaml``, ``NODE.yaml``)."""
    shipped = graph_folder() / f"{node}.yaml"
    if shipped.is_file():
        return shipped.resolve()
    try:
        folder = find_node(node).folder
    except Exception:  # other people's packages may fail in any way when imported
        return None
    beside = (folder / "example.yaml", folder / f"{node}.yaml", folder / "graphs" / f"{node}.yaml")
    for file in (*beside, folder.parent / "graphs" / f"{node}.yaml", folder.parent / "example.yaml"):
        if file.is_file():
            return file.resolve()
    return None


def load_target(target: StressTarget, overrides: tuple[str, ...] = ()) -> Document:
    """The target's document, made small: procedural scenes at their least detail, targets of a fixed size shrunk.
    ``overrides`` are ``--set`` arguments, which win.
    """
    document = load_document(target.file, overrides)
    return load_document(target.file, (*_shrunk(document), *overrides))


def _shrunk(document: Document) -> list[str]:
    found = []
    if document.model.scene is not None and "detail" not in document.model.scene.model_fields_set:
        found.append("scene.detail=0")
    for name, resource in document.model.resources.items():
        if resource.fixed is not None and max(resource.fixed) > MOST_FIXED:
            width, height = (min(side, MOST_FIXED) for side in resource.fixed)
            found.append(f"resources.{name}.fixed=[{width}, {height}]")
    return found


def frame_size(document: Document) -> tuple[int, int]:
    """The frame's size, made small in its proportion."""
    width, height = document.model.frame.size
    factor = min(1.0, MOST_FRAME / max(width, height))
    return max(1, round(width * factor)), max(1, round(height * factor))
