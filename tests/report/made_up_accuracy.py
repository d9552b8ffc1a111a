"""A judged run, made up without a device: a pass within, one above, one that cannot be judged, one without a truth."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from rendergraph.measure.truth.accuracy import PassAccuracy
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.judgement import Judgement
from rendergraph.measure.truth.stochastic import judge_frames
from rendergraph.node.reference import Quantity, Truth
from rendergraph.plan.plan import Plan
from rendergraph.report.accuracy import accuracy_record
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import timing_record
from tests.measure.truth.made_up_runs import image, make_node, measure, run
from tests.report.made_up import made_up_plan, made_up_result

SHAPE = (12, 16, 3)


def judged(
    name: str, error: float, *, quantity: Quantity = Quantity.DISPLAY, port: str = "color", own: float = 0.0
) -> Judgement:
    """A pass's measure ``color``: off by ``error`` in one texel, with a tolerance of 0.1."""
    truth = np.linspace(0.2, 0.7, 12 * 16 * 3).reshape(SHAPE)
    output, mask = truth.copy(), np.ones(SHAPE[:2], bool)
    output[5, 3] += error
    mask[0, :4] = False
    node = make_node(
        lambda run: {"color": Truth(truth, mask=mask, standard_error=own)},
        {"color": measure("max", 0.1, quantity, port)},
        source="Somebody 1999",
    )
    (found,) = judge_pass(name, node, run({port: output}, inputs={"depth": image(0.25, (12, 16, 1))}))
    return found


def judged_noise(name: str, bias: float = 0.0) -> Judgement:
    """A random pass's measure."""
    node = make_node(
        lambda run: {"noise": Truth(image(0.5, (12, 16, 1)))},
        {"noise": measure("rmse", 0.0, Quantity.SHARE)},
        stochastic=True,
    )
    frames = np.random.default_rng(4).normal(0.5 + bias, 0.1, (16, 12, 16, 1))
    return judge_frames(name, node, [run({"out": frame}, index=i) for i, frame in enumerate(frames)])[0]


def made_up_passes(error: float = 0.05) -> tuple[PassAccuracy, ...]:
    """Passes of the shipped graph ``deferred_shading``."""
    return (
        PassAccuracy("gbuffer", "gbuffer", (judged("gbuffer", np.nan, quantity=Quantity.SCALAR),)),
        PassAccuracy(
            "light", "deferred_lighting", (judged("light", 0.3, quantity=Quantity.RADIANCE),), ("it <b>shines",)
        ),
        PassAccuracy("shadows", "shadow_map", (judged_noise("shadows"),)),
        PassAccuracy("sky", "sky", (judged("sky", 0.0, own=1.0),)),
        PassAccuracy("tonemap", "tonemap", (judged("tonemap", error),)),
        PassAccuracy("meter", "exposure", reason="the node has no reference"),
    )


def made_up_accuracy(error: float = 0.05, plan: Plan | None = None) -> dict[str, Any]:
    """The record of :func:`made_up_passes`."""
    plan = plan or made_up_plan()
    timing, resources = timing_record(made_up_result(plan), "made up"), resources_record(plan, "made up")
    record = accuracy_record(made_up_passes(error), plan.graph.frame, timing, resources)
    made: dict[str, Any] = json.loads(json.dumps(record, allow_nan=False))
    return made
