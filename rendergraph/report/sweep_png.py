"""The plot of a sweep as a PNG, for pages that show no SVG."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import whole_file
from rendergraph.report.sweep_plot import Bubble, Plot, sweep_plot

#: Drawn larger and averaged down: Pillow's lines and circles have hard edges.
_FINER: Final = 3
_SCALE: Final = 1.5  # pixels of the file for one of the plot
_INK, _QUIET, _RULE, _PAPER = (22, 32, 46), (86, 101, 121), (219, 226, 234), (255, 255, 255)
_FRONT, _DULL, _TAKE = (75, 134, 221), (176, 186, 200), (163, 58, 18)


def write_sweep_png(path: Path, record: dict[str, Any]) -> None:
    """Write the plot.

    :raises RenderGraphError: RG764 where no setting has both a time and an error; RG560.
    """
    plot = sweep_plot(record)
    if plot is None:
        raise RenderGraphError([diagnose("RG764")])
    picture = _draw(plot, record)
    with whole_file(path) as temporary:
        picture.save(temporary, "PNG", optimize=True)


def _draw(plot: Plot, record: dict[str, Any]) -> Any:
    from PIL import Image, ImageDraw, ImageFont

    zoom = _FINER * _SCALE
    size = (round(plot.width * zoom), round(plot.height * zoom))
    picture = Image.new("RGB", size, _PAPER)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(round(12 * zoom))
    thin, thick = round(zoom), round(2 * zoom)

    def px(*values: float) -> Any:  # two or four numbers, as Pillow takes them
        return tuple(value * zoom for value in values)

    for at, name in plot.x.ticks:
        draw.line(px(at, plot.y.end, at, plot.y.start), _RULE, thin)
        draw.text(px(at, plot.y.start + 6), name, _QUIET, font, anchor="ma")
    for at, name in plot.y.ticks:
        draw.line(px(plot.x.start, at, plot.x.end, at), _RULE, thin)
        draw.text(px(plot.x.start - 8, at), name, _QUIET, font, anchor="rm")
    across = "milliseconds a frame" + (" (logarithmic)" if plot.x.logarithmic else "")
    draw.text(px((plot.x.start + plot.x.end) / 2, plot.height - 22), across, _QUIET, font, anchor="ma")
    up = f"{record['error']['metric']} of {record['error']['name']}" + (" (logarithmic)" if plot.y.logarithmic else "")
    picture.paste(*_upright(up, font, px(16, (plot.y.start + plot.y.end) / 2)))
    for (x0, y0), (x1, y1) in zip(plot.steps, plot.steps[1:], strict=False):
        draw.line(px(x0, y0, x1, y1), _FRONT, thick)
    for bubble in plot.bubbles:
        draw.line(px(bubble.left, bubble.y, bubble.right, bubble.y), _colour(bubble), thick)
    for bubble in plot.bubbles:
        r = bubble.radius
        box = px(bubble.x - r, bubble.y - r, bubble.x + r, bubble.y + r)
        hollow = bubble.own and not bubble.recommended
        draw.ellipse(box, None if hollow else _colour(bubble), _INK if bubble.own else _PAPER, thick)
    return picture.resize((round(plot.width * _SCALE), round(plot.height * _SCALE)), Image.Resampling.LANCZOS)


def _colour(bubble: Bubble) -> tuple[int, int, int]:
    return _TAKE if bubble.recommended else _FRONT if bubble.front else _DULL


def _upright(text: str, font: Any, centre: tuple[float, ...]) -> tuple[Any, tuple[int, int]]:
    """A text turned to read upwards, and the corner to paste it at."""
    from PIL import Image, ImageDraw

    width, height = (int(extent) + 8 for extent in font.getbbox(text)[2:])
    strip = Image.new("RGB", (width, height), _PAPER)
    ImageDraw.Draw(strip).text((width / 2, height / 2), text, _QUIET, font, anchor="mm")
    turned = strip.rotate(90, expand=True)
    return turned, (round(centre[0] - turned.width / 2), round(centre[1] - turned.height / 2))
