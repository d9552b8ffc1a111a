"""Verdicts: within, above, cannot judge; masks, worst texels, and references that do not do what they must."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.invariants import broken_invariants
from rendergraph.measure.truth.judge import Judgement, judge_pass, why_not_judged
from rendergraph.node.reference import Measure, Quantity, Truth
from tests.measure.truth.made_up_runs import image, make_node, measure, run


def judge_one(
    truth: Truth, output: Any, declared: Measure | None = None, *, inputs: Mapping[str, Any] | None = None, **more: Any
) -> Judgement:
    node = make_node(lambda run: {"it": truth}, {"it": declared or measure()}, **more)
    (judged,) = judge_pass("p", node, run({"out": output}, inputs=inputs or {}))
    return judged


@pytest.mark.parametrize(("value", "verdict"), [(0.09, "within"), (0.11, "above"), (0.1, "within")])
def test_a_value_is_held_against_its_tolerance(value: float, verdict: str) -> None:
    judged = judge_one(Truth(image()), image(value))
    assert (judged.verdict, judged.value, judged.tolerance, judged.metric) == (verdict, value, 0.1, "max")
    assert {"max", "mean", "rmse", "not_finite"} <= set(judged.metrics)
    assert (judged.pass_name, judged.node, judged.measure, judged.method) == ("p", "made_up", "it", "analytic")


def test_the_truth_may_state_another_tolerance() -> None:
    assert judge_one(Truth(image(), tolerance=0.2), image(0.15)).verdict == "within"
    assert judge_one(Truth(image(), tolerance=0.0), image(0.05)).verdict == "above"


def test_what_the_reference_derives_is_judged_in_place_of_the_output() -> None:
    assert judge_one(Truth(image(), judged=image(0.05)), image(9.0), measure(port="")).verdict == "within"


@pytest.mark.parametrize(("error", "verdict"), [(0.1 / 3 - 1e-6, "within"), (0.1 / 3 + 1e-6, "cannot_judge")])
@pytest.mark.parametrize("metric", ["max", "mean", "rmse"])
def test_a_truth_that_is_not_sure_enough_cannot_judge(metric: str, error: float, verdict: str) -> None:
    judged = judge_one(Truth(image(), standard_error=error), image(), measure(metric))
    assert judged.verdict == verdict
    assert judged.standard_error == pytest.approx(3 * error)
    assert judged.reason == ("standard_error" if verdict == "cannot_judge" else "")


def test_an_uncertain_truth_never_passes_even_where_the_values_agree() -> None:
    assert judge_one(Truth(image(), standard_error=1e-9), image(), measure(tolerance=0.0)).verdict == "cannot_judge"
    assert judge_one(Truth(image()), image(), measure(tolerance=0.0)).verdict == "within"
    assert judge_one(Truth(image(), standard_error=np.nan), image()).verdict == "cannot_judge"


def test_a_normals_uncertainty_counts_although_it_lies_along_the_normal() -> None:
    normal = np.broadcast_to(np.ones(3) / np.sqrt(3), (4, 6, 3)).copy()
    declared = measure(quantity=Quantity.NORMAL, tolerance=1.0)
    assert judge_one(Truth(normal, standard_error=0.02), normal, declared).verdict == "cannot_judge"
    assert judge_one(Truth(normal, standard_error=0.001), normal, declared).verdict == "within"


@pytest.mark.parametrize(("level", "verdict"), [(45.0, "above"), (35.0, "within")])
def test_more_is_better_for_some_metrics(level: float, verdict: str) -> None:
    declared = measure("psnr", level, Quantity.SHARE)  # an error of 0.01 everywhere is 40 dB
    assert judge_one(Truth(image(0.5)), image(0.51), declared).verdict == verdict
    judged = judge_one(Truth(image(0.5)), image(0.5), declared)
    assert (judged.verdict, judged.value) == ("within", None)
    assert judge_one(Truth(image(0.5), standard_error=0.01), image(0.5), declared).verdict == "cannot_judge"


def test_what_is_masked_counts_for_nothing() -> None:
    output, mask = image(), np.ones((4, 6), bool)
    output[0, 1:], mask[0, 1:] = np.nan, False
    judged = judge_one(Truth(image(), mask=mask), output)
    assert (judged.verdict, judged.masked) == ("within", pytest.approx(5 / 24))
    assert judge_one(Truth(image()), output).verdict == "above"


def test_a_truth_that_is_known_nowhere_cannot_judge() -> None:
    judged = judge_one(Truth(image(), mask=np.zeros((4, 6), bool)), image())
    assert (judged.verdict, judged.reason, judged.masked, judged.value) == ("cannot_judge", "all_masked", 1.0, None)


@pytest.mark.parametrize("metric", ["mean", "p50"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_one_texel_that_is_not_finite_is_above_any_tolerance(metric: str, bad: float) -> None:
    output = image()
    output[2, 3] = bad
    judged = judge_one(Truth(image()), output, measure(metric, 1e30))
    assert (judged.verdict, judged.reason) == ("above", "not_finite")
    assert judged.worst_texel is not None
    assert (judged.worst_texel.x, judged.worst_texel.y) == (3, 2)


def test_the_worst_texel_comes_with_its_inputs() -> None:
    output, depth, small = image(0.01), image(0.25), np.zeros((2, 3, 1))
    output[3, 5], depth[3, 5] = -0.07, 0.75
    judged = judge_one(Truth(image()), output, inputs={"depth": depth, "small": small})
    worst = judged.worst_texel
    assert worst is not None
    assert (worst.x, worst.y, worst.judged, worst.true) == (5, 3, (-0.07,), (0.0,))
    assert worst.error == pytest.approx(0.07)
    assert worst.inputs == {"depth": (0.75,)}


def test_layers_and_buffers_are_judged_whole() -> None:
    layers = np.zeros((3, 4, 6, 1))
    wrong = layers.copy()
    wrong[2, 1, 4] = 1.0
    judged = judge_one(Truth(layers), wrong)
    assert judged.worst_texel is not None
    assert (judged.verdict, judged.worst_texel.y, judged.worst_texel.x) == ("above", 2 * 4 + 1, 4)
    words = np.arange(5, dtype=np.uint32)
    assert judge_one(Truth(words.astype(np.float64)), words, measure(tolerance=0.0)).verdict == "within"
    assert judge_one(Truth(words.astype(np.float64)), words + 1, measure(tolerance=0.0)).verdict == "above"


def test_flip_is_left_out_on_request_but_not_where_it_decides() -> None:
    pytest.importorskip("flip_evaluator")
    shade = image(0.5, (4, 6, 3))
    for metric, expected in (("rmse", False), ("flip", True)):
        node = make_node(lambda run: {"it": Truth(shade)}, {"it": measure(metric, quantity=Quantity.DISPLAY)})
        (quick,) = judge_pass("p", node, run({"out": shade}), flip=False)
        (whole,) = judge_pass("p", node, run({"out": shade}))
        assert ("flip" in quick.metrics, "flip" in whole.metrics) == (expected, True)


# ---- nodes without a declared reference


def test_a_node_without_a_reference_is_not_judged() -> None:
    node = make_node(None)
    assert judge_pass("p", node, run({"out": image()})) == ()
    assert why_not_judged(node)
    assert why_not_judged(make_node(None, exact=True)) != why_not_judged(node)


@pytest.mark.parametrize(("format", "offset", "verdict"), [("r32f", 1e-12, "above"), ("r32f", 0.0, "within")])
def test_an_exact_node_must_equal_its_truth(format: str, offset: float, verdict: str) -> None:
    node = make_node(lambda run: {"out": Truth(image(0.5))}, exact=True)
    assert why_not_judged(node) == ""
    (judged,) = judge_pass("p", node, run({"out": image(0.5 + offset)}, format=format))
    assert (judged.verdict, judged.tolerance, judged.measure) == (verdict, 0.0, "out")


def test_an_exact_node_of_integers_is_judged_by_mismatches() -> None:
    node = make_node(lambda run: {"out": Truth(image(7.0))}, exact=True)
    output = image(7.0)
    output[0, 0] = 8.0
    (judged,) = judge_pass("p", node, run({"out": output}, format="r32ui"))
    assert (judged.quantity, judged.verdict, judged.value) == (Quantity.IDENTITY, "above", pytest.approx(1 / 24))


def test_a_reference_may_decline_a_pass() -> None:
    node = make_node(lambda run: {"out": Truth(image())}, exact=True)
    assert why_not_judged(node, run({"out": image()})) == ""
    module: Any = sys.modules["made_up_node.reference"]
    module.why_not = lambda run: "it is late" if run.index else ""
    assert why_not_judged(node, run({"out": image()})) == ""
    assert why_not_judged(node, run({"out": image()}, index=1)) == "it is late"


# ---- references that do not do what they must


def _raises(run: Any) -> Any:
    raise ZeroDivisionError("as it happens")


@pytest.mark.parametrize(
    ("judge", "declared"),
    [
        (_raises, measure()),
        (lambda run: {}, measure()),
        (lambda run: {"it": Truth(image()), "more": Truth(image())}, measure()),
        (lambda run: {"it": image()}, measure()),
        (lambda run: None, measure()),
        (lambda run: {"it": Truth(image(shape=(4, 5, 1)))}, measure()),
        (lambda run: {"it": Truth(np.zeros(()))}, measure()),
        (lambda run: {"it": Truth(image(), mask=np.ones((2, 2), bool))}, measure()),
        (lambda run: {"it": Truth(image(), standard_error=np.ones((9, 9, 9)))}, measure()),
        (lambda run: {"it": Truth(image())}, measure("no_such_metric")),
        (lambda run: {"it": Truth(image())}, measure(port="no_such_port")),
        (None, measure()),
    ],
)
def test_a_reference_that_fails_is_a_diagnostic(judge: Any, declared: Measure) -> None:
    node = make_node(judge, {"it": declared})
    with pytest.raises(RenderGraphError) as failed:
        judge_pass("p", node, run({"out": image()}))
    (found,) = failed.value.diagnostics
    assert (found.code, found.data["name"], found.data["node"]) == ("RG744", "p", "made_up")


# ---- invariants


def test_outputs_outside_their_bounds_are_found() -> None:
    node = make_node(None)
    node.bounds = {"out": (0.0, 1.0)}
    output = image(0.5)
    assert broken_invariants("p", node, run({"out": output})) == ()
    for bad in (1.01, -0.01, np.nan, np.inf):
        output[1, 2] = bad
        (sentence,) = broken_invariants("p", node, run({"out": output}))
        assert "[1, 2, 0]" in sentence


def test_a_nodes_own_invariants_are_asked() -> None:
    node = make_node(lambda run: {"it": Truth(image())}, {"it": measure()})

    def invariants(run: Any) -> Iterator[str]:
        if run.outputs["out"].max() > 1:
            yield "more than one"

    module: Any = sys.modules["made_up_node.reference"]
    module.invariants = invariants
    assert broken_invariants("p", node, run({"out": image(0.5)})) == ()
    assert broken_invariants("p", node, run({"out": image(2)})) == ("more than one",)
    module.invariants = _raises
    with pytest.raises(RenderGraphError):
        broken_invariants("p", node, run({"out": image()}))
