"""A plan's graph drawn: Mermaid and DOT text, and a layered SVG of our own (no layout program needed).

Passes are boxes in columns by their depth in the graph; an edge is a resource, from who writes it to who reads it next.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape

from rendergraph.plan.plan import Plan


@dataclass(frozen=True, slots=True)
class Edge:
    """``resource`` flows from node ``source`` to ``target``; ``history`` when it comes from the last frame."""

    source: str
    target: str
    resource: str
    history: bool = False


@dataclass(frozen=True, slots=True)
class Drawing:
    """Nodes in execution order with a second line of text, edges, and which nodes write outputs."""

    title: str
    nodes: dict[str, str]
    edges: tuple[Edge, ...]
    outputs: dict[str, tuple[str, ...]]  # node -> output resources


def draw_graph(plan: Plan, form: str, *, subpasses: bool = False) -> str:
    """The plan's graph as ``mermaid``, ``dot`` or ``svg`` text; passes, or ``subpasses``."""
    forms: dict[str, Callable[[Drawing], str]] = {"mermaid": mermaid, "dot": dot, "svg": svg}
    return forms[form](drawing(plan, subpasses=subpasses))


def drawing(plan: Plan, *, subpasses: bool = False) -> Drawing:
    """Nodes and edges from the accesses in plan order: a read joins to the last writer before it."""
    nodes: dict[str, str] = {}
    writer: dict[str, str] = {}
    edges: dict[Edge, None] = {}
    final: dict[str, str] = {}
    late: list[tuple[str, str, str]] = []
    for subpass in plan.order:
        node = subpass.name if subpasses else subpass.parent
        nodes.setdefault(node, type(subpass.work).__name__ if subpasses else plan.graph.passes[subpass.parent].node)
        for access in subpass.accesses:
            name = access.resource
            source = plan.graph.resources[name].previous_of
            if source is not None:
                late.append((source, node, name))
            elif access.load and name in writer and writer[name] != node:
                edges[Edge(writer[name], node, name)] = None
        for access in subpass.accesses:
            if access.usage.writes:
                writer[access.resource] = node
                final[access.resource] = node
    for source, node, name in late:
        if source in final:
            edges[Edge(final[source], node, name, history=True)] = None
    outputs: dict[str, tuple[str, ...]] = {}
    for name in plan.graph.outputs:
        if name in final:
            outputs[final[name]] = (*outputs.get(final[name], ()), name)
    return Drawing("", nodes, tuple(edges), outputs)


def mermaid(graph: Drawing) -> str:
    """Mermaid flowchart text."""
    ids = {name: f"n{index}" for index, name in enumerate(graph.nodes)}
    lines = ["flowchart LR"]
    lines += [f'    {ids[name]}["{name}<br/><i>{text}</i>"]' for name, text in graph.nodes.items()]
    for edge in graph.edges:
        arrow = "-. " if edge.history else "-- "
        end = " .->" if edge.history else " -->"
        lines.append(f"    {ids[edge.source]} {arrow}{edge.resource}{end} {ids[edge.target]}")
    for node, names in graph.outputs.items():
        for name in names:
            lines.append(f"    {ids[node]} --> out_{name.replace('.', '_')}([{name}])")
    return "\n".join(lines)


def dot(graph: Drawing) -> str:
    """Graphviz DOT text."""
    lines = ["digraph rendergraph {", "    rankdir=LR;", '    node [shape=box, fontname="sans-serif"];']
    lines += [f'    "{name}" [label="{name}\\n{text}"];' for name, text in graph.nodes.items()]
    for edge in graph.edges:
        style = ", style=dashed, constraint=false" if edge.history else ""
        lines.append(f'    "{edge.source}" -> "{edge.target}" [label="{edge.resource}"{style}];')
    for node, names in graph.outputs.items():
        for name in names:
            lines.append(f'    "output {name}" [label="{name}", shape=ellipse];')
            lines.append(f'    "{node}" -> "output {name}";')
    lines.append("}")
    return "\n".join(lines)


# ---------------------------------------------------------------- SVG

_BOX_HEIGHT = 44
_CHARACTER = 7.4
_COLUMN_GAP = 120
_ROW_GAP = 26
_MARGIN = 24


