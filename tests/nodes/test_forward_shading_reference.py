"""Forward shading against rays and the float64 light model, glass included, and mistakes caught."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from observed import (
    SMALL,
    above,
    broken_invariants,
    half_texel,
    judge,
    mistake,
    observe_graph,
    observe_scene,
    with_output,
)

from rendergraph.device.context import Device
from rendergraph.measure.truth.surfaces import cached_trace
from rendergraph.node.reference import PassRun
from rendergraph.nodes.forward_shading.reference import composite
from rendergraph.scene.scene import Alpha, Ambient, Camera, Light, Material, Scene, Sun
from tests.measure.truth.traced_scenes import quads

pytestmark = pytest.mark.gpu

GRAPH = ("shadow_map", *SMALL, "resources.shadow.fixed=[512, 512]", "resources.hdr.format=rgba32f")


@pytest.fixture(scope="module")
def spheres(session_device: Device) -> PassRun:
    pytest.importorskip("embreex")
    return observe_graph(session_device, *GRAPH)["shade"]


def test_spheres_are_within_tolerance(spheres: PassRun) -> None:
    assert above("forward_shading", spheres) == []
    assert judge("forward_shading", spheres)["color"].mask.mean() > 0.2
    assert broken_invariants("forward_shading", spheres) == []


@pytest.mark.parametrize("settings", [
    ("resources.hdr.format=rgba16f",), ("resources.hdr.format=r11g11b10f",), ("frame.depth=standard",),
    ("passes.shade.set.prepass=full",), ("passes.shade.set.shadow_taps=5",), ("scene.source=cornell",),
], ids=lambda settings: settings[0].rpartition(".")[2])  # fmt: skip
def test_variants_are_within_tolerance(device: Device, settings: tuple[str, ...]) -> None:
    assert set(above("forward_shading", observe_graph(device, *GRAPH, *settings)["shade"])) <= {"traced?"}


def test_the_atriums_glass_is_within_tolerance(device: Device) -> None:
    run = observe_graph(device, "deferred_shading", *SMALL, "resources.shadow.fixed=[512, 512]")["glass"]
    truth = judge("forward_shading", run)["color"]
    assert truth.mask.sum() > 50
    assert above("forward_shading", run, least=0.0) == []
    nothing = with_output(run, "color", run.before["color"])  # the twin: no glass at all
    assert "color" in above("forward_shading", nothing, least=0.0)


# ---------------------------------------------------------------- transparency

PANES = """\
rendergraph: 1
frame: {size: [48, 48]}
scene: {source: spheres}
resources:
  shadow: {format: d32f, fixed: [256, 256], layers: 2}
  cascades: {bytes: 320}
  hdr: {format: rgba32f}
passes:
  shadows: {node: shadow_map, write: {map: shadow, cascades: cascades}}
  shade: {node: forward_shading, read: {shadow_map: shadow, cascades: cascades}, write: {color: hdr}}
outputs: {hdr: {file: hdr.npy}}
"""


def panes() -> Scene:
    """A floor, a lamp, and three panes that overlap, one of them lying the other way round and seen from both sides."""
    floor = [[-4, 0, 4], [8, 0, 0], [0, 0, -8]]
    near, middle = [[-1, 0.2, 1], [1.5, 0, 0], [0, 1.5, 0]], [[-0.4, 0.3, 0], [1.6, 0, 0.2], [0, 1.6, 0]]
    back = [[1.2, 0.1, -1], [-2, 0, 0], [0, 1.8, 0.1]]  # its front looks away
    glass = [
        Material(base_color=(*tint, alpha), metallic=0.1, roughness=0.3, alpha=Alpha.BLENDED, double_sided=alpha > 0.6)
        for tint, alpha in (((0.9, 0.2, 0.1), 0.4), ((0.1, 0.8, 0.3), 0.55), ((0.2, 0.3, 0.9), 0.7))
    ]
    scene = quads([floor, near, middle, back], [Material(metallic=0.0, roughness=0.6), *glass], of=[0, 1, 2, 3])
    scene.sun = Sun((0.3, -1.0, -0.5), (3.0, 2.8, 2.5))
    scene.ambient = Ambient((0.3, 0.35, 0.4), (0.1, 0.1, 0.1))
    scene.lights = [Light((0.5, 1.5, 1.5), (1.0, 0.9, 0.8), radius=6.0)]
    return scene


@pytest.fixture(scope="module")
def glass(session_device: Device, tmp_path_factory: pytest.TempPathFactory) -> PassRun:
    camera = Camera((0.1, 1.2, 3.0), (0, 0.8, 0), near=0.1)
    return observe_scene(session_device, tmp_path_factory.mktemp("panes"), PANES, panes(), camera)["shade"]


def test_panes_over_one_another_are_within_tolerance(glass: PassRun) -> None:
    assert judge("forward_shading", glass)["color"].mask.mean() > 0.5
    assert above("forward_shading", glass) == []


def test_panes_of_another_coverage_are_caught(glass: PassRun) -> None:
    scene = glass.scene
    assert scene is not None
    assert glass.camera is not None
    thin = [replace(m, base_color=(*m.base_color[:3], 0.5 * m.base_color[3])) for m in scene.materials]
    wrong = replace(scene, materials=thin)
    other = replace(glass, scene=wrong, trace=cached_trace(wrong, glass.camera, glass.frame))
    assert "color" in above("forward_shading", other)


def test_compositing_by_hand() -> None:
    red, green = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    assert composite(np.ones(3), [(red, 0.5), (green, 0.25)]) == pytest.approx([0.75, 0.375 + 0.25, 0.375])


# ---------------------------------------------------------------- mistakes


def test_mistakes_in_the_image_are_caught(spheres: PassRun) -> None:
    color = spheres.outputs["color"]
    assert "color" in above("forward_shading", with_output(spheres, "color", half_texel(color)))
    assert "color" in above("forward_shading", with_output(spheres, "color", color * 1.01))
    holes = color.copy()
    holes[::5] = 0.0
    assert "color" in above("forward_shading", with_output(spheres, "color", holes))
    assert broken_invariants("forward_shading", with_output(spheres, "color", color * np.nan))


@pytest.mark.parametrize(("file", "right", "wrong"), [
    ("forward_shading.frag", "gl_FragCoord.xy / u_size", "(gl_FragCoord.xy + 0.5) / u_size"),
    ("surface.glsl", "vec3 normal = safe_normalize(", "vec3 normal = -safe_normalize("),
    ("shadow.glsl", "position += normal *", "position -= normal *"),
], ids=["half a pixel", "sign of the normal", "sign of the bias"])  # fmt: skip
def test_mistakes_in_the_shaders_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    assert "color" in above("forward_shading", observe_graph(device, *GRAPH)["shade"])


def test_compositing_mistakes_in_the_shader_are_caught(
    device: Device, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mistake(monkeypatch, "forward_shading.frag", "vec4(radiance * s.alpha, s.alpha)", "vec4(radiance, s.alpha)")
    camera = Camera((0.1, 1.2, 3.0), (0, 0.8, 0), near=0.1)
    assert "color" in above("forward_shading", observe_scene(device, tmp_path, PANES, panes(), camera)["shade"])
