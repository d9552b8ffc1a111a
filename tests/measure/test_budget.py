"""Budgets: which limits are exceeded, where the file says so, and who is to blame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.measure.budget import Spending, check_bench, check_memory, check_run, check_spending
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.resources import resources_record
from tests.cli.refusal import write_graph

CHAIN = """
  paint: {node: fullscreen, write: {o_color: a}, set: {shader: paint.frag}}
  again: {node: fullscreen, write: {o_color: b}, set: {shader: paint.frag}, after: [paint]}
  dead:  {node: fullscreen, write: {o_color: c}, set: {shader: paint.frag}}
  show:  {node: tonemap, read: {color: a}, write: {color: image}, set: {curve: linear}, after: [again]}
  also:  {node: tonemap, read: {color: b}, write: {color: second}, set: {curve: linear}}
"""
RESOURCES = "  a: {format: rgba32f}\n  b: {format: rgba16f}\n  c: {format: r8}\n"
OUTPUTS = "{image: {file: image.png}, second: {file: second.png}}"
TEXELS = 32 * 18


def load(folder: Path, budget: str, *overrides: str) -> tuple[Document, dict[str, Any]]:
    """A graph of four passes and one that is culled, under a budget on line 3, and its resources record."""
    path = write_graph(folder, resources=RESOURCES, passes=CHAIN, outputs=OUTPUTS, extra=f"budget: {budget}\n")
    document = load_document(path, overrides)
    return document, resources_record(plan_without_scene(document, PlanOptions())[0])


def only(found: list[Diagnostic]) -> Diagnostic:
    assert len(found) == 1, [d.code for d in found]
    return found[0]


def place(found: Diagnostic) -> tuple[int, int]:
    assert found.position is not None
    return found.position.line, found.position.column


SPENT = Spending(
    frame_ms=10.0,
    passes_ms={"paint": 2.0, "again": 5.0, "show": 1.0, "also": 2.0},
    steps_ms={"paint.draw": 2.0},
    draws={"paint": 1, "again": 7, "show": 1, "also": 1},
    draw_calls=4,
)


def test_a_frame_that_is_too_slow_names_its_slowest_pass(tmp_path: Path) -> None:
    document, _ = load(tmp_path, "{frame_ms: 9.5}")
    found = only(check_spending(document, SPENT))
    assert (found.code, found.severity, place(found)) == ("RG701", "error", (3, 20))
    assert (found.data["name"], found.data["share"], found.data["found"]) == ("again", 50.0, 10.0)
    document, _ = load(tmp_path, "{frame_ms: 10}")
    assert check_spending(document, SPENT) == []


def test_each_pass_has_its_own_limit(tmp_path: Path) -> None:
    document, _ = load(tmp_path, "{passes: {paint: 2, again: 4.5, show: 0.5}}")
    found = check_spending(document, SPENT)
    assert [(d.code, d.data["name"], d.data["limit"]) for d in found] == [
        ("RG702", "again", 4.5),
        ("RG702", "show", 0.5),
    ]
    assert place(found[0]) == (3, 36)


def test_draws_name_the_pass_with_the_most(tmp_path: Path) -> None:
    document, _ = load(tmp_path, "{draws: 9}")
    found = only(check_spending(document, SPENT))
    assert (found.code, found.data["found"], found.data["name"], found.data["most"]) == ("RG704", 10, "again", 7)
    assert found.data["calls"] == 4, "fewer calls than draws: each draw of a multi-draw counts"
    document, _ = load(tmp_path, "{draws: 10}")
    assert check_spending(document, SPENT) == []


def test_limits_that_nothing_was_compared_with_are_noted(tmp_path: Path) -> None:
    document, record = load(tmp_path, "{frame_ms: 1, passes: {paint: 1, dead: 1}, flip: 0.1}")
    untimed = Spending(draws={"paint": 1, "again": 1})
    found = [*check_spending(document, untimed), *check_memory(document, record)]
    assert [(d.code, d.severity) for d in found] == [
        ("RG708", "note"),
        ("RG708", "note"),
        ("RG707", "note"),
        ("RG709", "note"),
    ]


def test_memory_is_exact_and_names_who_is_live_at_the_peak(tmp_path: Path) -> None:
    used = TEXELS * (16 + 8)
    document, record = load(tmp_path, f"{{transient_mib: {(used - 1) / 2**20}}}")
    assert record["totals"]["used"] == used
    found = only(check_memory(document, record))
    assert (found.code, found.severity, place(found)) == ("RG703", "error", (3, 25))
    names = found.data["peak"]
    assert names.index("'a'") < names.index("'b'")  # the largest first
    document, record = load(tmp_path, f"{{transient_mib: {used / 2**20}}}")
    assert check_memory(document, record) == []


def test_memory_of_an_assumed_scene_is_a_warning(tmp_path: Path) -> None:
    document, record = load(tmp_path, "{transient_mib: 0.001}")
    found = only(check_memory(document, record, assumed=True))
    assert (found.code, found.severity) == ("RG705", "warning")


def test_unknown_passes_are_errors_with_a_suggestion(tmp_path: Path) -> None:
    with pytest.raises(RenderGraphError) as caught:
        load(tmp_path, "{passes: {paimt: 1, show: 1, zzz: 2}}")
    found = caught.value.diagnostics
    assert [(d.code, d.data["name"]) for d in found] == [("RG706", "paimt"), ("RG706", "zzz")]
    assert place(found[0]) == (3, 19)
    assert "'paint'" in found[0].help


@pytest.mark.parametrize("limit", ["0", "-1", "fast", ".nan", "[1]"])
def test_limits_are_positive_numbers(tmp_path: Path, limit: str) -> None:
    with pytest.raises(RenderGraphError) as caught:
        load(tmp_path, f"{{passes: {{paint: {limit}}}}}")
    assert {d.code for d in caught.value.diagnostics} <= {"RG122", "RG123", "RG112"}


def test_a_broken_passes_section_does_not_hide_behind_the_budget(tmp_path: Path) -> None:
    path = write_graph(tmp_path, extra="budget: {passes: 3}\n")
    with pytest.raises(RenderGraphError) as caught:
        load_document(path)
    assert [d.code for d in caught.value.diagnostics] == ["RG122"]


def timing(**samples: list[float]) -> dict[str, Any]:
    """The parts of a timing record that budgets read; every pass has two sub-passes, the second nine times as slow."""
    return {
        "frame_ms": {"samples": samples.pop("frame")},
        "passes": [
            {
                "name": name,
                "ms": {"samples": values},
                "counters": {"draws": 2, "draw_calls": 1},
                "subpasses": [
                    {"name": f"{name}.{step}", "ms": {"samples": [part * v for v in values]}}
                    for step, part in (("quick", 0.1), ("slow", 0.9))
                ],
            }
            for name, values in samples.items()
        ],
    }


def test_medians_are_compared_not_means(tmp_path: Path) -> None:
    document, record = load(tmp_path, "{frame_ms: 2, passes: {paint: 2.5}}")
    slow_once = {"frame": [1.0, 100.0, 2.0], "paint": [3.0, 1.0, 2.0, 50.0]}
    assert check_run(document, timing(**slow_once), record) == []
    slow = {"frame": [1.0, 100.0, 2.1], "paint": [3.0, 1.0, 2.1, 50.0]}
    found = check_run(document, timing(**slow), record)
    assert [(d.code, d.data["found"]) for d in found] == [("RG701", 2.1), ("RG702", 2.55)]
    assert "'paint.slow'" in found[1].data["worst"]


def test_errors_come_before_notes(tmp_path: Path) -> None:
    document, record = load(tmp_path, "{flip: 0.1, draws: 1, transient_mib: 0.001}")
    found = check_run(document, timing(frame=[], paint=[]), {**record, "advice": [{"why": "narrow it"}]})
    assert [d.code for d in found] == ["RG703", "RG704", "RG709"]
    assert found[0].help == "narrow it"


def test_each_side_of_a_bench_is_checked_over_all_its_blocks(tmp_path: Path) -> None:
    document, record = load(tmp_path, "{frame_ms: 4, passes: {paint: 2}, draws: 2, transient_mib: 0.001}")

    def block(*frames: float) -> dict[str, Any]:
        paint = [f / 2 for f in frames]
        steps = {"paint.quick": [p / 10 for p in paint], "paint.slow": [0.9 * p for p in paint]}
        return {"frame_ms": [*frames], "passes": {"paint": paint, "show": [0.1] * len(frames)}, "subpasses": steps}

    steps = {"paint": [{"name": "paint.quick"}, {"name": "paint.slow"}], "show": []}
    passes = [
        {"name": name, "counters": {"draws": 1, "draw_calls": 1}, "subpasses": inside} for name, inside in steps.items()
    ]
    side = {"passes": passes, "resources": record}
    bench = {
        "sides": {"A": side, "B": side},
        "blocks": [{"A": block(1, 9, 4), "B": block(5, 5)}, {"A": block(4, 4), "B": block(1)}],
    }
    assert [d.code for d in check_bench(document, bench, "A")] == ["RG703"]
    found = check_bench(document, bench, "B")
    assert [d.code for d in found] == ["RG703", "RG701", "RG702"]
    assert "'paint.slow'" in found[2].data["worst"]
    assert all("side B" in d.text for d in found)
    alone = {"sides": {"A": side}, "blocks": [{"A": block(5, 5)}]}
    assert not any("side" in d.text for d in check_bench(document, alone, "A"))
