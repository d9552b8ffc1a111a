"""The page as text: complete, self-contained, and with every user's word escaped."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest

from rendergraph.document.load import shipped_graphs
from rendergraph.document.messages import Diagnostic
from rendergraph.plan.explain import all_decisions
from rendergraph.report.html import TargetGallery, html_page
from rendergraph.report.html.memory import lifetime_chart
from rendergraph.report.html.times import AXIS, time_chart
from rendergraph.report.timing import spread, timing_record
from tests.report.made_up import BOUND, MS, made_up_gallery, made_up_plan, made_up_result

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&{{ 7*7 }}"


class Page(HTMLParser):
    """Elements, ids, addresses and texts of a page."""

    VOID = frozenset({"meta", "img", "input", "br", "rect", "path", "link"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.handlers: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("href", "src", "xlink:href", "action", "srcset", "data"):
                self.addresses.append(value or "")
            if name.startswith("on"):
                self.handlers.append(name)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def full_page(name: str = "deferred_shading", title: str = "A title", samples: int = 3) -> str:
    plan = made_up_plan(name)
    timing = timing_record(made_up_result(plan, samples), title)
    return html_page(plan, title=title, timing=timing, targets=made_up_gallery(plan))


@pytest.mark.parametrize("name", sorted(shipped_graphs()))
def test_everything_of_the_plan_is_on_the_page(name: str) -> None:
    plan = made_up_plan(name)
    page = Page(full_page(name))
    assert {f"resource-{resource}" for resource in plan.lifetimes} <= set(page.ids)
    assert {f"pass-{subpass.parent}" for subpass in plan.order} <= set(page.ids)
    words = " ".join(page.texts)
    assert all(subpass.name in words for subpass in plan.order)
    assert all(decision.reason in words for decision in all_decisions(plan))
    assert all(h.kind in words for barrier in plan.barriers for h in barrier.hazards)


@pytest.mark.parametrize("name", sorted(shipped_graphs()))
def test_ids_are_unique_and_links_lead_somewhere(name: str) -> None:
    for text in (full_page(name), html_page(made_up_plan(name))):
        page = Page(text)
        assert len(page.ids) == len(set(page.ids))
        inside = [a[1:] for a in page.addresses if a.startswith("#")]
        assert inside
        assert set(inside) <= set(page.ids)


def test_nothing_is_asked_of_the_network() -> None:
    text = full_page()
    page = Page(text)
    assert all(a.startswith(("#", "data:image/png;base64,")) for a in page.addresses)
    assert "link" not in page.tags
    assert "default-src 'none'" in text
    assert not re.search(r"@import|url\(", text.split("</style>")[0])


def test_hostile_words_stay_words() -> None:
    plan = made_up_plan()
    warning = Diagnostic("RG999", "warning", HOSTILE, HOSTILE)
    timing = timing_record(made_up_result(plan), HOSTILE)
    timing["device"]["renderer"] = HOSTILE
    harmless = Page(full_page())
    page = Page(html_page(plan, title=HOSTILE, timing=timing, targets=made_up_gallery(plan), warnings=[warning]))
    for tag in ("script", "img"):
        assert page.tags.count(tag) == harmless.tags.count(tag)
    assert not page.handlers
    assert page.texts.count(HOSTILE) >= 3, "title, heading and warning, each one whole text"


def test_a_plan_alone_has_a_page() -> None:
    page = Page(html_page(made_up_plan()))
    assert {"graph", "memory", "barriers", "decisions"} <= set(page.ids)
    assert not {"times", "targets", "run", "viewer"} & set(page.ids)


def test_a_run_without_samples_has_a_page() -> None:
    page = Page(full_page(samples=0))
    assert "run" in page.ids
    assert "times" not in page.ids


def test_a_gallery_without_views() -> None:
    assert "viewer" not in Page(html_page(made_up_plan(), targets=TargetGallery())).ids


def test_bars_are_on_one_axis() -> None:
    plan = made_up_plan()
    record = timing_record(made_up_result(plan))
    chart = time_chart(record)
    assert chart is not None
    by_name = {bar.name: bar for bar in chart.passes}
    longest = max(chart.passes, key=lambda bar: bar.median)
    assert longest.length == AXIS  # all samples are alike, so the longest ends the axis
    assert by_name["shadows"].median == 1 + 2 + 3
    assert by_name["shadows"].length == round(AXIS * 6 / longest.median)
    assert [bar.median for bar in by_name["shadows"].inside] == [1, 2, 3]
    assert longest.median == 9 + 10 + 11
    assert sum(bar.share for bar in chart.passes) == pytest.approx(1)
    assert [bar.median for bar in chart.frame] == [50, sum(range(1, 14))]


def test_an_outlier_is_counted_and_does_not_squeeze_the_rest() -> None:
    record = timing_record(made_up_result(made_up_plan()))
    record["passes"][0]["ms"] = spread([6 * MS, 6 * MS, 9000 * MS])
    chart = time_chart(record)
    assert chart is not None
    assert chart.passes[0].late == 1
    assert chart.passes[0].spread[1] == AXIS
    assert chart.passes[0].high == 9000
    assert all(bar.late == 0 for bar in chart.passes[1:])
    assert max(bar.length for bar in chart.passes) > AXIS / 2


def test_lifetimes_and_slots_are_the_plans() -> None:
    plan = made_up_plan()
    chart = lifetime_chart(plan)
    assert {row.name: (row.first, row.last) for row in chart.rows} == {
        name: (life.first, life.last) for name, life in plan.lifetimes.items()
    }
    rows = {row.name: row for row in chart.rows}
    assert rows["base_color"].place == rows["display"].place == f"slot {plan.slot_of['display']}"
    assert rows["base_color"].shares == ("display",)
    assert rows["base_color"].hue == rows["display"].hue != rows["hdr"].hue
    assert rows["image"].hue is None
    assert {row.name for row in chart.rows if row.peak} == set(plan.totals.peak)
    assert [i for i, (_, _, gate) in enumerate(chart.columns) if gate] == [b.index for b in plan.barriers]
    heights = [float(y) for y in re.findall(r"V([\d.]+)H", chart.curve)]
    assert min(heights) == pytest.approx(chart.load_at, abs=0.01), "the curve touches LOAD at the peak"
    assert [total.name for total in chart.totals if total.used] == ["view pool"]


def test_what_the_frame_is_bound_by_is_shown_where_it_was_asked() -> None:
    plan = made_up_plan()
    for samples in (0, 3):
        result = made_up_result(plan, samples)
        found = " ".join(Page(html_page(plan, timing=timing_record(result, bound=BOUND))).texts)
        assert "Bound by" in found
        assert BOUND["advice"] in found
        assert "half resolution 27 %" in found
        assert "Bound by" not in " ".join(Page(html_page(plan, timing=timing_record(result))).texts)
