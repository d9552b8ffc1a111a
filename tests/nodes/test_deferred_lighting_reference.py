"""Lit G-buffers against the float64 light model: images within their format's tolerance, and mistakes caught."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from observed import SMALL, above, broken_invariants, half_texel, judge, mistake, observe_graph, with_output

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.deferred_lighting.reference import bilinear

GRAPH = ("deferred_shading", *SMALL, "resources.shadow.fixed=[512, 512]")
FLOATS = ("resources.hdr.format=rgba32f",)


@pytest.fixture(scope="module")
def spheres(session_device: Device) -> PassRun:
    pytest.importorskip("embreex")
    return observe_graph(session_device, *GRAPH, *FLOATS, scene="spheres")["light"]


@pytest.mark.gpu
def test_spheres_are_within_tolerance(spheres: PassRun) -> None:
    assert above("deferred_lighting", spheres) == []
    assert broken_invariants("deferred_lighting", spheres) == []


@pytest.mark.gpu
@pytest.mark.parametrize("settings", [
    ("resources.hdr.format=rgba16f",), ("resources.hdr.format=r11g11b10f",), ("frame.depth=standard",),
    ("resources.normal.format=rg8",), ("resources.depth.format=d16",), ("passes.light.set.shadow_taps=1",),
    ("passes.light.set.shadow_taps=4",), ("resources.shadow.layers=1", "passes.shadows.set.cascades=1"),
], ids=lambda settings: settings[0].rpartition(".")[2])  # fmt: skip
def test_variants_are_within_tolerance(device: Device, settings: tuple[str, ...]) -> None:
    assert above("deferred_lighting", observe_graph(device, *GRAPH, *settings, scene="spheres")["light"]) == []


@pytest.mark.gpu
@pytest.mark.parametrize("scene", ["cornell", "atrium"])
def test_other_scenes_are_within_tolerance(device: Device, scene: str) -> None:
    run = observe_graph(device, "deferred_shading", *SMALL, scene=scene)["light"]
    assert above("deferred_lighting", run) == (["traced?"] if scene == "cornell" else [])  # it has no sun


@pytest.mark.gpu
def test_hundreds_of_local_lights_are_within_tolerance(device: Device) -> None:
    run = observe_graph(device, "deferred_lighting", *SMALL, "scene.lights.points.count=100", *FLOATS)["light"]
    assert above("deferred_lighting", run) == ["traced?"]
    assert "color" in above("deferred_lighting", replace(run, scene=replace(run.scene, lights=run.scene.lights[:97])))


@pytest.mark.gpu
def test_lights_that_run_circles_are_where_they_are_in_the_frame(device: Device) -> None:
    circling = ("scene.lights.points.count=40", "scene.lights.points.circle=1.5", "frame.count=3")
    run = observe_graph(device, "deferred_lighting", *SMALL, *circling, *FLOATS)["light"]
    assert above("deferred_lighting", run) == ["traced?"]
    assert "color" in above("deferred_lighting", replace(run, index=0))


@pytest.mark.gpu
def test_the_shadow_maps_cost_is_seen_beside_the_implementation(device: Device) -> None:
    """A coarse map is far from the traced image, and computed as it should be."""
    errors = {}
    for size in (64, 1024):
        settings = (*SMALL, f"resources.shadow.fixed=[{size}, {size}]")
        run = observe_graph(device, "deferred_shading", *settings, scene="spheres")["light"]
        assert "color" not in above("deferred_lighting", run)
        truth = judge("deferred_lighting", run)["traced"]
        errors[size] = float(np.abs(truth.judged - truth.value)[truth.mask].mean())
    assert errors[64] > 3.0 * errors[1024]


@pytest.mark.gpu
def test_mistakes_in_the_image_are_caught(spheres: PassRun) -> None:
    color = spheres.outputs["color"]
    assert "color" in above("deferred_lighting", with_output(spheres, "color", half_texel(color)))
    assert "color" in above("deferred_lighting", with_output(spheres, "color", color * 1.01))
    haunted = color.copy()
    haunted[spheres.inputs["depth"][..., 0] == 0.0] = 0.05
    assert "color" in above("deferred_lighting", with_output(spheres, "color", haunted))
    assert broken_invariants("deferred_lighting", with_output(spheres, "color", haunted))
    assert broken_invariants("deferred_lighting", with_output(spheres, "color", color - 1.0))
    assert broken_invariants("deferred_lighting", with_output(spheres, "color", np.full_like(color, np.inf)))


@pytest.mark.gpu
@pytest.mark.parametrize(("file", "right", "wrong"), [
    ("shadow.glsl", "position += normal *", "position -= normal *"),
    ("shadow.glsl", "0.5 * float(SHADOW_TAPS - 1)", "0.5 * float(SHADOW_TAPS)"),
    ("shading.glsl", "frame.camera.xyz - position", "position - frame.camera.xyz"),
    ("shading.glsl", "reflect(-b.view, b.normal)", "reflect(b.view, b.normal)"),
    ("deferred_lighting.frag", "gl_FragCoord.xy / vec2", "(gl_FragCoord.xy + 0.5) / vec2"),
], ids=["sign of the bias", "half a texel off", "sign of the view", "sign of the mirror", "half a pixel"])  # fmt: skip
def test_mistakes_in_the_shaders_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    run = observe_graph(device, *GRAPH, *FLOATS, scene="spheres")["light"]
    assert "color" in above("deferred_lighting", run)


@pytest.mark.gpu
def test_a_missing_normalise_is_caught(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    mistake(monkeypatch, "octahedral.glsl", "return normalize(n);", "return n;")
    assert "color" in above("deferred_lighting", observe_graph(device, *GRAPH, *FLOATS, scene="spheres")["light"])


def test_resampling_by_hand() -> None:
    values = np.array([[0.0, 1.0], [2.0, 3.0]])
    assert bilinear(values, 2, 2) == pytest.approx(values)
    assert bilinear(values, 1, 1) == pytest.approx(np.array([[1.5]]))
    assert bilinear(values, 4, 4)[0] == pytest.approx(np.array([0.0, 0.25, 0.75, 1.0]))
