"""A graph built for what its scene requires and the graph in full give one image, bit for bit; and why parts went."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.node.discovery import node_folder
from rendergraph.plan.explain import SENTENCES, explain_decision
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.run.options import RenderOptions
from rendergraph.run.plan_document import plan_for_scene
from rendergraph.run.render import render_document, run_plan
from rendergraph.scene.features import ViewFeatures
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.scene import Alpha, Ambient, Camera, Image, Light, Material, Scene, Sun, TextureUse
from tests.nodes.scene_render import Quad, quad_scene

pytestmark = pytest.mark.gpu

GRAPHS = node_folder().parent / "graphs"
SUN = Sun((-0.4, -0.8, -0.3), (4.0, 3.6, 3.2))
AMBIENT = Ambient((0.3, 0.35, 0.4), (0.1, 0.1, 0.1))
EYE = Camera((0.0, 1.0, 4.0), (0.0, 0.5, 0.0), fov=math.radians(60), near=0.1)
AWAY = replace(EYE, target=(0.0, 1.0, 40.0))

CHECKER = Image(
    np.kron(np.indices((4, 4)).sum(axis=0) % 2 * 255, np.ones((4, 4))).astype(np.uint8)[..., None].repeat(4, axis=2),
    srgb=True,
    name="checker",
)
FLOOR = Quad((-3, 0, 3), (6, 0, 0), (0, 0, -6))
POSTER = Quad((-1, 0.2, 0), (1.2, 0, 0.3), (0, 1.2, 0), 1)
BEHIND = Quad((-1, 0.2, 8), (1.2, 0, 0), (0, 1.2, 0), 1)  # behind EYE

PLAIN = Material(base_color=(0.7, 0.6, 0.5, 1.0), metallic=0.0, roughness=0.6)
LEAVES = Material(base_color_texture=TextureUse(0), alpha=Alpha.MASKED, metallic=0.0, double_sided=True)
GLASS = Material(base_color=(0.2, 0.5, 0.9, 0.4), alpha=Alpha.BLENDED, metallic=0.0)
LAMP = Material(base_color=(0.0, 0.0, 0.0, 1.0), emissive=(5.0, 4.0, 2.0))
SIGN = Material(base_color=(0.9, 0.2, 0.1, 1.0), unlit=True)
NEAR_LIGHT = Light((0.0, 1.5, 1.0), (3.0, 3.0, 3.0), 5.0)
FAR_LIGHT = Light((0.0, 1.5, 60.0), (3.0, 3.0, 3.0), 5.0)


def scene(*quads: Quad, other: Material = PLAIN, first: Material = PLAIN, **more: object) -> Scene:
    """Quads of two materials."""
    return quad_scene(quads, [first, other], images=[CHECKER], **more)  # type: ignore[arg-type]


LIT = {"sun": SUN, "ambient": AMBIENT}
SCENES: dict[str, tuple[Scene, Camera]] = {
    "everything": (scene(FLOOR, POSTER, other=GLASS, lights=[NEAR_LIGHT], **LIT), EYE),
    "no sun": (scene(FLOOR, POSTER, ambient=AMBIENT, lights=[NEAR_LIGHT]), EYE),
    "no lights": (scene(FLOOR, POSTER, **LIT), EYE),
    "no light at all": (scene(FLOOR, POSTER), EYE),
    "masked": (scene(FLOOR, POSTER, other=LEAVES, **LIT), EYE),
    "all masked": (scene(FLOOR, POSTER, first=LEAVES, other=LEAVES, **LIT), EYE),
    "all blended": (scene(FLOOR, POSTER, first=GLASS, other=GLASS, **LIT), EYE),
    "emissive alone": (scene(FLOOR, POSTER, first=LAMP, other=LAMP), EYE),
    "unlit": (scene(FLOOR, POSTER, other=SIGN, **LIT), EYE),
    "empty": (scene(**LIT), EYE),
    "glass behind the camera": (scene(FLOOR, BEHIND, other=GLASS, **LIT), EYE),
    "lamp behind the camera": (scene(FLOOR, BEHIND, other=LAMP, **LIT), EYE),
    "leaves behind the camera": (scene(FLOOR, BEHIND, other=LEAVES, **LIT), EYE),
    "nothing in view": (scene(FLOOR, POSTER, other=GLASS, lights=[NEAR_LIGHT], **LIT), AWAY),
    "a light beyond reach": (scene(FLOOR, POSTER, lights=[FAR_LIGHT], **LIT), EYE),
    "glass alone in view, over the ground": (
        scene(Quad((-9, -9, 9), (18, 0, 0), (0, 0, 1)), POSTER, other=GLASS, **LIT),
        replace(EYE, position=(0.0, 1.0, 2.0), target=(0.0, 1.0, 0.0)),
    ),
    "far away": (scene(FLOOR, POSTER, **LIT), replace(EYE, position=(0.0, 20.0, 400.0), fov=math.radians(3))),
    "a wall": (scene(Quad((-30, -30, 0), (60, 0, 0), (0, 60, 0)), **LIT), EYE),
}


def planned(graph: str, scene: Scene, camera: Camera, *, full: bool) -> Plan:
    """The plan of a shipped graph for a scene of the test's own."""
    document = load_document(graph, OVERRIDES[graph])
    return plan_for_scene(document, LoadedScene(scene, camera), PlanOptions(), full=full).plan


