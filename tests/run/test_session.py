"""Scenes that change between frames: the right picture, plans that are kept, nothing made on the way back."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.report.timing import timing_record
from rendergraph.report.timing_shape import TimingRecord
from rendergraph.run.options import RenderOptions
from rendergraph.run.render import render_document
from rendergraph.run.session import Session

pytestmark = pytest.mark.gpu

LIGHTS = "{from_scene: false, sun: {direction: [0.5, -0.8, -0.6]}, ambient: {}}"
TEXT = """rendergraph: 1
frame: {size: [48, 27], count: COUNT}
scene:
  source: spheres
  detail: 0.1
  camera: {position: [0, 2, 9], target: [0, 1, 0]}
  lights: LIGHTS
  changes: [CHANGES]
resources:
  depth:    {format: d32f}
  shadow:   {format: d32f, fixed: [128, 128], layers: 2}
  cascades: {bytes: 320}
  hdr:      {format: rgba16f}
passes:
  shadows:
    node: shadow_map
    write: {map: shadow, cascades: cascades}
  shade:
    node: forward_shading
    read: {shadow_map: shadow, cascades: cascades}
    write: {color: hdr, depth: depth}
  sky:
    node: sky
    read: {depth: depth}
    write: {color: hdr}
    after: [shade]
outputs:
  hdr: {file: "hdr_{frame}.npy"}
"""

NO_SUN = "sun: none"
SUN = "sun: {direction: [0.5, -0.8, -0.6]}"
LAMP = "lights: {from_scene: false, list: [{position: [0, 3, 2], intensity: 9, radius: 20}]}"
LAMP_MOVED = "lights: {from_scene: false, list: [{position: [1, 2, 2], intensity: 5, radius: 20}]}"
HIDE = "hide: [ground]"
CAMERA = "camera: {position: [3, 2, 7], target: [0, 1, 0]}"
ORBIT = "camera: {position: [3, 2, 7], target: [0, 1, 0], orbit: {turns: 1}}"


def text(*changes: tuple[int, str], count: int = 4) -> str:
    """The graph with changes at frames."""
    entries = ", ".join(f"{{frame: {frame}, {what}}}" for frame, what in changes)
    return TEXT.replace("COUNT", str(count)).replace("CHANGES", entries).replace("LIGHTS", LIGHTS)


def render(folder: Path, source: str, **options: Any) -> Any:
    (folder / "g.yaml").write_text(source)
    return render_document(load_document(folder / "g.yaml"), RenderOptions(samples=0, **options))


@pytest.mark.parametrize("change", [NO_SUN, LAMP, HIDE, CAMERA, ORBIT], ids=lambda c: c.split(":")[0] + c[-12:])
@pytest.mark.parametrize("full", [False, True])
def test_an_image_after_a_change_is_that_of_a_run_that_began_with_it(tmp_path: Path, change: str, full: bool) -> None:
    switched = render(tmp_path, text((2, change)), full=full).images
    fresh = render(tmp_path, text((0, change)), full=full).images
    before = render(tmp_path, text(), full=full).images
    for frame in range(4):
        expected = (before if frame < 2 else fresh)[f"hdr@{frame}"]
        assert np.array_equal(switched[f"hdr@{frame}"], expected), frame
    assert not np.array_equal(fresh["hdr@3"], before["hdr@3"]), "a change that changes nothing proves nothing"


def test_changes_add_up(tmp_path: Path) -> None:
    found = render(tmp_path, text((1, NO_SUN), (2, HIDE), (3, "hide: []"))).images
    both = render(tmp_path, text((0, f"{NO_SUN}, {HIDE}"))).images
    alone = render(tmp_path, text((0, NO_SUN))).images
    assert np.array_equal(found["hdr@2"], both["hdr@2"])
    assert np.array_equal(found["hdr@3"], alone["hdr@3"])
    assert not np.array_equal(both["hdr@2"], alone["hdr@2"])


def test_the_way_back_makes_nothing(tmp_path: Path) -> None:
    source = text((2, NO_SUN), (3, SUN), (4, NO_SUN), (5, SUN), count=7)
    # Programs are kept as long as the device: a value that no other test has makes new ones.
    result = render(tmp_path, source.replace("node: sky\n", "node: sky\n    set: {horizon: 0.0317}\n"))
    first, *revisits = result.switches
    assert (first.frame, first.plan, first.revisited) == (2, 1, False)
    assert first.objects_created > 0
    assert first.programs_compiled > 0
    assert [(s.frame, s.plan, s.revisited) for s in revisits] == [(3, 0, True), (4, 1, True), (5, 0, True)]
    for switch in revisits:
        assert (switch.objects_created, switch.programs_compiled, switch.bytes_uploaded) == (0, 0, 0)
    steady = result.steady
    assert (steady.objects_created, steady.programs_compiled, steady.bytes_uploaded) == (0, 0, 0)
    assert np.array_equal(result.images["hdr@1"], result.images["hdr@6"])


def test_another_light_under_the_same_features_is_uploaded_alone(tmp_path: Path) -> None:
    result = render(tmp_path, text((1, LAMP), (2, LAMP_MOVED), (3, LAMP)))
    again = [s for s in result.switches if s.revisited]
    assert [s.frame for s in again] == [2, 3]
    assert {s.plan for s in result.switches} == {1}
    for switch in again:
        assert (switch.objects_created, switch.programs_compiled) == (0, 0)
        assert 0 < switch.bytes_uploaded <= 64, "one light"
    assert not np.array_equal(result.images["hdr@1"], result.images["hdr@2"])
    assert np.array_equal(result.images["hdr@1"], result.images["hdr@3"])


def test_a_hidden_node_is_another_plan_only_where_features_differ(tmp_path: Path) -> None:
    result = render(tmp_path, text((1, HIDE), (2, "hide: []"), (3, HIDE)))
    assert [(s.revisited, s.objects_created > 0) for s in result.switches] == [
        (False, True), (True, False), (True, False),
    ]  # fmt: skip


# ---- history

METERED = """rendergraph: 1
frame: {size: [32, 18], count: 6}
scene:
  source: spheres
  detail: 0.1
  camera: {position: [0, 2, 9], target: [0, 1, 0]}
  lights: {from_scene: false, sun: {direction: [0.5, -0.8, -0.6]}, ambient: {}}
  changes: [CHANGES]
