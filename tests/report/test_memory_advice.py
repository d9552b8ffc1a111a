"""Advice is true: made by hand, each change saves what it says."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from rendergraph.document.load import load_document
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.memory_advice import LONGEST, advise
from tests.cli.refusal import write_graph


def plan_of(name: str | Path, *options: str) -> Plan:
    """The plan of a graph under command-line options: ``--set`` and ``--order memory``."""
    overrides = [value for flag, value in zip(options[::2], options[1::2], strict=True) if flag == "--set"]
    order = "memory" if "--order" in options else "default"
    return plan_without_scene(load_document(name, overrides), PlanOptions(order=order))[0]


@pytest.mark.parametrize("name", ["deferred_shading", "forward_shading", "exposure", "shadow_map", "gbuffer"])
def test_each_change_made_by_hand_saves_what_it_says(name: str) -> None:
    plan = plan_of(name)
    advice = advise(load_document(name), plan)
    assert advice
    for entry in advice:
        changed = plan_of(name, *shlex.split(entry.option))
        assert changed.totals.used == entry.used, entry.option
        assert changed.totals.load == entry.load
        assert plan.totals.used - changed.totals.used == entry.saves > 0
        assert entry.loses
    assert [entry.saves for entry in advice] == sorted((entry.saves for entry in advice), reverse=True)


TWO = """
  one: {node: fullscreen, write: {o_color: a}, set: {shader: paint.frag}}
  two: {node: fullscreen, write: {o_color: b}, set: {shader: paint.frag}}
  show: {node: tonemap, read: {color: a}, write: {color: image}, set: {curve: linear}}
  also: {node: tonemap, read: {color: b}, write: {color: second}, set: {curve: linear}}
"""


def test_what_the_nodes_refuse_or_what_saves_nothing_is_not_advised(tmp_path: Path) -> None:
    resources = "  a: {format: rgba32f}\n  b: {format: r11g11b10f}\n"
    path = write_graph(
        tmp_path, resources=resources, passes=TWO, outputs="{image: {file: i.png}, second: {file: s.png}}"
    )
    advice = advise(load_document(path), plan_of(path))
    # No halved size: the nodes want in and out of one size. Nothing for `b`: no format of its meaning is narrower.
    assert [(entry.change, entry.resource, entry.after) for entry in advice] == [
        ("format", "a", "r11g11b10f"),
        ("format", "a", "rgba16f"),
    ]


def test_without_sharing_to_share_is_advised() -> None:
    document = load_document("deferred_shading")
    plan, _ = plan_without_scene(document, PlanOptions(alias=False))
    shared, _ = plan_without_scene(document, PlanOptions())
    entry = next(entry for entry in advise(document, plan) if entry.change == "alias")
    assert entry.used == shared.totals.used


def test_another_order_is_advised_exactly_where_it_saves(tmp_path: Path) -> None:
    resources = "  a: {format: rgba32f}\n  b: {format: rgba32f}\n"
    path = write_graph(
        tmp_path, resources=resources, passes=TWO, outputs="{image: {file: i.png}, second: {file: s.png}}"
    )
    document = load_document(path)
    seen = set()
    for seed in range(20):  # in some orders both pairs are in flight at once, in others one after the other
        plan, _ = plan_without_scene(document, PlanOptions(order="random", seed=seed))
        best, _ = plan_without_scene(document, PlanOptions(order="memory", seed=seed))
        advice = [entry.used for entry in advise(document, plan) if entry.change == "order"]
        assert advice == ([best.totals.used] if best.totals.used < plan.totals.used else [])
        seen.add(bool(advice))
    assert seen == {True, False}


def test_long_plans_get_none(tmp_path: Path) -> None:
    passes = "".join(
        f"  p{n}: {{node: fullscreen, write: {{o_color: a}}, set: {{shader: paint.frag}}, keep: true"
        + (f", after: [p{n - 1}]}}\n" if n else "}\n")
        for n in range(LONGEST)
    )
    last = f"  show: {{node: tonemap, read: {{color: a}}, write: {{color: image}}, after: [p{LONGEST - 1}]}}\n"
    path = write_graph(tmp_path, passes=passes + last)
    plan = plan_of(path)
    assert len(plan.order) > LONGEST
    assert advise(load_document(path), plan) == ()
