"""The G-buffer against rays: every target within the tolerance of its format, and mistakes in each caught."""

from __future__ import annotations

from dataclasses import replace

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

from benchmarks.normal_formats import exact_errors
from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.gbuffer import reference
from rendergraph.nodes.gbuffer.packing import NORMAL_ERROR, NORMAL_FORMATS
from rendergraph.scene.scene import Camera, Image, Material, Scene, TextureUse, Wrap
from tests.measure.truth.traced_scenes import quads

pytestmark = pytest.mark.gpu
pytest.importorskip("embreex")


@pytest.fixture(scope="module")
def spheres(session_device: Device) -> PassRun:
    return observe_graph(session_device, "deferred_shading", *SMALL, scene="spheres")["gbuffer"]


def test_spheres_are_within_every_tolerance(spheres: PassRun) -> None:
    assert above("gbuffer", spheres) == ["emissive?"]
    assert broken_invariants("gbuffer", spheres) == []


@pytest.mark.parametrize("depth", ["reversed", "standard"])
@pytest.mark.parametrize("prepass", ["off", "full"])
def test_cornell_is_within_every_tolerance(device: Device, depth: str, prepass: str) -> None:
    settings = (f"frame.depth={depth}", f"passes.gbuffer.set.prepass={prepass}")
    run = observe_graph(device, "deferred_shading", *SMALL, *settings, scene="cornell")["gbuffer"]
    assert above("gbuffer", run) == []


def test_atrium_geometry_is_within_tolerance(device: Device) -> None:
    run = observe_graph(device, "gbuffer", *SMALL)["gbuffer"]
    found = above("gbuffer", run)
    assert {"depth", "distance"}.isdisjoint(found)
    assert all(name.endswith("?") for name in found)  # at this size every texture is minified


FORMATS = (("d16", "rg8", "rgba8"), ("d24", "rgba8", "rgba16"), ("d32f", "rg16f", "rgba16f"),
           ("d32f", "rgba16f", "rgba32f"), ("d32f", "rgb10_a2", "rgba8"))  # fmt: skip


@pytest.mark.parametrize(("depth", "normal", "material"), FORMATS, ids=lambda value: str(value))
def test_tolerances_follow_the_formats(device: Device, depth: str, normal: str, material: str) -> None:
    settings = (f"resources.depth.format={depth}", f"resources.normal.format={normal}",
                f"resources.material.format={material}")  # fmt: skip
    run = observe_graph(device, "deferred_shading", *SMALL, *settings, scene="cornell")["gbuffer"]
    assert above("gbuffer", run) == []


# ---------------------------------------------------------------- textures

TEXTURED = """\
rendergraph: 1
frame: {size: [64, 64]}
scene: {source: spheres}
resources:
  depth: {format: d32f}
  normal: {format: rgba32f}
  base_color: {format: rgba32f}
  material: {format: rgba32f}
  emissive: {format: rgba32f}
passes:
  gbuffer:
    node: gbuffer
    write: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
outputs:
  depth: {file: depth.npy}
  normal: {file: normal.npy}
  base_color: {file: base_color.npy}
  material: {file: material.npy}
  emissive: {file: emissive.npy}
"""


def textured() -> Scene:
    """A slanted square under five magnified textures, each used its own way."""
    random = np.random.default_rng(2)
    noise = [random.integers(40, 216, (8, 8, 4), dtype=np.uint8) for _ in range(5)]
    noise[2][..., 2] = 220  # a normal map points up
    images = [Image(texels, srgb=slot in (0, 4)) for slot, texels in enumerate(noise)]
    material = Material(
        metallic=0.9, roughness=0.8, emissive=(2.0, 1.0, 0.5), occlusion_strength=0.7, normal_scale=0.6,
        base_color_texture=TextureUse(0, rotation=0.4, scale=(0.7, 0.5), offset=(0.1, 0.2)),
        metallic_roughness_texture=TextureUse(1, wrap=(Wrap.MIRROR, Wrap.CLAMP), scale=(1.7, 1.4)),
        normal_texture=TextureUse(2),
        occlusion_texture=TextureUse(3, wrap=(Wrap.CLAMP, Wrap.MIRROR), offset=(0.3, -0.4)),
        emissive_texture=TextureUse(4, uv_set=1),
    )  # fmt: skip
    return quads([[[-1, -1, -1], [2, 0, 0.4], [0.1, 2, -0.5]]], [material], images=images)


@pytest.fixture(scope="module")
def textures(session_device: Device, tmp_path_factory: pytest.TempPathFactory) -> PassRun:
    camera = Camera((0.1, 0.2, 1.0), (0, 0, -1), near=0.1)
    return observe_scene(session_device, tmp_path_factory.mktemp("textured"), TEXTURED, textured(), camera)["gbuffer"]