resources:
  hdr:      {format: rgba16f}
  exposure: {bytes: 16}
  last:     {previous: exposure}
passes:
  shade: {node: forward_shading, write: {color: hdr}}
  meter:
    node: exposure
    read: {color: hdr, previous: last}
    write: {exposure: exposure}
    set: {brighten: 0.25, darken: 0.25}
outputs:
  exposure: {file: "exposure_{frame}.npy"}
"""


def test_history_survives_a_switch(tmp_path: Path) -> None:
    sun = "{direction: [0.5, -0.8, -0.6], illuminance: 40}"
    bright = f"{{frame: 1, sun: {sun}}}"
    plain = render(tmp_path, METERED.replace("CHANGES", bright)).images
    # A plan of its own that meters the very same picture: it has a light, too faint to change a bit.
    dark = f"{{from_scene: false, sun: {sun}, ambient: {{}}, list: [{{position: [0, 0, 0], intensity: 1.0e-30}}]}}"
    switched = render(tmp_path, METERED.replace("CHANGES", f"{bright}, {{frame: 3, lights: {dark}}}"))
    assert [s.history_kept for s in switched.switches] == [(), ("last",)]
    assert not switched.warnings or "RG792" not in [w.code for w in switched.warnings]
    values = [plain[f"exposure@{frame}"][0, 0, 0] for frame in range(6)]
    assert len(set(values)) == 6, "it must still be adapting, or history shows nothing"
    for frame in range(6):
        assert np.array_equal(switched.images[f"exposure@{frame}"], plain[f"exposure@{frame}"]), frame


GLOWING = """rendergraph: 1
frame: {size: [32, 18], count: 4}
scene:
  source: cornell
  changes: [{frame: 1, hide: [lamp]}, {frame: 2, hide: []}]
resources:
  depth:      {format: d32f}
  normal:     {format: rg16_snorm}
  base_color: {format: srgb8_a8}
  material:   {format: rgb10_a2}
  emissive:   {format: r11g11b10f}
  last:       {previous: emissive}
passes:
  gbuffer:
    node: gbuffer
    write: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
  light:
    node: deferred_lighting
    read: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: last}
    write: {color: hdr}
