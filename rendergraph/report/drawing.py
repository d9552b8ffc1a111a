"""A plan's graph drawn: Mermaid and DOT text, and an SVG of our own (no layout program needed).

Passes are boxes; every content a resource has in the frame is a pill between who writes it and who reads it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from rendergraph.plan.plan import Plan
from rendergraph.report.layered import Box, Layout, lay_out


@dataclass(frozen=True, slots=True)
class Content:
    """One content of a resource, written by pass ``writer`` (``None``: a file's, or the last frame's)."""

    key: str
    resource: str
    writer: str | None
    readers: tuple[str, ...]
    kind: str  # "resource" | "output" | "history" | "imported"


@dataclass(frozen=True, slots=True)
class Drawing:
    """Passes (or sub-passes) in execution order with a second line of text, contents, and (history, source) pairs."""

    nodes: dict[str, str]
    contents: tuple[Content, ...]
    history: tuple[tuple[str, str], ...]


def draw_graph(plan: Plan, form: str, *, subpasses: bool = False) -> str:
    """The plan's graph as ``mermaid``, ``dot`` or ``svg`` text; passes, or ``subpasses``."""
    forms: dict[str, Callable[[Drawing], str]] = {"mermaid": mermaid, "dot": dot, "svg": svg}
    return forms[form](drawing(plan, subpasses=subpasses))


def drawing(plan: Plan, *, subpasses: bool = False) -> Drawing:
    """Nodes and contents from the accesses in plan order: a read takes the last content before it."""
    nodes: dict[str, str] = {}
    latest: dict[str, list[str | None]] = {}  # resource -> writer then readers of its newest content
    done: list[tuple[str, list[str | None]]] = []
    for subpass in plan.order:
        node = subpass.name if subpasses else subpass.parent
        nodes.setdefault(node, type(subpass.work).__name__ if subpasses else plan.graph.passes[subpass.parent].node)
        for access in subpass.accesses:
            known = latest.get(access.resource)
            if access.load and (known is None or known[0] != node):
                if known is None:
                    known = latest[access.resource] = [None]
                    done.append((access.resource, known))
                if node not in known[1:]:
                    known.append(node)
        for access in subpass.accesses:
            known = latest.get(access.resource)
            if access.usage.writes and (known is None or known[0] != node):
                latest[access.resource] = [node]
                done.append((access.resource, latest[access.resource]))
    contents = []
    newest: dict[str, str] = {}
    for number, (name, (writer, *readers)) in enumerate(done):
        resource = plan.graph.resources[name]
        final = latest[name] is done[number][1]
        kind = "output" if final and name in plan.graph.outputs else resource.kind.value
        kind = kind if kind in ("output", "history", "imported") else "resource"
        key = f"r{number}"
        newest[name] = key
        contents.append(Content(key, name, writer, tuple(r for r in readers if r is not None), kind))
    history = tuple(
        (newest[source], newest[name])
        for name, source in ((n, plan.graph.resources[n].previous_of) for n in newest)
        if source in newest
    )
    kept = {key for pair in history for key in pair}
    # What nobody else reads is a node's own business, unless it leaves the frame.
    shown = tuple(c for c in contents if c.readers or c.kind != "resource" or c.key in kept)
    return Drawing(nodes, shown, history)


def mermaid(graph: Drawing) -> str:
    """Mermaid flowchart text."""
    ids = {name: f"n{index}" for index, name in enumerate(graph.nodes)}
    lines = ["flowchart LR"]
    lines += [f'    {ids[name]}["{name}<br/><i>{text}</i>"]' for name, text in graph.nodes.items()]
    for content in graph.contents:
        lines.append(f"    {content.key}([{content.resource}])")
        if content.writer is not None:
            lines.append(f"    {ids[content.writer]} --> {content.key}")
        lines += [f"    {content.key} --> {ids[reader]}" for reader in content.readers]
    lines += [f"    {source} -. next frame .-> {target}" for source, target in graph.history]
    return "\n".join(lines)


def dot(graph: Drawing) -> str:
    """Graphviz DOT text."""
    lines = ["digraph rendergraph {", "    rankdir=LR;", '    node [fontname="sans-serif"];']
    lines += [f'    "{name}" [shape=box, label="{name}\\n{text}"];' for name, text in graph.nodes.items()]
    for content in graph.contents:
        lines.append(f'    {content.key} [shape=ellipse, label="{content.resource}"];')
        if content.writer is not None:
            lines.append(f'    "{content.writer}" -> {content.key};')
        lines += [f'    {content.key} -> "{reader}";' for reader in content.readers]
    lines += [
        f'    {source} -> {target} [style=dashed, constraint=false, label="next frame"];'
        for source, target in graph.history
    ]
    lines.append("}")
    return "\n".join(lines)


# ---------------------------------------------------------------- SVG

_PASS_HEIGHT = 44.0
_PILL_HEIGHT = 22.0
_NAME_WIDTH = 7.8  # of a character of a pass's name, 13 px semibold
_TEXT_WIDTH = 6.3  # of the small text, 11 px