def test_magnified_textures_are_within_tolerance(textures: PassRun) -> None:
    assert judge("gbuffer", textures)["base_color"].mask.mean() > 0.3
    assert above("gbuffer", textures) == []


@pytest.mark.parametrize(
    ("port", "measure"), [("base_color", "base_color"), ("material", "material"), ("emissive", "emissive")]
)
def test_half_a_texel_off_is_caught(textures: PassRun, port: str, measure: str) -> None:
    assert measure in above("gbuffer", with_output(textures, port, half_texel(textures.outputs[port])))


# ---------------------------------------------------------------- mistakes


def test_mistakes_in_the_targets_are_caught(spheres: PassRun, textures: PassRun) -> None:
    normal, depth = spheres.outputs["normal"], spheres.outputs["depth"]
    assert "normal" in above("gbuffer", with_output(spheres, "normal", -normal))
    assert "normal" in above("gbuffer", with_output(spheres, "normal", normal[..., ::-1]))
    assert "distance" in above("gbuffer", with_output(spheres, "depth", depth * (1.0 + 1e-5)))
    assert {"depth", "distance"} <= set(above("gbuffer", with_output(spheres, "depth", half_texel(depth))))
    holes = depth.copy()
    holes[::3] = 0.0
    assert "depth" in above("gbuffer", with_output(spheres, "depth", holes))
    swapped = textures.outputs["material"][..., [1, 0, 2, 3]]
    assert "material" in above("gbuffer", with_output(textures, "material", swapped))
    encoded = textures.outputs["base_color"] ** (1.0 / 2.2)
    assert "base_color" in above("gbuffer", with_output(textures, "base_color", encoded))


def test_a_normal_that_is_not_normalised_breaks_an_invariant(textures: PassRun) -> None:
    assert broken_invariants("gbuffer", textures) == []
    short = with_output(textures, "normal", textures.outputs["normal"] * 0.98)
    assert len(broken_invariants("gbuffer", short)) == 1
    assert broken_invariants("gbuffer", with_output(textures, "material", textures.outputs["material"] - 1.0))
    assert broken_invariants("gbuffer", with_output(textures, "emissive", textures.outputs["emissive"] * np.nan))


@pytest.mark.parametrize(("file", "right", "wrong", "measure"), [
    ("octahedral.glsl", "v.x >= 0.0 ? 1.0 : -1.0", "v.x >= 0.0 ? -1.0 : 1.0", "normal"),
    ("scene.vert", "view_projection * world", "view_projection * (world + vec4(1e-3, 0, 0, 0))", "distance"),
    ("packing.glsl", "vec4(roughness, metallic", "vec4(roughness * roughness, metallic", "material"),
])  # fmt: skip
def test_mistakes_in_the_shaders_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str, measure: str
) -> None:
    # From behind, where the octahedral map folds.
    behind = ("scene.source=spheres", "scene.camera.position=[2, 3, -7]", "scene.camera.target=[0, 2, 0]")
    assert above("gbuffer", observe_graph(device, "deferred_shading", *SMALL, *behind)["gbuffer"]) == ["emissive?"]
    mistake(monkeypatch, file, right, wrong)
    assert measure in above("gbuffer", observe_graph(device, "deferred_shading", *SMALL, *behind)["gbuffer"])


# ---------------------------------------------------------------- formats


@pytest.mark.parametrize("format", NORMAL_FORMATS)
def test_stated_errors_of_normals_are_those_of_their_formats(format: str) -> None:
    errors = exact_errors(reference.sphere(200_000), format, truncate=format.endswith("16f"))
    assert errors.max() <= NORMAL_ERROR[format] * 1.02
    if not format.endswith("32f"):
        assert errors.max() >= NORMAL_ERROR[format] * 0.9


@pytest.mark.parametrize("format", ["rgba16f", "rgb10_a2", "rgba8", "rgba8_snorm"])
def test_rounded_lengths_break_no_invariant_and_shorter_normals_do(device: Device, format: str) -> None:
    settings = (*SMALL, f"resources.normal.format={format}")
    run = observe_graph(device, "deferred_shading", *settings, scene="spheres")["gbuffer"]
    assert broken_invariants("gbuffer", run) == []
    stored = run.outputs["normal"]
    short = stored * 0.97 if format in ("rgba16f", "rgba8_snorm") else 0.5 + (stored - 0.5) * 0.97
    assert broken_invariants("gbuffer", with_output(run, "normal", short))


def test_a_depth_that_the_plan_left_out_is_not_judged(spheres: PassRun) -> None:
    without = replace(spheres, outputs={name: pixels for name, pixels in spheres.outputs.items() if name != "depth"})
    assert {"depth?", "distance?"} <= set(above("gbuffer", without))
