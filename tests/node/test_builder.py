"""The builder by itself: what each method declares, in names, sizes, accesses, clears and programs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from rendergraph.node.bindings import (
    Binding,
    color,
    depth,
    load_image,
    read_buffer,
    sample,
    store_image,
    uniform_block,
    update_buffer,
    update_image,
    write_buffer,
)
from rendergraph.node.builder import Builder
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    CopyBuffer,
    CopyTexture,
    DispatchIndirect,
    DrawArrays,
    DrawIndirect,
    Frame,
    Fullscreen,
    Program,
    Resource,
    SubPass,
    Target,
    TextureDesc,
    Usage,
)
from rendergraph.scene.features import SceneFeatures

NODE, GRAPH = Path("/node"), Path("/graph")
PROGRAM = Program((("fragment", NODE / "a.frag"),))


def builder(*, full: bool = False, depth: str = "reversed", features: SceneFeatures | None = None) -> Builder:
    """A pass ``p`` of a 101 x 51 frame: reads ``source`` (33 x 17, 3 mips) and ``list``, writes ``target``."""
    inputs = {
        "color": Resource("source", TextureDesc("rgba8", 33, 17, mips=3)),
        "list": Resource("list", BufferDesc(64)),
    }
    outputs = {"color": Resource("target", TextureDesc("rgba8", 101, 51))}
    frame = Frame(101, 51, depth=depth)
    return Builder("p", NODE, GRAPH, frame, features or SceneFeatures(), full, inputs, outputs)


def only(b: Builder) -> SubPass:
    (found,) = b.subpasses
    return found


# ---- what is connected


def test_ports_lead_to_resources() -> None:
    b = builder()
    assert (b.input("color"), b.output("color"), b.size("source")) == ("source", "target", (33, 17))
    with pytest.raises(KeyError):
        b.input("mask")
    with pytest.raises(KeyError):
        b.size("nobody")
    with pytest.raises(AssertionError):
        b.texture_desc("list")


# ---- internal targets


@pytest.mark.parametrize(
    ("scale", "like", "size"),
    [
        (1.0, None, (101, 51)),
        (0.5, None, (51, 26)),
        (0.25, "source", (9, 5)),
        (1 / 3, "source", (11, 6)),
        (2.0, "source", (66, 34)),
        (0.001, "source", (1, 1)),
    ],
)
def test_sizes_round_up(scale: float, like: str | None, size: tuple[int, int]) -> None:
    b = builder()
    assert b.size(b.texture("t", "r8", like=like, scale=scale)) == size


def test_internal_targets_are_the_passes_own() -> None:
    b = builder()
    assert b.texture("t", "r16f", size=(7, 5), layers=4, mips=2) == "p.t"
    assert b.buffer("b", 48) == "p.b"
    assert b.resources["p.t"].desc == TextureDesc("r16f", 7, 5, 4, 2, 1, Target.D2_ARRAY)
    assert b.resources["p.b"].desc == BufferDesc(48)
    assert not any(resource.declared for resource in b.resources.values())
    cube = b.texture("c", "r16f", size=(8, 8), layers=6, target=Target.CUBE)
    assert b.texture_desc(cube).target is Target.CUBE
    with pytest.raises(AssertionError):
        b.buffer("t", 4)


# ---- specialisation


@pytest.mark.parametrize(("present", "full", "decided"), [(True, False, 0), (False, False, 1), (False, True, 0)])
def test_requires_records_what_is_left_out(present: bool, full: bool, decided: int) -> None:
    b = builder(full=full, features=replace(SceneFeatures(), sun=present))
    assert b.requires("sun", "light") is (present or full)
    found = [(d.kind, d.reason, d.subject, d.evidence) for d in b.decisions]
    assert found == [("specialise", "scene_lacks_feature", "p.light", {"feature": "sun"})] * decided


def test_requires_without_a_step_is_about_the_pass_and_refuses_unknown_features() -> None:
    b = builder()
    b.requires("sun")
    assert [d.subject for d in b.decisions] == ["p"]
    with pytest.raises(AttributeError):
        b.requires("moon")


# ---- programs


def test_stages_follow_the_suffix_and_folders_the_prefix() -> None:
    b = builder()
    found = b.program("a.vert", "a.frag", "a.geom", "a.tesc", "a.tese")
    names = {stage: path.name for stage, path in found.stages}
    assert names == {
        "vertex": "a.vert", "fragment": "a.frag", "geometry": "a.geom",
        "tess_control": "a.tesc", "tess_evaluation": "a.tese",
    }  # fmt: skip
    assert not found.is_compute
    assert b.program("a.comp").is_compute
    assert b.program("a.frag").stages[0][1] == NODE / "a.frag"
    assert b.program("a.frag", user=True).stages[0][1] == GRAPH / "a.frag"
    shared = b.program("<fullscreen.vert>").stages[0]
    assert shared[0] == "vertex"
    assert shared[1].is_file()


@pytest.mark.parametrize("file", ["a.glsl", "a", "<a.txt>"])
def test_a_file_of_no_stage_is_refused(file: str) -> None:
    with pytest.raises(ValueError, match=r"\.vert"):
        builder().program(file)


def test_defines_are_written_out_sorted_and_tell_the_depth_convention() -> None:
    defines = {"TAPS": 3, "ALPHA": True, "CURVE": "agx", "BETA": False}
    found = builder().program("a.frag", defines=defines).defines
    assert found == (("ALPHA", "1"), ("BETA", "0"), ("CURVE", "agx"), ("DEPTH_REVERSED", "1"), ("TAPS", "3"))
    assert ("DEPTH_REVERSED", "0") in builder(depth="standard").program("a.frag").defines


# ---- draws


def test_a_fullscreen_draw_gets_the_shared_vertex_shader() -> None:
    b = builder()
    b.raster("whole", PROGRAM, color=[color("target")])
    b.raster("own", b.program("a.frag", "a.vert"), color=[color("target")])
    b.raster("points", PROGRAM, color=[color("target")], work=DrawArrays(3))
    whole, own, points = (step.program for step in b.subpasses)
    assert whole is not None
    assert own is not None
    assert points is not None
    assert dict(whole.stages)["vertex"].name == "fullscreen.vert"
    assert dict(own.stages)["vertex"] == NODE / "a.vert"
    assert "vertex" not in dict(points.stages)
    assert b.subpasses[0].work == Fullscreen()


@pytest.mark.parametrize(("convention", "far", "near"), [("reversed", 0.0, 1.0), ("standard", 1.0, 0.0)])
def test_depth_clears_are_mirrored_under_reversed_depth(convention: str, far: float, near: float) -> None:
    b = builder(depth=convention)
    z = b.texture("z", "d32f")
    b.raster("far", PROGRAM, depth=depth(z, clear=1.0))
    b.raster("near", PROGRAM, depth=depth(z, clear=0.0))
    assert [step.clears[z][0] for step in b.subpasses] == [far, near]
    assert [step.accesses for step in b.subpasses] == [(Access(z, Usage.DEPTH, load=False),)] * 2
    assert all(step.state.depth_write for step in b.subpasses)


def test_colour_clears_are_not_mirrored_and_load_is_declared() -> None:
    b = builder()
    b.raster("a", PROGRAM, color=[color("target", clear=(1.0, 0.0, 0.5, 1.0))])
    b.raster("b", PROGRAM, color=[color("target", load=True, mip=1, layer=2)])
    assert b.subpasses[0].clears == {"target": (1.0, 0.0, 0.5, 1.0)}
    assert b.subpasses[0].accesses == (Access("target", Usage.COLOR, load=False),)
    assert b.subpasses[1].clears == {}
    assert b.subpasses[1].accesses == (Access("target", Usage.COLOR, load=True, mip=1, layer=2),)


def test_read_only_depth_is_tested_kept_and_never_written() -> None:
    b = builder()
    z = b.texture("z", "d32f")
    b.raster("draw", PROGRAM, depth=depth(z, read_only=True))
    step = only(b)
    assert step.accesses == (Access(z, Usage.DEPTH_READ, load=True),)
    assert not step.state.depth_write
    assert step.clears == {}


def test_indirect_arguments_are_an_access() -> None:
    b = builder()
    b.raster("draw", PROGRAM, color=[color("target")], work=DrawIndirect("list"))
    b.compute("go", b.program("a.comp"), DispatchIndirect("list", 16))
    for step in b.subpasses:
        assert Access("list", Usage.INDIRECT) in step.accesses


# ---- bindings


@pytest.mark.parametrize(
    ("binding", "usage", "load"),
    [
        (sample("source"), Usage.SAMPLED, True),
        (load_image("source"), Usage.IMAGE_READ, True),
        (store_image("source"), Usage.IMAGE_WRITE, False),
        (store_image("source", partial=True), Usage.IMAGE_WRITE, True),
        (update_image("source"), Usage.IMAGE_UPDATE, True),
        (read_buffer("list"), Usage.STORAGE_READ, True),
        (write_buffer("list"), Usage.STORAGE_WRITE, False),
        (write_buffer("list", partial=True), Usage.STORAGE_WRITE, True),
        (update_buffer("list"), Usage.STORAGE_UPDATE, True),
        (uniform_block("list"), Usage.UNIFORM, True),
    ],
)
def test_a_binding_becomes_an_access_under_its_name(binding: Binding, usage: Usage, load: bool) -> None:
    b = builder()
    b.compute("go", b.program("a.comp"), (1, 1, 1), bind={"u_name": binding})
    (access,) = only(b).accesses
    assert (access.name, access.usage, access.load) == ("u_name", usage, load)


def test_a_sampler_says_everything_about_itself() -> None:
    b = builder()
    binding = sample("source", "mipmap", wrap="repeat", mip=1, layer=0, aspect="depth")
    b.raster("draw", PROGRAM, color=[color("target")], bind={"u_map": binding})
    expected = Access("source", Usage.SAMPLED, "u_map", True, 1, 0, "depth", "mipmap", "repeat")
    assert only(b).accesses[1] == expected


# ---- dispatches, copies, clears, mips


@pytest.mark.parametrize(
    ("tile", "groups"), [((8, 8), (5, 3, 1)), ((33, 17), (1, 1, 1)), ((32, 16), (2, 2, 1)), ((1, 1), (33, 17, 1))]
)
def test_groups_cover_the_last_partial_tile(tile: tuple[int, int], groups: tuple[int, int, int]) -> None:
    assert builder().groups("source", tile) == groups


def test_groups_in_depth() -> None:
    assert builder().groups("source", (16, 16), 6) == (3, 2, 6)


def test_copies_know_textures_from_buffers() -> None:
    b = builder()
    b.copy("t", "source", "target", blit=True, linear=True)
    b.copy("b", "list", b.buffer("other", 64))
    assert b.subpasses[0].work == CopyTexture("source", "target", True, True)
    assert b.subpasses[1].work == CopyBuffer("list", "p.other", 64)
    expected = (Access("source", Usage.COPY_FROM), Access("target", Usage.COPY_TO, load=False))
    assert b.subpasses[0].accesses == expected


def test_a_clear_replaces_all() -> None:
    b = builder()
    b.clear("zero", "target")
    assert only(b).accesses == (Access("target", Usage.CLEAR, load=False),)


def test_mips_read_the_first_level_and_replace_each_other() -> None:
    b = builder()
    b.mips("fill", "source")
    assert only(b).accesses == (
        Access("source", Usage.COPY_FROM, mip=0),
        Access("source", Usage.COPY_TO, load=False, mip=1),
        Access("source", Usage.COPY_TO, load=False, mip=2),
    )


def test_sub_passes_are_named_after_their_pass_and_once() -> None:
    b = builder()
    b.clear("one", "target")
    b.clear("two", "target")
    assert [step.name for step in b.subpasses] == ["p.one", "p.two"]
    assert {step.parent for step in b.subpasses} == {"p"}
    with pytest.raises(AssertionError):
        b.clear("one", "target")
