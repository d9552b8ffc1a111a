"""What documents, graphs, plans, results and records show in a notebook: the page in a frame, or a picture.

A notebook asks objects for ``_repr_html_`` and ``_repr_png_``; nothing of IPython is needed here.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from html import escape
from typing import TypeVar

from rich.console import Console, RenderableType

from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.document.render_text import format_diagnostics
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import Graph
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.graph_png import graph_png
from rendergraph.report.html import TargetGallery, html_page
from rendergraph.report.timing import timing_record
from rendergraph.run.image_files import display_pixels
from rendergraph.run.result import FrameResult

_HEIGHT = 640
_PRE = "<pre style='line-height:1.25;overflow:auto'>{}</pre>"

T = TypeVar("T")


def plan_html(plan: Plan, title: str = "") -> str:
    """The page of a plan, in a frame of its own so that neither styles the other."""
    return _framed(html_page(plan, title=title))


def result_html(result: FrameResult) -> str:
    """The page of a run, with the outputs and captures it holds as targets."""
    gallery = TargetGallery()
    for key, pixels in (result.captures | result.images).items():
        name = key.partition("@")[0]  # of an output a frame, the last frame's
        if pixels.ndim == 3 and name not in result.plan.buffer_of:
            gallery.add(name, pixels)
    page = html_page(result.plan, timing=timing_record(result), targets=gallery, warnings=result.warnings)
    return _framed(page)


def result_png(result: FrameResult) -> bytes | None:
    """The first output, as its PNG file would be; ``None`` when there is none."""
    from PIL import Image

    for pixels in result.images.values():
        shown = display_pixels(pixels)[::-1, :, :3]
        flat = shown[..., 0] if shown.shape[-1] < 3 else shown
        buffer = io.BytesIO()
        Image.fromarray(flat.copy()).save(buffer, "PNG")
        return buffer.getvalue()
    return None


def graph_html(graph: Graph) -> str:
    """The page of the graph's default plan; its diagnostics when there is none."""
    return _or_diagnostics(lambda: plan_html(_planned(graph)))


def graph_picture(graph: Graph) -> bytes | None:
    """The drawing of the graph's default plan; ``None`` when there is none."""
    return _or_nothing(lambda: graph_png(_planned(graph)))


def document_html(document: Document) -> str:
    """The page of the document's default plan, without its scene; its diagnostics when there is none."""
    return _or_diagnostics(lambda: plan_html(_planned_document(document), document.model.title))


def document_picture(document: Document) -> bytes | None:
    """The drawing of the document's default plan; ``None`` when there is none."""
    return _or_nothing(lambda: graph_png(_planned_document(document)))


def tables_html(*tables: RenderableType) -> str:
    """The terminal's tables as preformatted text in colour."""
    console = Console(record=True, width=160, file=io.StringIO())
    for table in tables:
        console.print(table)
        console.print()
    return console.export_html(inline_styles=True, code_format=_PRE.format("{code}"))


def _planned(graph: Graph) -> Plan:
    return compile_plan(graph, PlanOptions())[0]


def _planned_document(document: Document) -> Plan:
    return plan_without_scene(document, PlanOptions())[0]


def _framed(page: str) -> str:
    # A fragment link in a frame without an address of its own would lead to the notebook's.
    inside = page.replace("<head>", '<head><base href="about:srcdoc">', 1)
    style = f"width:100%;height:{_HEIGHT}px;border:1px solid #8886;border-radius:8px"
    return f'<iframe title="render graph" sandbox="allow-scripts" style="{style}" srcdoc="{escape(inside)}"></iframe>'


def _or_diagnostics(show: Callable[[], str]) -> str:
    try:
        return show()
    except RenderGraphError as error:
        return _PRE.format(escape(format_diagnostics(error.diagnostics)))


def _or_nothing(show: Callable[[], T]) -> T | None:
    try:
        return show()
    except RenderGraphError:
        return None
