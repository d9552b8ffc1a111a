"""Documents, graphs, plans and results show themselves; nothing of IPython is imported."""

from __future__ import annotations

import io
import sys
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rendergraph.document.load import Document, load_document, shipped_graphs
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.drawing import drawing, place
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import timing_record
from rendergraph.report.write import WrittenResult
from tests.report.made_up import made_up_plan, made_up_result


def inner_page(frame: str) -> str:
    """The page inside the one frame."""
    assert frame.startswith("<iframe ")
    assert frame.count("<") == 2, "nothing of the page leaks out of the attribute"
    return unescape(frame.split('srcdoc="')[1].rsplit('"', 1)[0])


def opened(data: bytes | None) -> Image.Image:
    assert data is not None
    return Image.open(io.BytesIO(data))


@pytest.fixture
def broken(tmp_path: Path) -> Document:
    """A document that loads, but whose passes wait for each other."""
    text = (
        "rendergraph: 1\npasses:\n"
        "  a: {node: tonemap, read: {color: y}, write: {color: x}}\n"
        "  b: {node: tonemap, read: {color: x}, write: {color: y}}\n"
        "outputs:\n  y: {file: y.png}\n"
    )
    (tmp_path / "loop.yaml").write_text(text)
    return load_document(tmp_path / "loop.yaml")


def test_a_document_shows_its_plan() -> None:
    document = load_document("deferred_shading")
    page = inner_page(document._repr_html_())
    assert document.model.title in page
    assert '<base href="about:srcdoc">' in page
    assert 'id="resource-base_color"' in page
    assert 'id="resource-base_color"' in inner_page(made_up_plan().graph._repr_html_())


@pytest.mark.parametrize("name", sorted(shipped_graphs()))
def test_the_picture_is_the_layouts_size_and_not_empty(name: str) -> None:
    plan = made_up_plan(name)
    layout = place(drawing(plan))
    image = opened(plan._repr_png_())
    assert image.size[0] == round(2 * layout.width)
    assert image.size[1] >= round(2 * layout.height)
    for box in layout.boxes.values():
        assert image.getpixel((round(2 * (box.x + box.width / 2)), round(2 * box.y) + 1)) != (255, 255, 255)
    assert image.getpixel((1, 1)) == (255, 255, 255)


def test_a_mistake_is_shown_as_its_message(broken: Document) -> None:
    with pytest.raises(RenderGraphError) as caught:
        plan_without_scene(broken, PlanOptions())
    text = broken._repr_html_()
    assert caught.value.diagnostics[0].code in text
    assert "iframe" not in text
    assert broken._repr_png_() is None


def test_a_result_shows_its_page_and_first_image() -> None:
    plan = made_up_plan()
    pixels = np.zeros((2, 3, 4), np.uint8)
    pixels[0, 0] = (10, 20, 30, 40)  # the lower left
    result = replace(made_up_result(plan), images={"image": pixels})
    page = inner_page(result._repr_html_())
    assert 'id="target-image"' in page
    assert 'id="pass-gbuffer"' in page
    image = opened(result._repr_png_())
    assert image.getpixel((0, 1)) == (10, 20, 30)
    assert made_up_result(plan)._repr_png_() is None


def test_of_an_output_a_frame_the_last_is_shown() -> None:
    images = {f"image@{i}": np.full((2, 2, 4), i, np.uint8) for i in (0, 255)}
    page = inner_page(replace(made_up_result(made_up_plan()), images=images)._repr_html_())
    assert page.count('class="panel card"') == 1
    assert "<td>1</td><td>1</td>" in page


def test_records_show_the_terminals_tables() -> None:
    plan = made_up_plan()
    timing, resources = timing_record(made_up_result(plan), "<b>"), resources_record(plan, "<b>")
    text = WrittenResult(timing, resources, ())._repr_html_()
    assert "Pass times" in text
    assert "base_color" in text
    assert "<b>" not in text


def test_nothing_needs_ipython() -> None:
    made_up_plan()._repr_html_()
    assert "IPython" not in sys.modules
