"""The node hierarchy: local and world transforms, and the nodes of the default scene (glTF 2.0, 3.5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rendergraph.scene.gltf.accessors import MAX_MAGNITUDE
from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.scene import F64, Node


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """All nodes, their world transforms (float64[4, 4] each), and which the default scene shows, in traversal order."""

    nodes: list[Node]
    worlds: list[F64]
    visible: list[int]


def read_hierarchy(document: Document) -> Hierarchy:
    """``RenderGraphError`` RG615 for several parents or a cycle, RG610 for transforms that overflow."""
    items = document.arrays["nodes"]
    children = [_unique([document.as_index(c, "nodes") for c in item.elements("children")], item) for item in items]
    parents = [-1] * len(items)
    for parent, below in enumerate(children):
        for child in below:
            if parents[child] != -1:
                reason = f"it has two parents, /nodes/{parents[child]} and /nodes/{parent}"
                raise gltf_error("RG615", str(items[child]), reason=reason)
            parents[child] = parent
    nodes = [_node(item, parent) for item, parent in zip(items, parents, strict=True)]
    roots = [index for index, parent in enumerate(parents) if parent == -1]
    order = _descend(roots, children)
    if len(order) < len(items):
        lost = min(set(range(len(items))) - set(order))
        raise gltf_error("RG615", str(items[lost]), reason="it is its own ancestor")
    worlds = [node.local for node in nodes]
    with np.errstate(over="ignore", invalid="ignore"):
        for index in order:
            if parents[index] != -1:
                worlds[index] = worlds[parents[index]] @ nodes[index].local
            if not np.abs(worlds[index]).max() < MAX_MAGNITUDE:
                value = float(np.abs(worlds[index]).max())
                raise gltf_error(
                    "RG610", str(items[index]), element="world transform", value=value, limit=MAX_MAGNITUDE
                )
    return Hierarchy(nodes, worlds, _visible(document, roots, children))


def _visible(document: Document, roots: list[int], children: list[list[int]]) -> list[int]:
    scenes = document.arrays["scenes"]
    shown = document.index(document.root, "scene", "scenes")
    if not scenes:
        return _descend(roots, children)  # a library of meshes without a scene: show everything
    if len(scenes) > 1:
        document.note(f"the file has {len(scenes)} scenes; only /scenes/{shown or 0} is shown")
    scene = scenes[shown or 0]
    return _descend(_unique([document.as_index(n, "nodes") for n in scene.elements("nodes")], scene), children)


def _unique(indices: list[int], owner: Item) -> list[int]:
    if len(set(indices)) != len(indices):
        raise gltf_error("RG615", str(owner), reason="it names a node twice")
    return indices


def _descend(roots: list[int], children: list[list[int]]) -> list[int]:
    """Depth first, parents before children, each node once; a loop, since files can be deeper than Python's stack."""
    order: dict[int, None] = {}
    stack = roots[::-1]
    while stack:
        index = stack.pop()
        if index not in order:
            order[index] = None
            stack.extend(reversed(children[index]))
    return list(order)


def _node(item: Item, parent: int) -> Node:
    name = item.text("name")
    matrix = item.get("matrix")
    if matrix is not None:
        local = np.array(matrix.as_numbers(16)).reshape(4, 4).T
        if not np.allclose(local[3], (0.0, 0.0, 0.0, 1.0), atol=1e-6):
            raise matrix.wrong("an affine matrix, whose last row is 0 0 0 1")
        return Node(name, parent, local)
    tx, ty, tz = item.numbers("translation", (0.0, 0.0, 0.0))
    sx, sy, sz = item.numbers("scale", (1.0, 1.0, 1.0))
    quaternion = np.array(item.numbers("rotation", (0.0, 0.0, 0.0, 1.0), -1e9, 1e9))
    length = float(np.linalg.norm(quaternion))
    if length < 1e-9:
        raise item.require("rotation").wrong("a unit quaternion")
    x, y, z, w = (float(v) for v in quaternion / length)
    local = np.eye(4)
    local[:3, :3] = rotation_matrix(x, y, z, w) * (sx, sy, sz)
    local[:3, 3] = (tx, ty, tz)
    return Node(name, parent, local, (tx, ty, tz), (x, y, z, w), (sx, sy, sz))


def rotation_matrix(x: float, y: float, z: float, w: float) -> F64:
    """The rotation of a unit quaternion, ``float64[3, 3]``."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
