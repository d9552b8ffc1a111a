"""The graph's drawing as a PNG, for notebooks that keep pictures but no HTML: the same layout as the SVG."""

from __future__ import annotations

import io
from typing import Final

from PIL import Image, ImageDraw, ImageFont

from rendergraph.plan.plan import Plan
from rendergraph.report.drawing import drawing, place
from rendergraph.report.layered import Box

_SCALE: Final = 2  # pixels to an SVG pixel, for dense screens
_MARGIN_BELOW: Final = 40  # for the arcs to the next frame
#: (fill, outline) by kind, those of the SVG on a light ground.
_COLOURS: Final = {
    "pass": ("#eef3fb", "#4a6fa5"),
    "resource": ("#f6f3ea", "#b9a878"),
    "output": ("#e6f4e6", "#3f8f4f"),
    "history": ("#f3ebf7", "#8a63a8"),
    "imported": ("#f3ebf7", "#8a63a8"),
}


def graph_png(plan: Plan) -> bytes:
    """The passes and resources of a plan, left to right."""
    graph = drawing(plan)
    layout = place(graph)
    below = _MARGIN_BELOW if graph.history else 0
    size = (max(1, round(_SCALE * layout.width)), max(1, round(_SCALE * (layout.height + below))))
    image = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(image)
    for route in layout.routes.values():
        draw.line([(_SCALE * x, _SCALE * y) for x, y in route], fill="#7c8da5", width=_SCALE, joint="curve")
    for source, target in graph.history:
        (x0, y0), (x1, y1), low = *(_foot(layout.boxes[key]) for key in (source, target)), size[1] - 2 * 16
        draw.line([(x0, y0), (x0, low), (x1, low), (x1, y1)], fill="#8a63a8", width=_SCALE)
    for name, text in graph.nodes.items():
        box = layout.boxes[f"pass {name}"]
        _shape(draw, box, "pass", 6)
        _text(draw, box, 14, name, 13)
        _text(draw, box, 31, text, 11)
    for content in graph.contents:
        box = layout.boxes[content.key]
        _shape(draw, box, content.kind, box.height / 2)
        _text(draw, box, 11, content.resource, 11)
    buffer = io.BytesIO()
    image.save(buffer, "PNG")
    return buffer.getvalue()


def _foot(box: Box) -> tuple[float, float]:
    return _SCALE * (box.x + box.width / 2), _SCALE * (box.y + box.height)


def _shape(draw: ImageDraw.ImageDraw, box: Box, kind: str, radius: float) -> None:
    fill, outline = _COLOURS[kind]
    corners = [_SCALE * v for v in (box.x, box.y, box.x + box.width, box.y + box.height)]
    draw.rounded_rectangle(corners, _SCALE * radius, fill, outline, _SCALE)


def _text(draw: ImageDraw.ImageDraw, box: Box, down: float, text: str, size: float) -> None:
    at = (_SCALE * (box.x + box.width / 2), _SCALE * (box.y + down))
    draw.text(at, text, fill="#16243a", font=ImageFont.load_default(_SCALE * size), anchor="mm")