_STYLE = (
    ".pass{fill:#eef3fb;stroke:#4a6fa5}.resource{fill:#f6f3ea;stroke:#b9a878}.output{fill:#e6f4e6;stroke:#3f8f4f}"
    ".history,.imported{fill:#f3ebf7;stroke:#8a63a8}.name{fill:#16243a;font-weight:600}.text{fill:#51627a;font-size:11px}"
    ".edge{fill:none;stroke:#7c8da5;stroke-width:1.3}.old{stroke:#8a63a8;stroke-dasharray:5 4}.ground{fill:#ffffff}"
    "@media (prefers-color-scheme:dark){.ground{fill:#14181f}.pass{fill:#22304a;stroke:#7fa4dc}"
    ".resource{fill:#332f24;stroke:#a8986a}.output{fill:#1f3a27;stroke:#74c487}"
    ".history,.imported{fill:#33263c;stroke:#b793d1}.name{fill:#eef3fb}.text{fill:#b9c6d9}.edge{stroke:#8fa2bd}}"
)


def place(graph: Drawing) -> Layout:
    """Where everything goes: boxes of passes by ``pass NAME``, of contents by their key, in SVG's pixels."""
    sizes: dict[str, tuple[float, float]] = {}
    edges: list[tuple[str, str]] = []
    for content in graph.contents:
        if content.writer is None:
            sizes[content.key] = _pill(content)
    for name, text in graph.nodes.items():
        sizes[f"pass {name}"] = (24 + max(_NAME_WIDTH * len(name), _TEXT_WIDTH * len(text)), _PASS_HEIGHT)
        for content in graph.contents:
            if content.writer == name:
                sizes[content.key] = _pill(content)
    for content in graph.contents:
        if content.writer is not None:
            edges.append((f"pass {content.writer}", content.key))
        edges += [(content.key, f"pass {reader}") for reader in content.readers]
    return lay_out(sizes, edges)


def svg(graph: Drawing, link: Callable[[str, str], str] | None = None) -> str:
    """One self-contained SVG, readable on light and dark grounds. ``link(kind, name)`` gives where a ``"pass"`` or a
    ``"resource"`` leads when it is clicked; empty for nowhere.
    """
    layout = place(graph)
    below = 40 if graph.history else 0
    width, height = f"{layout.width:.0f}", f"{layout.height + below:.0f}"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="system-ui, sans-serif" font-size="13">',
        f"<style>{_STYLE}</style>",
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0L8 4L0 8z" fill="#7c8da5"/></marker></defs>',
        f'<rect class="ground" width="{width}" height="{height}"/>',
    ]
    for (_, target), route in layout.routes.items():
        tip = ' marker-end="url(#tip)"' if target.startswith("pass ") else ""
        parts.append(f'<path class="edge" d="{_smooth(route)}"{tip}/>')
    parts += [_next_frame(layout.boxes[s], layout.boxes[t], layout.height + below - 16) for s, t in graph.history]
    for name, text in graph.nodes.items():
        box = layout.boxes[f"pass {name}"]
        shape = _rect(box, "pass", 6) + _text(box, 18, "name", name) + _text(box, 34, "text", text)
        parts.append(_linked(shape, link("pass", name) if link else ""))
    for content in graph.contents:
        box = layout.boxes[content.key]
        shape = _rect(box, content.kind, _PILL_HEIGHT / 2) + _text(box, 15, "text", content.resource)
        parts.append(_linked(shape, link("resource", content.resource) if link else ""))
    parts.append("</svg>")
    return "\n".join(parts)


def _linked(shape: str, address: str) -> str:
    return f'<a href="{escape(address)}">{shape}</a>' if address else shape


def _pill(content: Content) -> tuple[float, float]:
    return 22 + _TEXT_WIDTH * len(content.resource), _PILL_HEIGHT


def _rect(box: Box, kind: str, radius: float) -> str:
    return (
        f'<rect class="{kind}" x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}" '
        f'rx="{radius:g}"/>'
    )


def _text(box: Box, down: float, kind: str, text: str) -> str:
    x, y = box.x + box.width / 2, box.y + down
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escape(text)}</text>'


def _smooth(points: tuple[tuple[float, float], ...]) -> str:
    path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for (x0, y0), (x1, y1) in pairwise(points):
        middle = (x0 + x1) / 2
        path += f"C{middle:.1f} {y0:.1f} {middle:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
    return path


def _next_frame(source: Box, target: Box, low: float) -> str:
    x0, y0 = source.x + source.width / 2, source.y + source.height
    x1, y1 = target.x + target.width / 2, target.y + target.height
    return (
        f'<path class="edge old" d="M{x0:.1f} {y0:.1f}'
        f"C{x0:.1f} {low:.1f} {x0:.1f} {low:.1f} {(x0 + x1) / 2:.1f} {low:.1f}"
        f'S{x1:.1f} {low:.1f} {x1:.1f} {y1:.1f}" marker-end="url(#tip)"/>'
    )