def svg(graph: Drawing) -> str:
    """One self-contained SVG, readable on light and dark grounds."""
    columns = _columns(graph)
    places, width, height = _places(graph, columns)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
        f'height="{height:.0f}" font-family="system-ui, sans-serif" font-size="13">',
        "<style>.box{fill:#eef3fb;stroke:#4a6fa5}.out{fill:#e6f4e6;stroke:#3f8f4f}.name{fill:#16243a;font-weight:600}"
        ".text{fill:#51627a;font-size:11px}.edge{fill:none;stroke:#7c8da5;stroke-width:1.4}"
        ".old{stroke-dasharray:5 4}.label{fill:#51627a;font-size:11px}.ground{fill:#ffffff}"
        "@media (prefers-color-scheme:dark){.ground{fill:#14181f}.box{fill:#22304a;stroke:#7fa4dc}"
        ".out{fill:#1f3a27;stroke:#74c487}.name{fill:#eef3fb}.text,.label{fill:#a9b8ce}.edge{stroke:#8fa2bd}}</style>",
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0L8 4L0 8z" fill="#7c8da5"/></marker></defs>',
        f'<rect class="ground" width="{width:.0f}" height="{height:.0f}"/>',
    ]
    parts += [_edge(edge, places) for edge in _merged(graph.edges)]
    for name, text in graph.nodes.items():
        x, y, box = places[name]
        kind = "box out" if name in graph.outputs else "box"
        second = f"{text} → {', '.join(graph.outputs[name])}" if name in graph.outputs else text
        parts.append(
            f'<g><rect class="{kind}" x="{x:.1f}" y="{y:.1f}" width="{box:.1f}" height="{_BOX_HEIGHT}" rx="6"/>'
            f'<text class="name" x="{x + 10:.1f}" y="{y + 18:.1f}">{escape(name)}</text>'
            f'<text class="text" x="{x + 10:.1f}" y="{y + 34:.1f}">{escape(second)}</text></g>'
        )
    parts.append("</svg>")
    return "\n".join(parts)


def _columns(graph: Drawing) -> dict[str, int]:
    """Longest path from a source; nodes come in execution order, so one sweep is enough."""
    columns = dict.fromkeys(graph.nodes, 0)
    into: dict[str, list[str]] = {}
    for edge in graph.edges:
        if not edge.history:
            into.setdefault(edge.target, []).append(edge.source)
    for name in graph.nodes:
        columns[name] = max((columns[s] + 1 for s in into.get(name, ())), default=0)
    return columns


def _places(
    graph: Drawing, columns: dict[str, int]
) -> tuple[dict[str, tuple[float, float, float]], float, float]:
    """Left, top and width of every box, and the size of the picture."""
    rows: dict[int, list[str]] = {}
    for name in graph.nodes:
        rows.setdefault(columns[name], []).append(name)
    most = max((len(r) for r in rows.values()), default=1)
    height = most * (_BOX_HEIGHT + _ROW_GAP) - _ROW_GAP + 2 * _MARGIN
    places: dict[str, tuple[float, float, float]] = {}
    x = float(_MARGIN)
    for column in sorted(rows):
        names = rows[column]
        box = max(_text_width(graph, n) for n in names)
        top = (height - (len(names) * (_BOX_HEIGHT + _ROW_GAP) - _ROW_GAP)) / 2
        for row, name in enumerate(names):
            places[name] = (x, top + row * (_BOX_HEIGHT + _ROW_GAP), box)
        x += box + _COLUMN_GAP
    return places, x - _COLUMN_GAP + _MARGIN, height + 30


def _text_width(graph: Drawing, name: str) -> float:
    second = graph.nodes[name] + ("  → " + ", ".join(graph.outputs[name]) if name in graph.outputs else "")
    return 20 + _CHARACTER * max(len(name), len(second) * 0.9)


def _merged(edges: tuple[Edge, ...]) -> list[Edge]:
    """Edges between the same two nodes as one, all resources on its label."""
    together: dict[tuple[str, str, bool], list[str]] = {}
    for edge in edges:
        together.setdefault((edge.source, edge.target, edge.history), []).append(edge.resource)
    return [Edge(s, t, ", ".join(names), old) for (s, t, old), names in together.items()]


def _edge(edge: Edge, places: dict[str, tuple[float, float, float]]) -> str:
    (x0, y0, w0), (x1, y1, _) = places[edge.source], places[edge.target]
    if edge.history or x1 <= x0:  # back in time: leave below, return below
        start, end = (x0 + w0 / 2, y0 + _BOX_HEIGHT), (x1 + 14, y1 + _BOX_HEIGHT)
        low = max(start[1], end[1]) + 34
        path = f"M{start[0]:.1f} {start[1]:.1f}C{start[0]:.1f} {low:.1f} {end[0]:.1f} {low:.1f} {end[0]:.1f} {end[1]:.1f}"
        at = ((start[0] + end[0]) / 2, low - 6)
    else:
        start, end = (x0 + w0, y0 + _BOX_HEIGHT / 2), (x1, y1 + _BOX_HEIGHT / 2)
        bend = max(40.0, (end[0] - start[0]) / 2)
        path = (
            f"M{start[0]:.1f} {start[1]:.1f}C{start[0] + bend:.1f} {start[1]:.1f} "
            f"{end[0] - bend:.1f} {end[1]:.1f} {end[0] - 2:.1f} {end[1]:.1f}"
        )
        # Near the reader, whose inputs are what one looks for; the middle is where edges cross.
        at = (end[0] - 0.3 * (end[0] - start[0]), end[1] - 0.3 * (end[1] - start[1]) * 0.4 - 5)
    old = " old" if edge.history else ""
    return (
        f'<path class="edge{old}" d="{path}" marker-end="url(#tip)"/>'
        f'<text class="label" x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="middle">{escape(edge.resource)}</text>'
    )
