"""Cascades against their geometry, shadows against rays, and what keeps them still."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_render import Quad, quad_scene, render_scene

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.nodes.shadow_map import reference
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import Frame
from rendergraph.run.frame_constants import camera_view
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.scene import Alpha, Camera, Image, Material, Scene, Sun, TextureUse

GRAPH = """\
rendergraph: 1
frame: {size: [96, 96], depth: DEPTH}
scene: {source: spheres}
resources:
  depth: {format: d32f}
  shadow: {format: FORMAT, fixed: [RESOLUTION, RESOLUTION], layers: LAYERS}
  cascades: {bytes: 320}
  hdr: {format: rgba32f}
passes:
  shadows:
    node: shadow_map
    write: {map: shadow, cascades: cascades}
    set: {SHADOW_SET}
  solid:
    node: forward_shading
    read: {shadow_map: shadow, cascades: cascades}
    write: {color: hdr, depth: depth}
    set: {queues: opaque, shadow_taps: TAPS}
outputs:
  hdr: {file: hdr.npy}
  depth: {file: depth.npy}
"""
DIFFUSE = Material(base_color=(1, 1, 1, 1), metallic=0.0, roughness=1.0, double_sided=True)
SUN = Sun((0.35, -1.0, -0.6), (1.0, 1.0, 1.0))
CAMERA = Camera((0, 4, 6), (0, 0, 0), near=0.1, far=40.0)


def graph(**values: object) -> str:
    defaults = {"DEPTH": "reversed", "FORMAT": "d32f", "RESOLUTION": 512, "LAYERS": 2, "SHADOW_SET": "", "TAPS": 1}
    text = GRAPH
    for key, value in {**defaults, **values}.items():
        text = text.replace(key, str(value))
    return text


def table() -> Scene:
    """A floor, a slab above it, and a wall: lit by the sun from above."""
    floor = Quad((-5, 0, 5), (10, 0, 0), (0, 0, -10))
    slab = Quad((-1, 1, 1), (2, 0, 0), (0, 0, -2))
    wall = Quad((-3, 0, -3), (6, 0, 0), (0, 3, 0))
    return quad_scene([floor, slab, wall], [DIFFUSE], sun=SUN)


def shadow_truth(
    scene: Scene, camera: Camera, depth: np.ndarray, convention: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pixels with a surface (rows, columns), and whether the sun's rays reach them."""
    height, width = depth.shape
    view = camera_view(camera, Frame(width, height, depth=convention))
    rows, columns = np.nonzero(depth != (0.0 if convention == "reversed" else 1.0))
    ndc = np.stack([(columns + 0.5) / width * 2 - 1, (rows + 0.5) / height * 2 - 1], axis=1)
    clip = np.column_stack([ndc, depth[rows, columns], np.ones(len(rows))])
    world = clip @ np.linalg.inv(view.projection @ view.view).T
    towards = -np.array(SUN.direction) / np.linalg.norm(SUN.direction)
    return (
        rows,
        columns,
        reference.visible(reference.world_triangles(scene), world[:, :3] / world[:, 3:], towards, offset=2e-3),
    )


def wrong_share(device: Device, folder: Path, scene: Scene, **values: object) -> float:
    """Share of surface pixels whose shadow differs from the ray's by more than half."""
    images = render_scene(device, folder, graph(**values), scene, CAMERA).images
    lit_image = render_scene(device, folder, graph(**values), replace_sun(scene), CAMERA).images["hdr"]
    convention = str(values.get("DEPTH", "reversed"))
    rows, columns, lit = shadow_truth(scene, CAMERA, images["depth"][..., 0], convention)
    ambient = lit_image[rows, columns, 0]
    received = images["hdr"][rows, columns, 0] - ambient
    facing = received.max()
    return float(np.mean((received > 0.3 * facing) != lit))


def replace_sun(scene: Scene) -> Scene:
    """The scene without its sun."""
    copied = quad_scene([Quad((0, 0, 0), (1, 0, 0), (0, 1, 0))], [DIFFUSE])
    for name in (
        "positions",
        "normals",
        "tangents",
        "uv0",
        "uv1",
        "colors",
        "indices",
        "meshes",
        "instances",
        "materials",
        "images",
    ):
        setattr(copied, name, getattr(scene, name))
    return copied


