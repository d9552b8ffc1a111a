"""Layered layout of a directed acyclic graph: columns by longest path, rows by barycentres, long edges through lanes.

After Sugiyama, Tagawa and Toda, "Methods for Visual Understanding of Hierarchical System Structures", 1981.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise

_SWEEPS = 12
_RELAXATIONS = 40
_LANE_HEIGHT = 8.0


@dataclass(frozen=True, slots=True)
class Box:
    """A placed node: left, top, width and height."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Boxes by name, the points each edge runs through, and the size of the picture."""

    boxes: dict[str, Box]
    routes: dict[tuple[str, str], tuple[tuple[float, float], ...]]
    width: float
    height: float


def lay_out(
    sizes: Mapping[str, tuple[float, float]],
    edges: Iterable[tuple[str, str]],
    *,
    column_gap: float = 36,
    row_gap: float = 12,
    margin: float = 24,
) -> Layout:
    """Place nodes of the given sizes; ``sizes`` lists them so that every edge points forward."""
    edges = list(dict.fromkeys(edges))
    columns = _columns(list(sizes), edges)
    nodes = dict(sizes)
    chains = {edge: _chain(edge, columns, nodes) for edge in edges}
    links = [pair for chain in chains.values() for pair in pairwise(chain)]
    rows = _rows(columns, links)
    tops = _tops(rows, nodes, links, row_gap)
    lift = margin - min(tops.values(), default=0.0)
    boxes: dict[str, Box] = {}
    x = margin
    for column in rows:
        width = max(nodes[name][0] for name in column)
        for name in column:
            own = nodes[name][0]
            boxes[name] = Box(x + (width - own) / 2, tops[name] + lift, own, nodes[name][1])
        x += width + column_gap
    routes = {edge: _route([boxes[name] for name in chain]) for edge, chain in chains.items()}
    height = max((box.y + box.height for box in boxes.values()), default=0.0) + margin
    return Layout({name: boxes[name] for name in sizes}, routes, x - column_gap + margin, height)


def _columns(names: list[str], edges: list[tuple[str, str]]) -> dict[str, int]:
    into: dict[str, list[str]] = {}
    for source, target in edges:
        into.setdefault(target, []).append(source)
    columns: dict[str, int] = {}
    for name in names:
        columns[name] = max((columns[source] + 1 for source in into.get(name, ())), default=0)
    return columns


def _chain(edge: tuple[str, str], columns: dict[str, int], nodes: dict[str, tuple[float, float]]) -> list[str]:
    """The edge's ends with a lane in each column between them; lanes are nodes without width."""
    source, target = edge
    chain = [source]
    for column in range(columns[source] + 1, columns[target]):
        lane = f"{source} → {target} @{column}"
        columns[lane] = column
        nodes[lane] = (0.0, _LANE_HEIGHT)
        chain.append(lane)
    return [*chain, target]


def _rows(columns: dict[str, int], links: list[tuple[str, str]]) -> list[list[str]]:
    rows: list[list[str]] = [[] for _ in range(max(columns.values(), default=-1) + 1)]
    for name, column in columns.items():
        rows[column].append(name)
    before: dict[str, list[str]] = {}
    after: dict[str, list[str]] = {}
    for source, target in links:
        before.setdefault(target, []).append(source)
        after.setdefault(source, []).append(target)
    for sweep in range(_SWEEPS):
        forward = sweep % 2 == 0
        neighbours = before if forward else after
        for row in rows if forward else rows[::-1]:
            place = {name: index for line in rows for index, name in enumerate(line)}
            row.sort(key=lambda name: (_mean([place[n] for n in neighbours.get(name, ())], place[name]), place[name]))
    return rows


def _mean(values: list[int], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def _tops(
    rows: list[list[str]], nodes: dict[str, tuple[float, float]], links: list[tuple[str, str]], gap: float
) -> dict[str, float]:
    """Tops that pull each node towards its neighbours' centres, keeping the rows' order and gaps."""
    near: dict[str, list[str]] = {}
    for source, target in links:
        near.setdefault(source, []).append(target)
        near.setdefault(target, []).append(source)
    centre: dict[str, float] = {}
    for column in rows:
        at = 0.0
        for name in column:
            centre[name] = at + nodes[name][1] / 2
            at += nodes[name][1] + gap
    for _ in range(_RELAXATIONS):
        for column in rows:
            wanted = [
                sum(centre[n] for n in near[name]) / len(near[name]) if name in near else centre[name]
                for name in column
            ]
            for name, value in zip(column, _separated(column, wanted, nodes, gap), strict=True):
                centre[name] = value
    return {name: value - nodes[name][1] / 2 for name, value in centre.items()}


def _separated(
    column: list[str], wanted: list[float], nodes: dict[str, tuple[float, float]], gap: float
) -> list[float]:
    """Centres near those wanted that do not overlap: pushed down from the top and up from the bottom, averaged."""
    need = [(nodes[a][1] + nodes[b][1]) / 2 + gap for a, b in pairwise(column)]
    down, up = list(wanted), list(wanted)
    for index, distance in enumerate(need):
        down[index + 1] = max(down[index + 1], down[index] + distance)
    for index in range(len(need) - 1, -1, -1):
        up[index] = min(up[index], up[index + 1] - need[index])
    return [(a + b) / 2 for a, b in zip(down, up, strict=True)]


def _route(boxes: list[Box]) -> tuple[tuple[float, float], ...]:
    first, *lanes, last = boxes
    points = [(first.x + first.width, first.y + first.height / 2)]
    points += [(lane.x, lane.y + lane.height / 2) for lane in lanes]
    return (*points, (last.x, last.y + last.height / 2))
