"""The meter held against its reference: healthy in every mode, and with mistakes put into its shaders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from judged import judge_node, judge_run, passes_of
from observed import mistake

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.exposure import reference

FRAMES = "frame.count=3"
MEASURES = ("exposure", "meter", "adaptation", "texels")


@pytest.mark.gpu
@pytest.mark.parametrize("settings", [
    (), ("mode=average",), ("mode=average", "stride=3"), ("mode=manual", "compensation=-1.5"), ("stride=5",),
    ("low=0", "high=1"), ("compensation=2",),
])  # fmt: skip
def test_within_tolerance(device: Device, settings: tuple[str, ...]) -> None:
    judged = judge_node(device, "exposure", FRAMES, *(f"passes.meter.set.{s}" for s in settings))
    assert (judged.above, judged.within, judged.broken) == ((), MEASURES, ())


@pytest.mark.gpu
@pytest.mark.parametrize(("file", "right", "wrong", "caught"), [
    ("histogram.comp", "bins_per_ev + 0.5)", "bins_per_ev)", "meter"),
    ("reduce_histogram.comp", "u_high * float(total)", "float(total)", "meter"),
    ("reduce_histogram.comp", "float(bin) / 255.0", "float(bin) / 256.0", "meter"),
    ("meter.glsl", "tile * STRIDE;", "tile * STRIDE + 1;", "texels"),
    ("adapt.glsl", "u_brighten : u_darken", "u_darken : u_brighten", "adaptation"),
    ("adapt.glsl", "exp2(u_compensation + ", "exp2(", "adaptation"),
    ("adapt.glsl", "if (exposure_previous.scale > 0.0)", "if (false)", "adaptation"),
])  # fmt: skip
def test_mistakes_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str, caught: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    settings = ("compensation=0.5", "brighten=0.1", "darken=0.6")
    assert caught in judge_node(device, "exposure", FRAMES, *(f"passes.meter.set.{s}" for s in settings)).above


@pytest.mark.gpu
def test_the_plain_mean_grows_worse_with_the_stride(device: Device) -> None:
    errors = [
        judge_node(device, "exposure", "frame.count=1", "passes.meter.set.mode=average", f"passes.meter.set.stride={s}")
        .values["exposure"]
        for s in (1, 4, 16)
    ]  # fmt: skip
    assert errors == sorted(errors, key=lambda e: e or 0.0)
    assert (errors[0] or 0.0) < 1e-5 < (errors[1] or 0.0)


@pytest.fixture(scope="module")
def metered(session_device: object) -> PassRun:
    return passes_of(session_device, "exposure", "exposure", FRAMES)["meter"]  # type: ignore[arg-type]


def written(run: PassRun, **values: float) -> PassRun:
    words = np.array(run.outputs["exposure"], np.uint32)
    for name, value in values.items():
        at = reference.Metered._fields.index(name)
        words[at] = int(value) if name == "texels" else np.float32(value).view(np.uint32)
    return replace(run, outputs={"exposure": words})


@pytest.mark.gpu
@pytest.mark.parametrize("wrong", [{"scale": 0.0}, {"scale": np.nan}, {"log_luminance": 30.0}, {"texels": 1e6}])
def test_invariants_can_break(metered: PassRun, wrong: dict[str, float]) -> None:
    assert list(reference.invariants(metered)) == []
    assert len(list(reference.invariants(written(metered, **wrong)))) == 1


@pytest.mark.gpu
def test_nothing_finite_keeps_the_last_exposure(metered: PassRun) -> None:
    image = np.full_like(metered.inputs["color"], np.nan)
    last = reference.read(metered.inputs["previous"])
    blind = replace(metered, inputs={**metered.inputs, "color": image})
    kept = written(blind, scale=last.scale, log_luminance=last.log_luminance, measured=last.log_luminance, texels=0)
    assert judge_run("exposure", kept).above == ()
    assert judge_run("exposure", written(kept, scale=1.1 * last.scale)).above == ("exposure", "adaptation")