OVERRIDES = {
    name: ["frame.size=[48, 27]", "resources.shadow.fixed=[64, 64]"] for name in ("deferred_shading", "forward_shading")
}


def images(device: Device, graph: str, found: tuple[Scene, Camera], *, full: bool) -> dict[str, np.ndarray]:
    """Output and radiance."""
    document = load_document(graph, OVERRIDES[graph])
    plan = plan_for_scene(document, LoadedScene(*found), PlanOptions(), full=full)
    options = RenderOptions(samples=0, captures=("hdr",), full=full, poison=True)
    result = run_plan(plan, document, device, options, lambda stage, done, total: None)
    return {**result.images, **result.captures}


@pytest.mark.parametrize("graph", sorted(OVERRIDES))
@pytest.mark.parametrize("name", SCENES)
def test_specialised_and_full_are_one_image(device: Device, graph: str, name: str) -> None:
    specialised, full = (images(device, graph, SCENES[name], full=full) for full in (False, True))
    for output, pixels in full.items():
        assert specialised[output].tobytes() == pixels.tobytes(), output


SHIPPED = sorted(path.stem for path in GRAPHS.glob("*.yaml") if load_document(path).model.scene is not None)


@pytest.mark.parametrize("graph", SHIPPED)
@pytest.mark.parametrize("source", ["spheres", "cornell"])
def test_shipped_graphs_are_one_image_in_full(graph: str, source: str) -> None:
    document = load_document(graph)
    small = ["resources.shadow.fixed=[128, 128]"] if "shadow" in document.model.resources else []
    document = load_document(graph, ["scene.detail=0.1", *small])
    made = [
        render_document(document, RenderOptions(size=(64, 36), frames=2, samples=0, scene=source, full=full)).images
        for full in (False, True)
    ]
    for output, pixels in made[1].items():
        assert made[0][output].tobytes() == pixels.tobytes(), output


