"""Forward against deferred, prepass against none, glass over either."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_render import Quad, quad_scene, render_scene
from test_deferred_lighting_scene import CAMERA, CORNER, GRAPH, LIGHTS, MATERIALS, PACKED, corner

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.nodes.forward_shading import reference
from rendergraph.plan.expand import expand
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.scene.features import SceneFeatures
from rendergraph.scene.scene import Alpha, Ambient, Camera, Material, Scene, Sun

FORWARD = """\
rendergraph: 1
frame: {size: [96, 64]}
scene: {source: spheres}
resources:
  depth: {format: d32f}
  hdr: {format: rgba32f}
passes:
  draw:
    node: forward_shading
    write: {color: hdr, depth: depth}
    set: {queues: QUEUES, prepass: PREPASS}
outputs: {hdr: {file: hdr.npy}, depth: {file: depth.npy}}
"""
GLASS_PASS = """\
  glass:
    node: forward_shading
    read: {depth: depth}
    write: {color: hdr}
    set: {queues: transparent}
    after: [light]
outputs:
"""


def forward(queues: str = "opaque", prepass: str = "off") -> str:
    return FORWARD.replace("QUEUES", queues).replace("PREPASS", prepass)


@pytest.mark.gpu
def test_forward_is_deferred(device: Device, tmp_path: Path) -> None:
    one = render_scene(device, tmp_path, forward(), corner(), CAMERA).images["hdr"]
    two = render_scene(device, tmp_path, GRAPH, corner(), CAMERA).images["hdr"]
    assert np.abs(one - two).max() / one.max() < 1e-4
    packed = render_scene(device, tmp_path, PACKED, corner(), CAMERA).images["hdr"]
    assert np.abs(one - packed).max() / one.max() > 1e-4  # the twin: packed targets are not exact


@pytest.mark.gpu
def test_shipped_graphs_agree_within_two_steps_of_255(device: Device) -> None:
    """The whole pipeline on the atrium at its own size, before antialiasing: opaque, masked, blended, shadowed."""
    images = {}
    for name in ("deferred_shading", "forward_shading"):
        document = load_document(name, ["scene.detail=0.2"])
        options = RenderOptions(samples=0, captures=("display",))
        images[name] = render_document(document, options).captures["display"].astype(int)
    difference = np.abs(images["deferred_shading"] - images["forward_shading"])
    assert difference.max() <= 2
    assert images["deferred_shading"].shape[:2] == (720, 1280)
    assert images["deferred_shading"].std() > 20  # a picture, not a blank


SHADOWS = """\
passes:
  shadows:
    node: shadow_map
    write: {map: shadow, cascades: cascades}
    set: {cascades: 1, slope_bias: 0, normal_bias: 0}
