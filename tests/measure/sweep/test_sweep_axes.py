"""`--over`: what an axis is, which values it has, and every way to get it wrong."""

from __future__ import annotations

import pytest

from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.axes import Axis, amount_held, parse_axes


@pytest.fixture(scope="module")
def lit() -> Document:
    return load_document("deferred_shading")


def one(document: Document, text: str) -> Axis:
    (axis,) = parse_axes(document, [text])
    return axis


def test_a_knob_alone_has_its_range_in_five_steps_cheap_first(lit: Document) -> None:
    steps = one(lit, "antialias.search_steps")
    assert steps == Axis(
        "antialias.search_steps",
        "passes.antialias.set.search_steps",
        ("1", "9", "16", "24", "32"),  # 1, 8.75, 16.5 (to even), 24.25, 32
        "up",
        "antialias",
    )


def test_values_run_from_cheap_to_accurate_where_less_is_more_accurate(lit: Document) -> None:
    axis = one(lit, "meter.stride=1|16|4")
    assert axis.values == ("16", "4", "1")
    assert axis.quality == "down"


def test_a_choice_without_an_order_keeps_its_own_and_claims_nothing(lit: Document) -> None:
    axis = one(lit, "tonemap.curve=agx|linear")
    assert axis.values == ("agx", "linear")
    assert axis.quality == ""


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("0.1:0.5:3", ("0.1", "0.3", "0.5")),
        ("0.25:1:3:log", ("0.25", "0.5", "1")),
        ("0.5:0.5:1", ("0.5",)),
        ("1|0.25", ("0.25", "1")),
    ],
)
def test_ranges_and_lists(lit: Document, given: str, values: tuple[str, ...]) -> None:
    axis = one(lit, f"antialias.edge_threshold={given}")
    assert sorted(axis.values) == sorted(values)
    assert axis.values == tuple(sorted(values, key=float, reverse=True)), "smaller is more accurate"


def test_whole_bounds_with_room_give_whole_numbers(lit: Document) -> None:
    assert one(lit, "antialias.search_steps=1:10:4").values == ("1", "4", "7", "10")


def test_several_axes_with_commas_and_brackets(lit: Document) -> None:
    axes = parse_axes(lit, ["shadows.cascades=1|3,resources.shadow.fixed=[2048, 2048]|[512, 512]", "frame.seed=1|2"])
    assert [axis.path for axis in axes] == ["passes.shadows.set.cascades", "resources.shadow.fixed", "frame.seed"]
    assert axes[1].values == ("[512, 512]", "[2048, 2048]"), "fewer texels are cheaper"
    assert (axes[1].quality, axes[1].passed) == ("order", "shadows")
    assert (axes[2].quality, axes[2].passed) == ("", "")


def test_a_resource_of_several_writers_belongs_to_no_pass(lit: Document) -> None:
    axis = one(lit, "resources.hdr.format=rgba32f|r11g11b10f|rgba16f")
    assert axis.passed == ""
    assert axis.values == ("r11g11b10f", "rgba16f", "rgba32f")


def test_a_full_path_of_a_knob_is_the_knob(lit: Document) -> None:
    assert one(lit, "passes.antialias.set.search_steps=1|2") == one(lit, "antialias.search_steps=1|2")


@pytest.mark.parametrize(
    ("key", "value", "amount"),
    [
        ("format", "rgba16f", 2.0),
        ("format", "r8", 1.0),
        ("format", "nonsense", None),
        ("scale", "0.5", 0.5),
        ("fixed", "[4, 8]", 32.0),
        ("fixed", "like", None),
        ("scale", "1.2.3", None),
    ],
)
def test_how_much_a_resource_holds(key: str, value: str, amount: float | None) -> None:
    assert amount_held(key, value) == amount


@pytest.mark.parametrize(
    ("over", "code"),
    [
        ("occlude.radius", "RG750"),
        ("antialias.search_step", "RG750"),
        ("antialias.search_steps=5:1:3", "RG751"),
        ("antialias.search_steps=1:5:0", "RG751"),
        ("antialias.search_steps=1:5:1", "RG751"),
        ("antialias.edge_threshold=nan:1:3", "RG751"),
        ("antialias.edge_threshold=0:inf:3", "RG751"),
        ("antialias.edge_threshold=0:1:3:log", "RG751"),
        ("antialias.edge_threshold=a:b:c", "RG751"),
        ("antialias.search_steps=1||2", "RG751"),
        ("antialias.search_steps=1|1", "RG751"),
        ("frame.seed", "RG751"),
        ("shadows.distance", "RG751"),
        ("antialias.search_steps=1|2,passes.antialias.set.search_steps=3|4", "RG752"),
        ("", "RG750"),
    ],
)
def test_what_is_no_axis(lit: Document, over: str, code: str) -> None:
    with pytest.raises(RenderGraphError) as refused:
        parse_axes(lit, [over])
    assert [d.code for d in refused.value.diagnostics] == [code]
    assert refused.value.exit_code == 2


def test_nothing_at_all_is_refused(lit: Document) -> None:
    with pytest.raises(RenderGraphError) as refused:
        parse_axes(lit, [])
    assert refused.value.diagnostics[0].code == "RG751"


def test_all_mistakes_are_told_at_once(lit: Document) -> None:
    with pytest.raises(RenderGraphError) as refused:
        parse_axes(lit, ["nobody.radius,antialias.search_steps=5:1:3"])
    assert [d.code for d in refused.value.diagnostics] == ["RG750", "RG751"]