def test_a_view_that_is_told_wrong_shows(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison above can fail: without the glass that is in view the image is another."""
    found = SCENES["everything"]
    right = images(device, "deferred_shading", found, full=True)["hdr"]
    wrong = ViewFeatures(unseen=frozenset({"blended"}), near=0.1)
    monkeypatch.setattr("rendergraph.run.plan_document.view_features", lambda *_: wrong)
    assert images(device, "deferred_shading", found, full=False)["hdr"].tobytes() != right.tobytes()


# ---- decisions, by code


def decisions(name: str, graph: str = "deferred_shading") -> set[tuple[str, str, str]]:
    """(reason, subject, feature) of what was specialised, or culled."""
    plan = planned(graph, *SCENES[name], full=False)
    return {
        (d.reason, d.subject, str(d.evidence.get("feature", "")))
        for d in plan.decisions
        if d.kind in ("specialise", "cull")
    }


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("no sun", ("scene_lacks_feature", "shadows.draw", "sun")),
        ("no sun", ("nothing_reads_it", "shadows", "")),
        ("no lights", ("scene_lacks_feature", "light.light", "local_lights")),
        ("no lights", ("pass_left_out", "glass", "")),
        ("no lights", ("scene_lacks_feature", "gbuffer", "unlit")),
        ("no lights", ("scene_lacks_feature", "gbuffer", "double_sided")),
        ("no lights", ("scene_lacks_feature", "light.light", "emissive")),
        ("all masked", ("scene_lacks_feature", "gbuffer.opaque", "opaque")),
        ("empty", ("scene_lacks_feature", "glass.blended", "blended")),
        ("glass behind the camera", ("none_in_view", "glass.blended", "blended")),
        ("glass behind the camera", ("pass_left_out", "glass", "")),
        ("lamp behind the camera", ("none_in_view", "light.light", "emissive")),
        ("lamp behind the camera", ("nothing_reads_it", "gbuffer.no_emission", "")),
        ("leaves behind the camera", ("none_in_view", "gbuffer.masked", "masked")),
        ("nothing in view", ("nothing_casts_into_view", "shadows.draw", "")),
        ("nothing in view", ("none_in_view", "gbuffer.opaque", "opaque")),
        ("a light beyond reach", ("no_light_reaches_the_view", "light.light", "")),
        ("glass alone in view, over the ground", ("nothing_casts_into_view", "shadows.draw", "")),
        ("glass alone in view, over the ground", ("nothing_casts_into_view", "glass.blended", "")),
        ("far away", ("shadows_end_before_the_view", "shadows.draw", "")),
        ("far away", ("format_narrowed", "shadow", "")),
        ("a wall", ("scene_covers_the_frame", "sky.draw", "")),
        ("a wall", ("pass_left_out", "sky", "")),
    ],
)
def test_what_is_left_out_has_its_reason(name: str, expected: tuple[str, str, str]) -> None:
    assert expected in decisions(name)


def test_nothing_is_left_out_that_is_there() -> None:
    kept = {reason for reason, _, _ in decisions("everything")}
    assert not kept & {"none_in_view", "nothing_casts_into_view", "no_light_reaches_the_view", "pass_left_out"}
    assert "scene_covers_the_frame" not in kept


def test_every_decision_has_a_sentence() -> None:
    seen = set()
    for name in SCENES:
        for decision in planned("deferred_shading", *SCENES[name], full=False).decisions:
            assert (decision.kind, decision.reason) in SENTENCES
            assert "{" not in explain_decision(decision)
            seen.add(decision.reason)
    assert seen >= {reason for kind, reason in SENTENCES if kind == "specialise"}


def test_full_decides_nothing() -> None:
    for name in SCENES:
        plan = planned("deferred_shading", *SCENES[name], full=True)
        assert not [d for d in plan.decisions if d.kind == "specialise"], name


def test_a_narrowed_format_saves_its_bytes() -> None:
    plan = planned("deferred_shading", *SCENES["far away"], full=False)
    (narrowed,) = [d for d in plan.decisions if d.reason == "format_narrowed" and d.subject == "shadow"]
    assert narrowed.evidence == {"from": "d32f", "to": "d16", "by": "shadows", "saved": 64 * 64 * 3 * 2}
    full = planned("deferred_shading", *SCENES["far away"], full=True)
    assert full.totals.unshared - plan.totals.unshared >= 64 * 64 * 3 * 2


# ---- what stays, since it may not be relied on

FOREIGN = """rendergraph: 1
frame: {size: [16, 9]}
scene: {source: cornell}
resources: {depth: {format: d32f}, hdr: {format: rgba16f}, shadow: {format: d32f, fixed: [32, 32]}, table: {bytes: 320}}
passes:
  far: {node: clear, write: {target: depth}, set: {value: 1}}
  paint: {node: clear, write: {target: hdr}, set: {value: 0}}
  sky: {node: sky, read: {depth: depth}, write: {color: hdr}, after: [paint]}
outputs: {hdr: {file: a.npy}}
"""


def test_a_depth_of_another_pass_keeps_the_sky(tmp_path: Path) -> None:
    (tmp_path / "g.yaml").write_text(FOREIGN)
    document = load_document(tmp_path / "g.yaml")
    plan = plan_for_scene(document, LoadedScene(*SCENES["a wall"]), PlanOptions()).plan
    assert "sky.draw" in [step.name for step in plan.order]
    assert plan.graph.features is not None
    assert plan.graph.features.view is not None
    assert plan.graph.features.view.covered, "or this shows nothing"


SHOWN = """rendergraph: 1
frame: {size: [16, 9]}
scene: {source: cornell}
resources:
  depth: {format: d32f}
  normal: {format: rg16_snorm}
  base_color: {format: srgb8_a8}
  material: {format: rgb10_a2}
  emissive: {format: r11g11b10f}
passes:
  gbuffer:
    node: gbuffer
    write: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
  show: {node: fullscreen, read: {u_a: emissive}, write: {color: image}, set: {shader: show.frag}}
OUTPUTS
"""
SHOW = """#version 450
uniform sampler2D u_a;
out vec4 color;
void main() { color = texelFetch(u_a, ivec2(gl_FragCoord.xy), 0) + 0.25; }
"""


def test_black_emission_is_stored_in_a_byte_and_reads_the_same(device: Device, tmp_path: Path) -> None:
    (tmp_path / "show.frag").write_text(SHOW)
    (tmp_path / "g.yaml").write_text(SHOWN.replace("OUTPUTS", "outputs: {image: {file: a.npy, format: rgba16f}}"))
    document = load_document(tmp_path / "g.yaml")
    found = LoadedScene(*SCENES["no lights"])
    plans = [plan_for_scene(document, found, PlanOptions(), full=full) for full in (False, True)]
    formats = [p.plan.graph.resources["emissive"].desc.format for p in plans]  # type: ignore[union-attr]
    assert formats == ["r8", "r11g11b10f"]
    shown = [
        run_plan(p, document, device, RenderOptions(samples=0), lambda s, d, t: None).images["image"] for p in plans
    ]
    assert shown[0].tobytes() == shown[1].tobytes()


def test_an_output_keeps_the_format_its_author_chose(tmp_path: Path) -> None:
    (tmp_path / "show.frag").write_text(SHOW)
    outputs = "outputs: {emissive: {file: b.npy}, image: {file: a.npy, format: rgba16f}}"
    (tmp_path / "g.yaml").write_text(SHOWN.replace("OUTPUTS", outputs))
    plan = plan_for_scene(load_document(tmp_path / "g.yaml"), LoadedScene(*SCENES["no lights"]), PlanOptions()).plan
    assert plan.graph.resources["emissive"].desc.format == "r11g11b10f"  # type: ignore[union-attr]