"""
SHADOW_TARGETS = "  shadow: {format: d32f, fixed: [64, 64]}\n  cascades: {bytes: 320}\n"


@pytest.mark.gpu
def test_shadows_see_the_positions_of_deferred_lighting(device: Device, tmp_path: Path) -> None:
    """Without any bias a surface shadows itself by the last bits of its position, which far from the origin are a
    quarter of a millimetre: even those patterns are alike.
    """
    far = (3000.0, 0.0, -2000.0)
    quads = [replace(quad, corner=np.add(quad.corner, far)) for quad in CORNER]
    scene = quad_scene(quads, MATERIALS, sun=Sun((0.3, -1, -0.5), (2.0, 1.9, 1.7)))
    camera = replace(CAMERA, position=tuple(np.add(CAMERA.position, far)), target=tuple(np.add(CAMERA.target, far)))
    images = []
    for text in (forward(), GRAPH):
        text = text.replace("passes:\n", SHADOW_TARGETS + SHADOWS)
        shadowed = "shadow_map: shadow, cascades: cascades}\n    write: {color"
        for unshadowed, begin in (
            ("emissive: emissive}\n    write: {color", "emissive: emissive, "),
            ("node: forward_shading\n    write: {color", "node: forward_shading\n    read: {"),
        ):
            text = text.replace(unshadowed, begin + shadowed)
        images.append(render_scene(device, tmp_path, text, scene, camera).images["hdr"])
    lit = render_scene(device, tmp_path, forward(), scene, camera).images["hdr"]
    assert (np.abs(images[0] - lit).max(axis=-1) > 1e-3).mean() > 0.1  # self-shadowed in many places
    assert np.abs(images[0] - images[1]).max() / lit.max() < 1e-4


@pytest.mark.gpu
@pytest.mark.parametrize("prepass", ["off", "full"])
def test_at_equal_depth_the_last_draw_wins(device: Device, tmp_path: Path, prepass: str) -> None:
    """Two squares at one place: with and without a prepass, drawn or stored, the second is seen."""
    square = [Quad((-1, -1, 0), (2, 0, 0), (0, 2, 0), material=k) for k in (0, 1)]
    colours = ((0.9, 0.1, 0.1), (0.1, 0.1, 0.9))
    scene = quad_scene(square, [Material(base_color=(*c, 1.0), unlit=True) for c in colours])
    facing = Camera((0, 0, 1), (0, 0, 0), fov=np.pi / 2)
    drawn = render_scene(device, tmp_path, forward("opaque", prepass), scene, facing).images["hdr"]
    stored = render_scene(
        device, tmp_path, GRAPH.replace("    node: gbuffer\n", f"    node: gbuffer\n    set: {{prepass: {prepass}}}\n"),
        scene, facing,
    ).images["base_color"]  # fmt: skip
    for image in (drawn, stored):
        assert image[32, 48, :3] == pytest.approx(colours[1], abs=1e-6)


@pytest.mark.gpu
def test_a_scene_without_light_is_drawn_dark(device: Device, tmp_path: Path) -> None:
    """What lighting alone needs, the target's size among it, is compiled away."""
    dark = corner(lights=[], sun=None, ambient=None)
    image = render_scene(device, tmp_path, forward(), dark, CAMERA).images["hdr"]
    emissive = image[..., :3].max(axis=-1) > 0
    assert 0 < emissive.mean() < 0.2  # the emissive quad alone


@pytest.mark.gpu
def test_prepass_changes_nothing_and_leaves_no_holes(device: Device, tmp_path: Path) -> None:
    plain = render_scene(device, tmp_path, forward("all"), glass_scene(), CAMERA).images
    tested = render_scene(device, tmp_path, forward("all", "full"), glass_scene(), CAMERA).images
    assert (plain["depth"] == tested["depth"]).all()
    assert (plain["hdr"] == tested["hdr"]).all()


def glass_scene(materials: tuple[Material, ...] = ()) -> Scene:
    """The lit corner behind three panes, the last instance farthest: order must come from the distance."""
    panes = [
        Material(base_color=(0.9, 0.3, 0.2, 0.4), metallic=0.0, roughness=0.3, alpha=Alpha.BLENDED, double_sided=True),
        Material(base_color=(0.1, 0.8, 0.3, 0.6), metallic=0.0, roughness=0.6, alpha=Alpha.BLENDED),
        Material(base_color=(0.2, 0.3, 0.9, 0.5), metallic=0.0, roughness=0.9, alpha=Alpha.BLENDED),
    ]
    quads = [Quad((-1.5, 0.2, 2.4 - 0.5 * k), (3, 0, 0), (0, 2, 0), material=4 + k) for k in range(3)]
    return quad_scene(
        [*CORNER, *quads], [*MATERIALS, *(materials or panes)], lights=LIGHTS,
        sun=Sun((0.3, -1, -0.5), (2.0, 1.9, 1.7)), ambient=Ambient((0.2, 0.3, 0.5), (0.1, 0.08, 0.05)),
    )  # fmt: skip


@pytest.mark.gpu
def test_glass_over_deferred_is_glass_over_forward(device: Device, tmp_path: Path) -> None:
    composited = GRAPH.replace("outputs:\n", GLASS_PASS)
    over_deferred = render_scene(device, tmp_path, composited, glass_scene(), CAMERA).images["hdr"]
    all_forward = render_scene(device, tmp_path, forward("all"), glass_scene(), CAMERA).images["hdr"]
    assert np.abs(over_deferred - all_forward).max() / all_forward.max() < 1e-4
    without = render_scene(device, tmp_path, forward("opaque"), glass_scene(), CAMERA).images["hdr"]
    assert np.abs(without - all_forward).max() > 0.05  # the glass is there


