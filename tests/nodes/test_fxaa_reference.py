"""Anti-aliasing held against 64 samples a pixel and against its own filter; what its knobs buy, measured."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from judged import judge_node, passes_of
from observed import mistake

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.fxaa import reference


@pytest.fixture(scope="module")
def smoothed(session_device: Device) -> PassRun:
    return passes_of(session_device, "fxaa", "fxaa")["antialias"]


@pytest.mark.gpu
@pytest.mark.parametrize("graph", ["fxaa", "deferred_shading"])
def test_within_tolerance(device: Device, graph: str) -> None:
    detail = ("scene.detail=0",) if graph == "deferred_shading" else ()
    judged = judge_node(device, "fxaa", *detail, graph=graph)
    assert (judged.above, judged.within, judged.broken) == ((), ("filter", "coverage"), ())


@pytest.mark.gpu
@pytest.mark.parametrize(("right", "wrong"), [
    ("float(distance) - 0.5 * float(stride(step))", "float(distance)"),
    ("!= (m < edge_luma)", "== (m < edge_luma)"),
    ("0.25 * abs(m - beyond)", "0.5 * abs(m - beyond)"),
    ("clamp(texel, ivec2(0), limit)", "clamp(texel + 1, ivec2(0), limit)"),
    ("2.0 * (n + s + e + w)", "1.0 * (n + s + e + w)"),
])  # fmt: skip
def test_mistakes_are_caught(device: Device, monkeypatch: pytest.MonkeyPatch, right: str, wrong: str) -> None:
    mistake(monkeypatch, "fxaa.frag", right, wrong)
    assert "filter" in judge_node(device, "fxaa").above


@pytest.mark.gpu
def test_a_filter_that_does_harm_is_above(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """The ideal measure by itself: worse than no filter at all."""
    mistake(monkeypatch, "fxaa.frag", "0.5 - nearest.y", "1.4 - nearest.y")
    judged = judge_node(device, "fxaa")
    assert judged.above == ("filter", "coverage")
    assert len(judged.broken) == 1


@pytest.mark.gpu
def test_invariants_can_break(smoothed: PassRun) -> None:
    assert list(reference.invariants(smoothed)) == []
    for channel in (0, 3):
        bad = np.array(smoothed.outputs["color"])
        bad[20, 30, channel] = 1.0 - bad[20, 30, channel]
        assert len(list(reference.invariants(replace(smoothed, outputs={"color": bad})))) == 1


@pytest.mark.gpu
def test_without_a_larger_input_coverage_is_not_known(smoothed: PassRun) -> None:
    truth = reference.judge(replace(smoothed, supersampled=None))["coverage"]
    assert truth.mask is not None
    assert not truth.mask.any()


@pytest.mark.gpu
@pytest.mark.parametrize(("knob", "values"), [
    ("search_steps", (1, 2, 4, 8, 12)), ("edge_threshold", (1.0, 0.5, 0.333, 0.125)),
    ("edge_minimum", (0.5, 0.25, 0.1, 0.0)),
])  # fmt: skip
def test_error_falls_along_each_quality_knob(device: Device, knob: str, values: tuple[float, ...]) -> None:
    errors = [judge_node(device, "fxaa", f"passes.antialias.set.{knob}={v}").values["coverage"] or 0.0 for v in values]
    assert all(after <= 1.001 * before for before, after in pairwise(errors))
    assert errors[-1] < 0.9 * errors[0]


@pytest.mark.gpu
def test_softening_has_its_best_in_the_middle(device: Device) -> None:
    """Why ``subpixel`` is no quality knob: neither end of it is the more accurate one."""
    ends_and_middle = [
        judge_node(device, "fxaa", f"passes.antialias.set.subpixel={v}").values["coverage"] or 0.0 for v in (0, 0.5, 1)
    ]
    assert ends_and_middle[1] < 0.95 * min(ends_and_middle[0], ends_and_middle[2])
