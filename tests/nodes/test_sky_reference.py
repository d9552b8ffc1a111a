"""The sky held against its reference: healthy, with mistakes put into its shaders, and drawn where it must not be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from judged import judge_node, judge_run, passes_of
from observed import mistake

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.sky import reference


@pytest.fixture(scope="module")
def seen(session_device: Device) -> PassRun:
    return passes_of(session_device, "sky", "sky")["sky"]


@pytest.mark.gpu
def test_within_tolerance(seen: PassRun) -> None:
    judged = judge_run("sky", seen)
    assert (judged.above, judged.within, judged.broken) == ((), ("radiance", "daylight"), ())
    far, sure = reference.where_far(seen)
    assert 0.2 < far.mean() < 0.9
    assert sure.all()


@pytest.mark.gpu
def test_everywhere_without_depth(device: Device) -> None:
    run = passes_of(device, "sky", "sky", "passes.sky.read={}", "passes.sky.after=[]")["sky"]
    assert "depth" not in run.inputs
    assert judge_run("sky", run).above == ()


@pytest.mark.gpu
@pytest.mark.parametrize(("file", "right", "wrong"), [
    ("preetham.glsl", "0.1787", "0.1797"),
    ("preetham.glsl", "max(direction.y, 1.0e-3)", "max(direction.y, 1.0e-1)"),
    ("analytic.frag", "frame.sun_direction.xyz", "-frame.sun_direction.xyz"),
    ("analytic.frag", "(strength / u_sun_illuminance)", "(strength * 0.01 / u_sun_illuminance)"),
    ("analytic.frag", "PI * sine * sine", "PI * sine"),
    ("horizon.glsl", "smoothstep(-u_horizon", "smoothstep(0.0"),
    ("sky.vert", "vec4(corner, 1.0 - far, 1.0)", "vec4(corner + frame.viewport.zw, 1.0 - far, 1.0)"),
])  # fmt: skip
def test_mistakes_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    assert judge_node(device, "sky").above == ("radiance", "daylight")


@pytest.mark.gpu
def test_a_sky_in_front_of_geometry_is_caught(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    mistake(monkeypatch, "sky.vert", "gl_Position = vec4(corner, far, 1.0)", "gl_Position = vec4(corner, 0.5, 1.0)")
    judged = judge_node(device, "sky")
    assert "radiance" in judged.above
    assert len(judged.broken) == 1


@pytest.mark.gpu
def test_invariants_can_break(seen: PassRun) -> None:
    far, _ = reference.where_far(seen)
    y, x = (int(v[0]) for v in np.nonzero(far))
    for channel, value in ((0, -1e-6), (1, np.nan), (2, 65000.0), (3, 0.5)):
        bad = np.array(seen.outputs["color"])
        bad[y, x, channel] = value
        assert list(reference.invariants(replace(seen, outputs={"color": bad})))


@pytest.mark.gpu
def test_the_gradient_is_no_daylight(device: Device) -> None:
    analytic, gradient = (
        judge_node(device, "sky", f"passes.sky.set.model={model}").values["daylight"] or 0.0
        for model in ("analytic", "gradient")
    )
    assert analytic < 1e-6
    assert gradient > 1e-2
