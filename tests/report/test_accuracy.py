"""The accuracy record, its findings and budgets, its terminal table and its part of the page."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image
from rich.console import Console

from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.budget import check_memory, check_run
from rendergraph.measure.truth.accuracy import PassAccuracy
from rendergraph.measure.truth.judgement import Pictures
from rendergraph.measure.truth.knobs import accuracy_knobs
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Quantity
from rendergraph.report.accuracy import number, write_variances
from rendergraph.report.accuracy_findings import accuracy_findings
from rendergraph.report.accuracy_table import accuracy_table
from rendergraph.report.html import ErrorGallery, html_page
from rendergraph.report.html.accuracy import accuracy_entries
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import timing_record
from tests.report.made_up import made_up_plan, made_up_result
from tests.report.made_up_accuracy import judged, judged_noise, made_up_accuracy, made_up_passes


def by_name(record: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {entry["name"]: entry for entry in record["passes"]}


def test_error_stands_beside_time_and_bytes() -> None:
    plan = made_up_plan()
    record = made_up_accuracy(plan=plan)
    timing, resources = timing_record(made_up_result(plan)), resources_record(plan)
    passes = by_name(record)
    for entry in timing["passes"]:
        if entry["name"] in passes:
            assert passes[entry["name"]]["ms"] == entry["ms"]["median"] > 0
    held = sum(r["bytes"] for r in resources["resources"] if r["first"].partition(".")[0] == "gbuffer")
    assert passes["gbuffer"]["bytes"] == held > 0
    assert record["verdicts"] == {"within": 2, "above": 2, "cannot_judge": 1}


def test_a_measure_says_all_that_was_found() -> None:
    passes = by_name(made_up_accuracy())
    (measure,) = passes["light"]["measures"]
    assert measure["value"] == pytest.approx(0.3)
    assert (measure["verdict"], measure["metric"], measure["tolerance"]) == ("above", "max", 0.1)
    assert measure["masked"] == pytest.approx(4 / 192)
    assert (measure["worst_texel"]["x"], measure["worst_texel"]["y"]) == (3, 5)
    assert measure["worst_texel"]["inputs"] == {"depth": [0.25]}
    assert (passes["light"]["method"], passes["light"]["source"]) == ("analytic", "Somebody 1999")
    assert passes["light"]["broken"] == ["it <b>shines"]
    (nan,) = passes["gbuffer"]["measures"]
    assert (nan["value"], nan["reason"], nan["worst_texel"]["judged"][0]) == ("inf", "not_finite", "nan")
    (unsure,) = passes["sky"]["measures"]
    assert (unsure["verdict"], unsure["reason"]) == ("cannot_judge", "standard_error")
    assert unsure["standard_error"] == pytest.approx(3.0)
    (noise,) = passes["shadows"]["measures"]
    assert noise["z_test"]["frames"] == 16
    assert passes["meter"]["measures"] == []


@pytest.mark.parametrize(
    ("value", "said"), [(1.5, 1.5), (None, None), (float("inf"), "inf"), (-float("inf"), "-inf"), (float("nan"), "nan")]
)
def test_numbers_that_json_has_not_go_by_name(value: float | None, said: object) -> None:
    assert number(value) == said


def test_what_a_random_pass_was_tested_by_is_stored(tmp_path: Path) -> None:
    (file,) = write_variances(tmp_path, made_up_passes())
    assert file.relative_to(tmp_path) == Path("accuracy/shadows.noise.npz")
    with np.load(file) as stored:
        assert stored["frames"] == 16
        assert stored["variance"].shape == stored["mean"].shape == stored["truth"].shape == (12, 16, 1)
        assert stored["variance"].mean() == pytest.approx(0.01, rel=0.1)


# ---- findings


def document(tmp_path: Path, budget: dict[str, Any]) -> Document:
    graph = {
        "rendergraph": 1,
        "resources": {"flat": {"format": "rgba8"}},
        "passes": {
            "wipe": {"node": "clear", "write": {"target": "flat"}},
            "smooth": {"node": "fxaa", "read": {"color": "flat"}, "write": {"color": "image"}},
        },
        "outputs": {"image": {"file": "image.png"}},
        "budget": budget,
    }
    (tmp_path / "graph.yaml").write_text(yaml.safe_dump(graph, sort_keys=False))
    return load_document(tmp_path / "graph.yaml")


def smooth(error: float, **more: Any) -> list[PassAccuracy]:
    return [PassAccuracy("smooth", "fxaa", (judged("smooth", error, **more),))]


def codes(loaded: Document, passes: list[PassAccuracy]) -> list[tuple[str, str]]:
    return [(found.code, found.severity) for found in accuracy_findings(loaded, passes)]


def test_a_measure_within_is_no_finding(tmp_path: Path) -> None:
    assert codes(document(tmp_path, {}), smooth(0.05)) == []


def test_a_measure_above_names_the_texel_and_the_knobs(tmp_path: Path) -> None:
    (found,) = accuracy_findings(document(tmp_path, {}), smooth(0.3))
    assert (found.code, found.severity, found.data["name"], found.data["node"]) == (
        "RG742",
        "error",
        "smooth",
        "made_up",
    )
    assert "(3, 5)" in found.data["worst"]
    assert "passes.smooth.set.search_steps" in found.help
    assert found.position is not None
    assert found.position.line > 1


def test_a_truth_that_cannot_judge_is_an_error(tmp_path: Path) -> None:
    (found,) = accuracy_findings(document(tmp_path, {}), smooth(0.0, own=1.0))
    assert (found.code, found.severity, found.data["measure"]) == ("RG741", "error", "color")


def test_a_truth_that_is_known_nowhere_is_noted(tmp_path: Path) -> None:
    unknown = replace(judged("smooth", 0.0), verdict="cannot_judge", reason="all_masked")
    assert codes(document(tmp_path, {}), [PassAccuracy("smooth", "fxaa", (unknown,))]) == [("RG712", "note")]


def test_a_broken_invariant_is_an_error(tmp_path: Path) -> None:
    (found,) = accuracy_findings(document(tmp_path, {}), [PassAccuracy("smooth", "fxaa", (), ("it leaks",))])
    assert (found.code, found.severity, found.data["what"]) == ("RG747", "error", "it leaks")


def test_a_random_pass_above_says_what_chance_explains(tmp_path: Path) -> None:
    (found,) = accuracy_findings(
        document(tmp_path, {}), [PassAccuracy("smooth", "fxaa", (judged_noise("smooth", 0.5),))]
    )
    assert found.code == "RG742"
    assert "0.00 %" in found.data["worst"]


# ---- budgets


@pytest.mark.parametrize(("limit", "expected"), [(0.04, [("RG710", "error")]), (0.06, [])])
def test_the_budget_of_a_passs_error(tmp_path: Path, limit: float, expected: list[Any]) -> None:
    loaded = document(tmp_path, {"error": {"smooth": limit}})
    assert codes(loaded, smooth(0.05)) == expected
    found = accuracy_findings(loaded, smooth(0.05))
    if found:
        assert found[0].position == loaded.position("budget", "error", "smooth")


def test_the_budget_of_the_image(tmp_path: Path) -> None:
    pytest.importorskip("flip_evaluator")
    assert codes(document(tmp_path, {"flip": 0.9}), smooth(0.05)) == []
    loaded = document(tmp_path, {"flip": 1e-9})
    assert codes(loaded, smooth(0.05)) == [("RG711", "error")]
    hidden = smooth(0.05, port="elsewhere")
    assert codes(loaded, hidden) == [("RG708", "note")]
    assert codes(loaded, smooth(0.05, quantity=Quantity.SCALAR)) == [("RG708", "note")]


def test_budgets_that_nothing_was_compared_with_are_noted(tmp_path: Path) -> None:
    loaded = document(tmp_path, {"error": {"wipe": 0.1, "smooth": 0.1}, "flip": 0.1})
    unjudged = [PassAccuracy("wipe", "clear", reason="the node has no reference")]
    assert codes(loaded, unjudged) == [("RG708", "note")] * 3


def test_without_references_the_budgets_of_errors_are_noted(tmp_path: Path) -> None:
    loaded = document(tmp_path, {"error": {"smooth": 0.1}, "flip": 0.1})
    plan = made_up_plan()
    timing, record = timing_record(made_up_result(plan)), resources_record(plan)
    assert [d.code for d in check_memory(loaded, record)] == ["RG709", "RG709"]
    assert [d.code for d in check_run(loaded, timing, record)] == ["RG709", "RG709"]
    assert check_run(loaded, timing, record, judged=True) == []


def test_a_budget_for_a_pass_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    for budget, code in (({"error": {"smoth": 0.1}}, "RG706"), ({"error": {"smooth": -1}}, "RG123")):
        with pytest.raises(RenderGraphError) as refused:
            document(tmp_path, budget)
        assert [d.code for d in refused.value.diagnostics] == [code]


# ---- knobs


class Knobs(Params):
    """All sorts."""

    up: int = knob(4, "More is better.", ge=1, le=8, accurate="up")
    down: float = knob(0.5, "Less is better.", ge=0.0, le=1.0, accurate="down")
    choice: str = knob("b", "A choice.", accurate=("a", "b", "c", "d"))
    plain: int = knob(1, "No quality.")


def test_knobs_that_have_room_are_named() -> None:
    assert [(k.name, k.now, k.better) for k in accuracy_knobs(Knobs())] == [
        ("up", 4, "larger"),
        ("down", 0.5, "smaller"),
        ("choice", "b", "c, d"),
    ]
    assert accuracy_knobs(Knobs(up=8, down=0.0, choice="d")) == []


# ---- table and page


def test_the_table_has_a_row_a_measure() -> None:
    console = Console(width=250, no_color=True)
    with console.capture() as captured:
        console.print(accuracy_table(made_up_accuracy()))
    lines = {line.split()[0]: line for line in captured.get().splitlines() if line.strip()}
    assert re.search(r" 0\.05 +0\.1 +within", lines["tonemap"])
    assert re.search(r" 0\.3 +0\.1 +above", lines["light"])
    assert "cannot judge" in lines["sky"]
    assert "no reference" in lines["meter"]
    assert "2 within, 2 above" in captured.get()


def gallery(passes: tuple[PassAccuracy, ...]) -> ErrorGallery:
    shown = ErrorGallery()
    for found in (found for entry in passes for found in entry.judgements):
        shown.add(found)
    return shown


def page(passes: tuple[PassAccuracy, ...] | None = None) -> str:
    plan = made_up_plan()
    entries = accuracy_entries(made_up_accuracy(plan=plan), gallery(passes or made_up_passes()))
    return html_page(plan, title="A", timing=timing_record(made_up_result(plan)), accuracy=entries)


def test_the_page_shows_each_pass_with_its_pictures() -> None:
    text = page()
    section = text[text.index('<section id="accuracy"') : text.index('<section id="barriers"')]
    for entry in made_up_passes():
        assert f'id="accuracy-{entry.name}"' in section
    assert section.count('class="verdict within"') == 2
    assert section.count('class="verdict cannot_judge"') == 1
    assert "it &lt;b&gt;shines" in section
    assert "<b>shines" not in section
    pictures = re.findall(r'<img src="data:image/png;base64,[A-Za-z0-9+/=]+" alt="([^" ]+) of', section)
    assert {"judged", "truth", "error"} <= set(pictures)
    assert '<a href="#accuracy">' in text


def test_the_page_shows_flip_where_it_is_known() -> None:
    pytest.importorskip("flip_evaluator")
    assert 'alt="FLIP of color of tonemap"' in page()
    assert 'alt="FLIP of color of gbuffer"' not in page()


def test_a_page_without_references_has_no_accuracy() -> None:
    assert 'id="accuracy"' not in html_page(made_up_plan())


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 5000, 3), (3000, 2, 2), (640, 700, 4)])
def test_pictures_of_any_shape_are_small(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(1)
    found = replace(
        judged("tonemap", 0.0), metrics={"max": 0.0}, pictures=Pictures(rng.random(shape), rng.random(shape), None)
    )
    passes = (*made_up_passes()[:4], PassAccuracy("tonemap", "tonemap", (found,)), made_up_passes()[5])
    (measure,) = accuracy_entries(made_up_accuracy(), gallery(passes))[4]["measures"]
    assert [picture["heading"] for picture in measure["pictures"]] == ["judged", "truth", "error"]
    for picture in measure["pictures"]:
        image = Image.open(io.BytesIO(base64.b64decode(picture["png"].partition(",")[2])))
        assert max(image.size) <= 256
