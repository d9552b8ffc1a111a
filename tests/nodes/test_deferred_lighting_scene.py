"""Lit pixels against the float64 light model at the points the pixels show, and what the node leaves out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_render import Quad, quad_scene, render_scene

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.nodes.deferred_lighting import textbook
from rendergraph.nodes.deferred_lighting.light_model import MOST_UNIFORM_LIGHTS
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import Frame
from rendergraph.run.frame_constants import camera_view
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.scene import Ambient, Camera, Light, Material, Scene, Sun

GRAPH = """\
rendergraph: 1
frame: {size: [96, 64]}
scene: {source: spheres}
resources:
  depth: {format: d32f}
  normal: {format: rgba32f}
  base_color: {format: rgba32f}
  material: {format: rgba32f}
  emissive: {format: rgba32f}
  hdr: {format: rgba32f}
passes:
  fill:
    node: gbuffer
    write: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
  light:
    node: deferred_lighting
    read: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
    write: {color: hdr}
outputs:
  hdr: {file: hdr.npy}
  depth: {file: depth.npy}
  normal: {file: normal.npy}
  base_color: {file: base_color.npy}
  material: {file: material.npy}
  emissive: {file: emissive.npy}
"""
#: The targets of the shipped graph.
PACKED = (
    GRAPH.replace("normal: {format: rgba32f}", "normal: {format: rg16}")
    .replace("base_color: {format: rgba32f}", "base_color: {format: srgb8_a8}")
    .replace("material: {format: rgba32f}", "material: {format: rgb10_a2}")
    .replace("emissive: {format: rgba32f}", "emissive: {format: r11g11b10f}")
)
CAMERA = Camera((0, 2.2, 5), (0, 0.6, 0), near=0.1)
CORNER = [
    Quad((-3, 0, 3), (6, 0, 0), (0, 0, -6), material=0),
    Quad((-3, 0, -3), (6, 0, 0), (0, 3, 0), material=1),
    Quad((-1, 0.4, 1), (2, 0, 0), (0, 0.5, -1), material=2),
    Quad((1.5, 0.2, 0), (1, 0, 0.4), (0, 1, 0), material=3),
]
MATERIALS = [
    Material(base_color=(0.7, 0.6, 0.5, 1), metallic=0.0, roughness=0.15),
    Material(base_color=(0.2, 0.5, 0.8, 1), metallic=0.0, roughness=1.0),
    Material(base_color=(0.9, 0.7, 0.3, 1), metallic=1.0, roughness=0.4),
    Material(base_color=(0.1, 0.1, 0.1, 1), metallic=0.3, roughness=0.6, emissive=(0.5, 0.2, 3.0)),
]
LIGHTS = [
    Light((0.5, 1.5, 0.5), (3.0, 2.0, 1.0), 4.0),
    Light((-2.0, 0.3, 1.0), (0.1, 0.9, 0.3), 1.5),
    Light((0, 3, 0), (5, 5, 5), 6.0, axis=(0.2, -1, -0.3), inner=0.3, outer=0.6),
]


def corner(**changes: object) -> Scene:
    lit = {
        "lights": LIGHTS,
        "sun": Sun((0.3, -1, -0.5), (2.0, 1.9, 1.7)),
        "ambient": Ambient((0.2, 0.3, 0.5), (0.1, 0.08, 0.05)),
    }
    return quad_scene(CORNER, MATERIALS, **{**lit, **changes})  # type: ignore[arg-type]


def truth(images: dict[str, np.ndarray], scene: Scene, camera: Camera = CAMERA) -> tuple[np.ndarray, np.ndarray]:
    """Mask of pixels with a surface, and their radiance in float64 from unpacked targets."""
    depth = images["depth"][..., 0]
    height, width = depth.shape
    covered = depth > 0
    rows, columns = np.nonzero(covered)
    view = camera_view(camera, Frame(width, height))
    ndc = np.stack([(columns + 0.5) / width * 2 - 1, (rows + 0.5) / height * 2 - 1, depth[covered]], axis=1)
    world = np.column_stack([ndc, np.ones(len(rows))]) @ np.linalg.inv(view.projection @ view.view).T
    channel = {
        name: images[name][covered].astype(np.float64) for name in ("normal", "base_color", "material", "emissive")
    }
    return covered, textbook.shade(
        world[:, :3] / world[:, 3:], textbook.normalize(channel["normal"][:, :3]), channel["base_color"][:, :3],
        channel["material"][:, 0], channel["material"][:, 1], channel["material"][:, 2], channel["emissive"][:, :3],
        scene=scene, eye=np.array(camera.position),
    )  # fmt: skip


@pytest.mark.gpu
def test_lit_scene_matches_float64(device: Device, tmp_path: Path) -> None:
    scene = corner()
    images = render_scene(device, tmp_path, GRAPH, scene, CAMERA).images
    covered, expected = truth(images, scene)
    error = np.abs(images["hdr"][covered][:, :3] - expected) / np.maximum(expected, 0.05)
    assert covered.mean() > 0.5
    assert error.max() < 1e-3
    # The twin: one light forgotten.
    scene.lights.pop()
    _, darker = truth(images, scene)
    assert (np.abs(images["hdr"][covered][:, :3] - darker) / np.maximum(darker, 0.05)).max() > 0.1


@pytest.mark.gpu
def test_packed_targets_cost_little_accuracy(device: Device, tmp_path: Path) -> None:
    exact = render_scene(device, tmp_path, GRAPH, corner(), CAMERA).images["hdr"][..., :3]
    packed = render_scene(device, tmp_path, PACKED, corner(), CAMERA).images["hdr"][..., :3]
    error = np.abs(packed - exact) / np.maximum(exact, 0.05)
    assert error.max() < 0.05
    eight_bit = PACKED.replace("rgb10_a2", "rgba8").replace("rg16}", "rg8}")
    coarse = render_scene(device, tmp_path, eight_bit, corner(), CAMERA).images["hdr"][..., :3]
    assert (np.abs(coarse - exact) / np.maximum(exact, 0.05)).max() > 2 * error.max()


@pytest.mark.gpu
def test_background_is_black_and_finite(device: Device, tmp_path: Path) -> None:
    images = render_scene(device, tmp_path, GRAPH, corner(), CAMERA).images
    background = images["depth"][..., 0] == 0
    assert background.any()
    assert (images["hdr"][background][:, :3] == 0).all()


@pytest.mark.gpu
def test_unlit_surfaces_show_their_colour(device: Device, tmp_path: Path) -> None:
    scene = quad_scene(
        CORNER, [Material(base_color=(0.3, 0.2, 0.1, 1), unlit=True)] * 4, sun=Sun((0, -1, 0), (9, 9, 9))
    )
    images = render_scene(device, tmp_path, GRAPH, scene, CAMERA).images
    lit = images["depth"][..., 0] > 0
    assert images["hdr"][lit][:, :3] == pytest.approx(np.tile([0.3, 0.2, 0.1], (lit.sum(), 1)), abs=1e-6)


@pytest.mark.gpu
def test_extremes_stay_finite(device: Device, tmp_path: Path) -> None:
    """Lights on the surface, without reach, of vast reach and power; mirrors; the eye in the plane of a surface."""
    lights = [
        Light((0, 0, 0), (1e6, 1e6, 1e6), 5.0),
        Light((0, 0.0, 1), (1.0, 1.0, 1.0), 0.0),
        Light((0, 1, 0), (1e30, 1e30, 1e30), 1e6),
        Light((0, 1, 0), (1.0, 1.0, 1.0), 3.0, axis=(0, -1, 0), inner=0.0, outer=1e-4),
        Light((0, 1, 0), (1.0, 1.0, 1.0), 3.0, axis=(0, -1, 0), inner=0.5, outer=0.5),
    ]
    mirrors = [
        Material(base_color=(1, 1, 1, 1), metallic=1.0, roughness=r, emissive=(1e30, 0, 0))
        for r in (0.0, 1e-4, 1.0, 0.0)
    ]
    for eye in ((0.0, 2.2, 5.0), (0.0, 0.0, 5.0), (0.0, 1e-6, 5.0)):
        scene = quad_scene(
            CORNER, mirrors, lights=lights, sun=Sun((0, -1, 0), (1e5, 1e5, 1e5)), ambient=Ambient((1, 1, 1), (0, 0, 0))
        )
        for text in (GRAPH, PACKED.replace("hdr: {format: rgba32f}", "hdr: {format: r11g11b10f}")):
            hdr = render_scene(device, tmp_path, text, scene, Camera(eye, (0, eye[1], 0), near=0.1)).images["hdr"][
                ..., :3
            ]
            assert np.isfinite(hdr).all()
            assert hdr.min() >= 0
            assert hdr.max() <= 65504


@pytest.mark.gpu
def test_full_compiles_everything_and_gives_the_same_image(device: Device, tmp_path: Path) -> None:
    """What specialisation leaves out contributed nothing."""
    scene = corner(lights=[], ambient=None)
    lean = render_scene(device, tmp_path, GRAPH, scene, CAMERA).images["hdr"]
    full = render_scene(device, tmp_path, GRAPH, scene, CAMERA, full=True).images["hdr"]
    assert np.abs(lean - full).max() <= 1e-6 * lean.max()


@pytest.mark.gpu
def test_as_many_lights_as_no_uniform_block_holds(device: Device, tmp_path: Path) -> None:
    """Black lights add nothing, but move all of them to a storage block."""
    black = [Light((0, 1, 0), (0, 0, 0), 1.0)] * MOST_UNIFORM_LIGHTS
    few = render_scene(device, tmp_path, GRAPH, corner(), CAMERA).images["hdr"]
    many = render_scene(device, tmp_path, GRAPH, corner(lights=[*black, *LIGHTS]), CAMERA).images["hdr"]
    assert np.abs(few - many).max() <= 1e-6 * few.max()
    features = SceneFeatures(opaque=True, point_lights=MOST_UNIFORM_LIGHTS)
    assert defines(tmp_path, features)["UNIFORM_LIGHTS"] == str(MOST_UNIFORM_LIGHTS)
    assert defines(tmp_path, replace(features, spot_lights=1))["UNIFORM_LIGHTS"] == "0"


def defines(folder: Path, features: SceneFeatures, text: str = GRAPH) -> dict[str, str]:
    path = folder / "graph.yaml"
    path.write_text(text)
    graph, _ = expand(load_document(path), features=features)
    program = graph.passes["light"].subpasses[0].program
    assert program is not None
    return dict(program.defines)


def test_the_scene_decides_what_is_compiled(tmp_path: Path) -> None:
    bare = defines(tmp_path, SceneFeatures(opaque=True))
    assert {bare[key] for key in ("SUN", "SUN_SHADOW", "AMBIENT", "LOCAL_LIGHTS", "EMISSIVE")} == {"0"}
    rich = defines(tmp_path, SceneFeatures(opaque=True, sun=True, ambient=True, point_lights=1, emissive=True))
    assert {rich[key] for key in ("SUN", "AMBIENT", "LOCAL_LIGHTS", "EMISSIVE")} == {"1"}
    assert rich["SUN_SHADOW"] == "0"  # no shadow map is connected


def test_one_shadow_port_without_the_other_is_an_error(tmp_path: Path) -> None:
    text = GRAPH.replace(
        "emissive: emissive}\n    write: {color", "emissive: emissive, cascades: c}\n    write: {color"
    )
    text = text.replace("  hdr: {format: rgba32f}", "  hdr: {format: rgba32f}\n  c: {bytes: 320}", 1)
    with pytest.raises(RenderGraphError) as caught:
        defines(tmp_path, SceneFeatures(opaque=True, sun=True), text)
    assert "RG225" in {d.code for d in caught.value.diagnostics}