@pytest.mark.gpu
def test_shadows_match_rays_and_improve_with_resolution(device: Device, tmp_path: Path) -> None:
    scene = table()
    errors = [wrong_share(device, tmp_path, scene, RESOLUTION=r) for r in (32, 128, 1024)]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.01
    assert errors[0] > 0.02  # a coarse map, the twin, is measurably wrong


@pytest.mark.gpu
@pytest.mark.parametrize(
    "values",
    [{"LAYERS": 1}, {"LAYERS": 4}, {"TAPS": 5}, {"FORMAT": "d16"}, {"FORMAT": "d24", "DEPTH": "standard"}],
    ids=["one layer", "four cascades", "wide filter", "d16", "standard depth"],
)
def test_shadow_variants_agree_with_rays(device: Device, tmp_path: Path, values: dict[str, object]) -> None:
    assert wrong_share(device, tmp_path, table(), RESOLUTION=1024, **values) < 0.015


@pytest.mark.gpu
def test_without_bias_lit_surfaces_shadow_themselves(device: Device, tmp_path: Path) -> None:
    """The twin of the bias: with none, acne; with the default, the lone tilted floor is lit everywhere."""
    floor = quad_scene([Quad((-5, 0, 5), (10, 1, 0), (0, 0.5, -10))], [DIFFUSE], sun=SUN)

    def dark(settings: str) -> float:
        hdr = render_scene(device, tmp_path, graph(SHADOW_SET=settings, RESOLUTION=128, TAPS=3), floor, CAMERA).images
        red = hdr["hdr"][..., 0][hdr["depth"][..., 0] > 0]
        return float((red < 0.9 * red.max()).mean())

    assert dark("slope_bias: 0, normal_bias: 0") > 0.1
    assert dark("") == 0.0


@pytest.mark.gpu
def test_alpha_tested_casters_let_light_through_their_holes(device: Device, tmp_path: Path) -> None:
    pixels = np.full((64, 64, 4), 255, dtype=np.uint8)
    pixels[:, :32, 3] = 0
    holes = replace(DIFFUSE, alpha=Alpha.MASKED, base_color_texture=TextureUse(0))
    floor, slab = Quad((-5, 0, 5), (10, 0, 0), (0, 0, -10)), Quad((-1, 1, 1), (2, 0, 0), (0, 0, -2), material=1)
    overhead = Camera((0, 0.9, 4), (0, 0, 0), near=0.1)
    sun = Sun((0.0, -1.0, -0.001), (1.0, 1.0, 1.0))
    lit = {}
    for name, material in (("masked", holes), ("solid", DIFFUSE)):
        scene = quad_scene([floor, slab], [DIFFUSE, material], images=[Image(pixels, srgb=True)], sun=sun)
        lit[name] = render_scene(device, tmp_path, graph(RESOLUTION=1024), scene, overhead).images["hdr"][46, :, 0]
    row = lit["solid"]
    assert row[48 - 6] < 0.1 * row.max()
    assert lit["masked"][48 - 6] > 0.9 * row.max()
    assert lit["masked"][48 + 6] < 0.1 * row.max()


@pytest.mark.gpu
def test_backs_of_walls_cast(device: Device, tmp_path: Path) -> None:
    """A single-sided ceiling seen from its front, the inside, keeps the sun out."""
    inside = replace(DIFFUSE, double_sided=False)
    floor = Quad((-2, 0, 2), (4, 0, 0), (0, 0, -4))
    ceiling = Quad((-2, 2, -2), (4, 0, 0), (0, 0, 4))  # faces down
    scene = quad_scene([floor, ceiling], [inside], sun=Sun((0, -1, 0), (1, 1, 1)))
    camera = Camera((0, 1, 0), (0, 0, -0.01), near=0.1)
    hdr = render_scene(device, tmp_path, graph(), scene, camera).images["hdr"]
    assert hdr[..., :3].max() == 0.0


# ---------------------------------------------------------------- cascades


def cascades(
    device: Device, folder: Path, camera: Camera, settings: str = "", layers: int = 4
) -> dict[str, np.ndarray]:
    text = graph(SHADOW_SET=settings, LAYERS=layers)
    raw = render_scene(device, folder, text, table(), camera, captures=("cascades",)).captures["cascades"]
    data = np.frombuffer(np.asarray(raw).tobytes(), dtype=np.float32)
    return {
        "to_clip": data[:64].reshape(4, 4, 4).transpose(0, 2, 1).astype(np.float64),
        "far": data[64:68].astype(np.float64),
        "texel": data[68:72].astype(np.float64),
    }