outputs: {hdr: {file: "hdr_{frame}.npy", format: rgba16f}}
"""


def test_history_that_the_other_plan_lacks_starts_from_zeros(tmp_path: Path) -> None:
    result = render(tmp_path, GLOWING)
    gone, back = result.switches
    assert (gone.history_kept, gone.history_cleared) == ((), ())
    assert (back.plan, back.revisited, back.history_cleared) == (0, True, ("last",))
    assert [found.code for found in result.warnings].count("RG792") == 1
    images = [result.images[f"hdr@{frame}"] for frame in range(4)]
    assert np.array_equal(images[2], images[0]), "as before the first frame"
    assert not np.array_equal(images[3], images[2]), "what frame 2 emitted"


# ---- the library


def test_a_session_takes_changes_as_they_come(tmp_path: Path) -> None:
    (tmp_path / "g.yaml").write_text(text())
    fresh = render(tmp_path, text((0, NO_SUN))).images
    (tmp_path / "g.yaml").write_text(text())
    with Session.open(load_document(tmp_path / "g.yaml")) as session:
        session.frame()
        lit = session.read("hdr")
        session.frame({"sun": "none"})
        assert np.array_equal(session.read("hdr"), fresh["hdr@1"])
        session.frame({"lights": {"from_scene": False, "sun": {"direction": [0.5, -0.8, -0.6]}, "ambient": {}}})
        assert np.array_equal(session.read("hdr"), lit)
        before = session.plan
        session.frame()
        assert session.plan is before
        assert [s.revisited for s in session.switches] == [False, True]


def test_a_moving_camera_makes_nothing(tmp_path: Path) -> None:
    (tmp_path / "g.yaml").write_text(text())
    with Session.open(load_document(tmp_path / "g.yaml")) as session:
        session.frame()
        images = []
        for x in (0.5, 1.0, 1.5):
            session.frame({"camera": {"position": [x, 2, 9], "target": [0, 1, 0]}})
            images.append(session.read("hdr").tobytes())
        assert len(set(images)) == 3
        assert sum(s.programs_compiled + s.objects_created for s in session.switches) == 0


def test_what_a_session_made_is_gone_after_it(tmp_path: Path, device: Any) -> None:
    owned = {key for key in device.owned if key[0] != "glDeleteSamplers"}
    (tmp_path / "g.yaml").write_text(text((1, NO_SUN), (2, HIDE)))
    with Session.open(load_document(tmp_path / "g.yaml")) as session:
        for _ in range(4):
            session.frame()
    assert {key for key in device.owned if key[0] != "glDeleteSamplers"} == owned


def test_a_graph_without_a_scene_cannot_change() -> None:
    with Session.open(load_document("fullscreen"), RenderOptions(size=(8, 8))) as session:
        with pytest.raises(RenderGraphError) as caught:
            session.frame({"sun": "none"})
        assert [d.code for d in caught.value.diagnostics] == ["RG793"]


# ---- mistakes, and the record


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        (((1, "hide: [grond]"),), "RG790"),
        (((1, "hide: ['']"),), "RG790"),
        (((1, "camera: {name: nobody}"),), "RG652"),
    ],
)
def test_mistakes_are_told_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, changes: tuple[tuple[int, str], ...], code: str
) -> None:
    monkeypatch.setattr(Session, "prepare", lambda *_: pytest.fail("it ran"))
    with pytest.raises(RenderGraphError) as caught:
        render(tmp_path, text(*changes))
    (found,) = caught.value.diagnostics
    assert found.code == code
    assert found.position is not None
    assert found.position.line == 8


@pytest.mark.parametrize("changes", [((2, NO_SUN), (1, SUN)), ((1, NO_SUN), (1, SUN)), ((1, "sun: null"),)])
def test_changes_in_disorder_or_without_content_are_refused(
    tmp_path: Path, changes: tuple[tuple[int, str], ...]
) -> None:
    with pytest.raises(RenderGraphError):
        render(tmp_path, text(*changes))


def test_a_change_after_the_last_frame_is_told(tmp_path: Path) -> None:
    result = render(tmp_path, text((9, NO_SUN)))
    assert "RG791" in [found.code for found in result.warnings]
    assert not result.switches


def test_the_record_says_which_plan_ran_when(tmp_path: Path) -> None:
    changed = json.loads(json.dumps(timing_record(render(tmp_path, text((1, NO_SUN), (2, SUN))))))
    assert [(s["frame"], s["plan"], s["revisited"]) for s in changed["switches"]] == [(1, 1, False), (2, 0, True)]
    assert changed["switches"][1]["objects_created"] == 0
    TimingRecord.model_validate(changed)
    assert "switches" not in timing_record(render(tmp_path, text()))