@pytest.mark.gpu
def test_panes_composite_back_to_front(device: Device, tmp_path: Path) -> None:
    """Unlit panes have known radiance: the pixel behind all three against the formula, and in wrong order (twin)."""
    colors = [(0.9, 0.1, 0.1), (0.1, 0.9, 0.1), (0.1, 0.1, 0.9)]
    coverage = (0.4, 0.6, 0.5)
    panes = tuple(
        Material(base_color=(*c, a), unlit=True, alpha=Alpha.BLENDED) for c, a in zip(colors, coverage, strict=True)
    )
    scene = glass_scene(panes)
    behind = render_scene(device, tmp_path, forward("opaque"), scene, CAMERA).images["hdr"][32, 48, :3]
    pixel = render_scene(device, tmp_path, forward("all"), scene, CAMERA).images["hdr"][32, 48, :3]
    layers = [(np.array(c), a) for c, a in zip(colors, coverage, strict=True)]
    assert pixel == pytest.approx(reference.composite(behind, layers[::-1]), rel=1e-5)
    assert pixel != pytest.approx(reference.composite(behind, layers), rel=1e-2)


@pytest.mark.gpu
def test_glass_behind_a_wall_is_hidden(device: Device, tmp_path: Path) -> None:
    scene = glass_scene()
    wall = Quad((-4, -1, 4), (8, 0, 0), (0, 6, 0))
    hidden = quad_scene([wall, *[Quad((-1.5, 0.2, 2), (3, 0, 0), (0, 2, 0), material=1)]],
                        [replace(MATERIALS[0]), scene.materials[4]], sun=scene.sun)  # fmt: skip
    with_glass = render_scene(device, tmp_path, forward("all"), hidden, CAMERA).images["hdr"]
    without = render_scene(device, tmp_path, forward("opaque"), hidden, CAMERA).images["hdr"]
    assert (with_glass == without).all()


# ---------------------------------------------------------------- what is left out, and mistakes


def steps(folder: Path, text: str, features: SceneFeatures, name: str = "draw") -> list[str]:
    path = folder / "graph.yaml"
    path.write_text(text)
    graph, _ = expand(load_document(path), features=features)
    return [s.name for s in graph.passes[name].subpasses]


def test_queues_the_scene_lacks_are_not_drawn(tmp_path: Path) -> None:
    everything = SceneFeatures(opaque=True, masked=True, blended=True)
    assert steps(tmp_path, forward("all", "full"), everything) == [
        "draw.prepass_opaque", "draw.prepass_masked", "draw.opaque", "draw.masked", "draw.blended",
    ]  # fmt: skip
    assert steps(tmp_path, forward("opaque"), everything) == ["draw.opaque", "draw.masked"]
    assert steps(tmp_path, forward("all"), SceneFeatures(opaque=True)) == ["draw.opaque"]
    assert steps(tmp_path, forward("all"), SceneFeatures(blended=True)) == [
        "draw.no_depth",
        "draw.no_color",
        "draw.blended",
    ]
    composited = GRAPH.replace("outputs:\n", GLASS_PASS)
    assert steps(tmp_path, composited, SceneFeatures(opaque=True), "glass") == []


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        (forward("transparent"), {"RG225"}),
        (
            forward("opaque").replace(
                "write: {color: hdr, depth: depth}", "read: {depth: depth}\n    write: {color: hdr}"
            ),
            {"RG225"},
        ),
    ],
    ids=["transparent writes depth", "opaque reads depth"],
)
def test_depth_on_the_wrong_side_is_an_error(tmp_path: Path, text: str, codes: set[str]) -> None:
    with pytest.raises(RenderGraphError) as caught:
        steps(tmp_path, text, SceneFeatures(opaque=True, blended=True))
    assert codes <= {d.code for d in caught.value.diagnostics}