@pytest.mark.gpu
def test_every_slice_lies_inside_its_cascade(device: Device, tmp_path: Path) -> None:
    for camera in (CAMERA, replace(CAMERA, fov=2.4), replace(CAMERA, position=(3.0, 0.2, -4.0), fov=0.3)):
        found = cascades(device, tmp_path, camera, "distance: 12")
        view = camera_view(camera, Frame(96, 96))
        inverse = np.linalg.inv(view.projection @ view.view)
        near = camera.near
        for index in range(4):
            corners = reference.slice_corners(inverse, view.view, near, found["far"][index])
            clip = (np.column_stack([corners, np.ones(8)]) @ found["to_clip"][index].T)[:, :3]
            if index:  # the first may start behind the near plane: the range hugs the scene
                assert np.abs(clip[:, :2]).max() <= 1.0
                assert -1e-3 <= clip[:, 2].min() <= clip[:, 2].max() <= 1.001
            near = found["far"][index]


@pytest.mark.gpu
def test_splits_follow_the_knob(device: Device, tmp_path: Path) -> None:
    inside = Camera((0, 1.5, 0), (0, 0, -5), near=0.1)  # in the scene: the range starts at the near plane
    for blend in (0.0, 0.5, 1.0):
        found = cascades(device, tmp_path, inside, f"distance: 5, split: {blend}")
        assert found["far"] == pytest.approx(reference.splits(0.1, 5.0, 4, blend), rel=1e-5)
        assert found["far"][3] == pytest.approx(5.0)


@pytest.mark.gpu
def test_shadows_stay_on_their_texels_when_the_camera_moves(device: Device, tmp_path: Path) -> None:
    """A fixed point moves by whole texels and its texel keeps its size, whether the camera turns or walks."""
    point = np.array([0.7, 0.0, -0.4, 1.0])
    base = Camera((0.0, 2.0, 3.0), (0.0, 0.5, 0.0), near=0.1)
    first = cascades(device, tmp_path, base, "distance: 12")
    for moved in (
        replace(base, target=(0.3, 0.6, 0.1)),
        replace(base, position=(0.013, 2.0, 3.0), target=(0.013, 0.5, 0.0)),
        replace(base, position=(0.231, 2.1, 2.95), target=(0.1, 0.5, 0.0)),
    ):
        second = cascades(device, tmp_path, moved, "distance: 12")
        assert (second["texel"] == first["texel"]).all()
        for index in range(4):
            texels = ((second["to_clip"][index] - first["to_clip"][index]) @ point)[:2] * 256
            assert np.abs(texels - np.round(texels)).max() < 0.02
        # The twin: the unsnapped centre moves by parts of a texel.
        walked = np.array(moved.position) - np.array(base.position)
        if np.linalg.norm(walked) > 0:
            axis = first["to_clip"][3][0, :3] / np.linalg.norm(first["to_clip"][3][0, :3])
            part = axis @ walked / first["texel"][3]
            assert abs(part - round(part)) > 0.02


# ---------------------------------------------------------------- what is left out, and mistakes


def steps(features: SceneFeatures, folder: Path, text: str) -> list[str]:
    path = folder / "graph.yaml"
    path.write_text(text)
    expanded, _ = expand(load_document(path), features=features)
    return [s.name for s in expanded.passes["shadows"].subpasses]


def test_only_what_the_scene_needs_is_drawn(tmp_path: Path) -> None:
    assert steps(SceneFeatures(opaque=True), tmp_path, graph()) == ["shadows.lit", "shadows.no_cascades"]
    assert steps(SceneFeatures(opaque=True, sun=True), tmp_path, graph()) == ["shadows.fit", "shadows.opaque"]
    assert steps(SceneFeatures(masked=True, sun=True), tmp_path, graph())[-1] == "shadows.masked"


@pytest.mark.parametrize(
    ("old", "new"),
    [("bytes: 320", "bytes: 64"), ("layers: 2", "layers: 5"), ("fixed: [512, 512]", "fixed: [512, 256]")],
)
def test_wrong_resources_are_named(tmp_path: Path, old: str, new: str) -> None:
    with pytest.raises(RenderGraphError) as caught:
        steps(SceneFeatures(opaque=True, sun=True), tmp_path, graph().replace(old, new))
    assert [d.code for d in caught.value.diagnostics] == ["RG225"]
