"""Tone mapping held against its reference: healthy, with mistakes put into its shaders, and with its output spoilt."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from graph_run import RADIANCE
from judged import judge_node, judge_run, passes_of
from observed import mistake

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.tonemap import reference

CURVES = ("agx", "aces", "reinhard", "linear")


@pytest.mark.gpu
@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("dither", ["none", "ordered", "triangular"])
def test_within_tolerance(device: Device, curve: str, dither: str) -> None:
    run = passes_of(device, "tonemap", "tonemap", f"passes.through_{curve}.set.dither={dither}")[f"through_{curve}"]
    judged = judge_run("tonemap", run)
    assert (judged.above, judged.within, judged.broken) == ((), ("color", "display"), ())


@pytest.mark.gpu
def test_what_is_no_number(device: Device, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """NaN and negatives are black, infinities white; without the check of bits the reference says so."""
    (tmp_path / "radiance.frag").write_text(RADIANCE)
    graph = {
        "rendergraph": 1,
        "resources": {"hdr": {"format": "rgba32f"}},
        "passes": {
            "paint": {"node": "fullscreen", "write": {"color": "hdr"}, "set": {"shader": "radiance.frag"}},
            "map": {"node": "tonemap", "read": {"color": "hdr"}, "write": {"color": "image"}},
        },
        "outputs": {"image": {"file": "image.png"}},
    }
    (tmp_path / "graph.yaml").write_text(yaml.safe_dump(graph))
    run = passes_of(device, str(tmp_path / "graph.yaml"), "tonemap")["map"]
    assert np.isnan(run.inputs["color"]).any()
    assert np.isinf(run.inputs["color"]).any()
    assert judge_run("tonemap", run).above == ()
    mistake(monkeypatch, "colour.glsl", "mix(radiance, vec3(0.0), bvec3", "mix(radiance, vec3(1.0), bvec3")
    assert "color" in judge_run("tonemap", passes_of(device, str(tmp_path / "graph.yaml"), "tonemap")["map"]).above


@pytest.mark.gpu
def test_with_a_metered_exposure(device: Device) -> None:
    run = passes_of(device, "exposure", "tonemap", "frame.count=2")["tonemap"]
    assert "exposure" in run.inputs
    assert judge_run("tonemap", run).above == ()
    doubled = np.array(run.inputs["exposure"])
    doubled[:1] = (doubled[:1].view(np.float32) * 2).view(np.uint32)
    spoilt = replace(run, inputs={**run.inputs, "exposure": doubled})
    assert judge_run("tonemap", spoilt).above == ("color", "display")


@pytest.mark.gpu
@pytest.mark.parametrize(("curve", "file", "right", "wrong"), [
    ("agx", "agx.frag", "SLOPE = 2.0", "SLOPE = 2.05"),
    ("agx", "agx.frag", "clamp(stops, 0.0, 1.0)", "stops"),
    ("aces", "aces.frag", "0.0245786", "0.0345786"),
    ("reinhard", "reinhard.frag", "(1.0 + scene)", "(1.02 + scene)"),
    ("linear", "colour.glsl", "- 0.055;", "- 0.050;"),
    ("agx", "tonemap.glsl", "ivec2(gl_FragCoord.xy)", "ivec2(gl_FragCoord.xy + 1.0)"),
    ("agx", "dither.glsl", "noise * room", "noise * room * 0.5"),
    ("agx", "dither.glsl", "key + 1u", "key"),
])  # fmt: skip
def test_mistakes_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, curve: str, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    run = passes_of(device, "tonemap", "tonemap")[f"through_{curve}"]
    assert "color" in judge_run("tonemap", run).above


def spoilt(run: PassRun, output: np.ndarray) -> PassRun:
    return replace(run, outputs={"color": output})


@pytest.mark.gpu
def test_invariants_can_break(device: Device) -> None:
    run = passes_of(device, "tonemap", "tonemap", "passes.through_agx.set.dither=none")["through_agx"]
    out = np.asarray(run.outputs["color"])
    assert list(reference.invariants(run)) == []
    negative, transparent, reversed_ramp = out.copy(), out.copy(), out.copy()
    negative[0, 0, 0] = np.nan
    transparent[3, 4, 3] = 0.5
    reversed_ramp[..., :3] = 1.0 - out[..., :3]
    for bad in (negative, transparent, reversed_ramp):
        assert len(list(reference.invariants(spoilt(run, bad)))) == 1


@pytest.mark.gpu
def test_dither_costs_what_theory_says(device: Device) -> None:
    """In steps: rounding alone 1 / sqrt(12), with Bayer's or triangular noise up to a half."""
    rmse = {
        dither: judge_node(
            device, "tonemap", "passes.through_aces.set.curve=agx", f"passes.through_aces.set.dither={dither}"
        ).values["display"]
        for dither in ("none", "ordered", "triangular")
    }
    steps = {dither: (value or 0.0) * 255 for dither, value in rmse.items()}
    assert steps["none"] == pytest.approx(12**-0.5, rel=0.1)
    assert steps["none"] < steps["ordered"] < steps["triangular"] == pytest.approx(0.5, rel=0.15)
