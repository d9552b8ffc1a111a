"""The nodes for users' own shaders: what they declare to the planner, and what they refuse."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from graph_run import Desc, build_node

from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.node.builder import Builder
from rendergraph.node.discovery import find_node
from rendergraph.plan.graph import (
    ADDITIVE,
    Access,
    BufferDesc,
    ClearResource,
    CopyBuffer,
    CopyTexture,
    Dispatch,
    DispatchIndirect,
    DrawArrays,
    DrawIndirect,
    DrawScene,
    Frame,
    GenerateMips,
    Target,
    TextureDesc,
    Usage,
)

COLOR = TextureDesc("rgba16f", 64, 32)
SMALL = TextureDesc("rgba16f", 32, 16)
DEPTH = TextureDesc("d32f", 64, 32)
STENCIL = TextureDesc("d24s8", 64, 32)
COUNTS = TextureDesc("r32ui", 64, 32)
LAYERS = TextureDesc("rgba16f", 64, 32, layers=5, target=Target.D2_ARRAY)
MULTI = TextureDesc("rgba16f", 64, 32, samples=4)
MIPS = TextureDesc("rgba16f", 64, 32, mips=7)
BUFFER = BufferDesc(64)
ON = {"ON": True}
TRIANGLE = {"vertex": "a.vert", "fragment": "a.frag", "vertices": 3}

Ports = Mapping[str, Desc]


def build(node: str, params: Mapping[str, Any], inputs: Ports, outputs: Ports, depth: str = "reversed") -> Builder:
    """The node built for a frame of 64 x 32."""
    return build_node(node, params, inputs, outputs, frame=Frame(64, 32, depth=depth))


@pytest.fixture(autouse=True)
def _shaders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for suffix in ("vert", "frag", "geom", "tesc", "tese", "comp"):
        (tmp_path / f"a.{suffix}").touch()
    monkeypatch.chdir(tmp_path)


def access(b: Builder, resource: str, step: int = 0) -> Access:
    """The one access of a step to a resource."""
    found = [a for a in b.subpasses[step].accesses if a.resource == resource]
    assert len(found) == 1
    return found[0]


# ---------------------------------------------------------------- fullscreen


def test_fullscreen_binds_by_kind_of_resource() -> None:
    b = build(
        "fullscreen",
        {"shader": "a.frag", "filter": "linear", "wrap": {"u_a": "repeat"}, "stencil": ["u_s"], "defines": ON},
        {"u_a": COLOR, "u_n": COUNTS, "u_d": DEPTH, "u_s": STENCIL, "Table": BUFFER, "u_m": MULTI},
        {"first": COLOR, "z": DEPTH, "second": COLOR, "Log": BUFFER},
    )  # fmt: skip
    step = b.subpasses[0]
    assert [a.resource for a in step.accesses if a.usage is Usage.COLOR] == ["out_first", "out_second"]
    assert access(b, "out_z").usage is Usage.DEPTH
    assert step.state.depth_test == "always"
    assert access(b, "out_Log") == Access("out_Log", Usage.STORAGE_UPDATE, "Log")
    assert access(b, "in_Table") == Access("in_Table", Usage.STORAGE_READ, "Table")
    assert access(b, "in_u_a") == Access("in_u_a", Usage.SAMPLED, "u_a", filter="linear", wrap="repeat")
    # a filter for all inputs leaves out those that cannot be filtered
    assert access(b, "in_u_n").filter == "nearest"
    assert access(b, "in_u_m").filter == "nearest"
    assert (access(b, "in_u_d").aspect, access(b, "in_u_s").aspect) == ("depth", "stencil")
    assert step.program is not None
    assert ("ON", "1") in step.program.defines
    assert [stage for stage, _ in step.program.stages] == ["fragment", "vertex"]


@pytest.mark.parametrize(
    ("params", "load", "clear"),
    [
        ({}, False, None),
        ({"keep": ["c"]}, True, None),
        ({"clear": {"c": 0.5}}, False, (0.5, 0.5, 0.5, 0.5)),
        ({"clear": {"c": [1.0, 2.0, 3.0, 4.0]}}, False, (1.0, 2.0, 3.0, 4.0)),
        ({"blend": "add"}, True, None),
        ({"blend": "add", "clear": {"c": 0.0}}, False, (0.0, 0.0, 0.0, 0.0)),
        ({"blend": {"c": "add"}}, True, None),
    ],
)
def test_how_a_fullscreen_target_starts(params: dict[str, Any], load: bool, clear: Any) -> None:
    node = find_node("fullscreen")
    b = build("fullscreen", {"shader": "a.frag", **params}, {}, {"c": COLOR})
    assert access(b, "out_c").load is load
    assert b.subpasses[0].clears.get("out_c") == clear
    assert node(node.params_type(shader="a.frag", **params)).modifies("c") is load
    assert b.subpasses[0].state.blend == ((ADDITIVE,) if "blend" in params else ())


# ---------------------------------------------------------------- compute


def test_compute_binds_images_samplers_and_buffers() -> None:
    b = build(
        "compute",
        {"shader": "a.comp", "images": ["i"], "update": ["u", "Sum"]},
        {"s": COLOR, "i": COLOR, "Table": BUFFER},
        {"o": LAYERS, "u": COUNTS, "List": BUFFER, "Sum": BUFFER},
    )
    found = {a.name: (a.usage, a.load) for a in b.subpasses[0].accesses}
    assert found == {
        "s": (Usage.SAMPLED, True),
        "i": (Usage.IMAGE_READ, True),
        "Table": (Usage.STORAGE_READ, True),
        "o": (Usage.IMAGE_WRITE, False),
        "u": (Usage.IMAGE_UPDATE, True),
        "List": (Usage.STORAGE_WRITE, False),
        "Sum": (Usage.STORAGE_UPDATE, True),
    }
    assert b.subpasses[0].work == Dispatch(8, 4, 5)
    program = b.subpasses[0].program
    assert program is not None
    assert {("TILE_X", "8"), ("TILE_Y", "8")} <= set(program.defines)


@pytest.mark.parametrize(
    ("params", "work"),
    [
        ({"groups": [3, 2, 1]}, Dispatch(3, 2, 1)),
        ({"per_texel": [7, 16]}, Dispatch(10, 2, 1)),
        ({"per_texel": [16, 16], "of": "small"}, Dispatch(2, 1, 1)),
        ({"indirect": "Count"}, DispatchIndirect("in_Count")),
    ],
)
def test_work_groups(params: dict[str, Any], work: Any) -> None:
    b = build("compute", {"shader": "a.comp", **params}, {"small": SMALL, "Count": BUFFER}, {"o": COLOR})
    assert b.subpasses[0].work == work
    assert access(b, "in_Count").usage is (Usage.INDIRECT if "indirect" in params else Usage.STORAGE_READ)


@pytest.mark.parametrize(("size", "fine"), [("8", True), ("TILE_X", True), ("16", False)])
def test_a_local_size_of_numbers_must_be_the_tile(tmp_path: Path, size: str, fine: bool) -> None:
    (tmp_path / "a.comp").write_text(f"layout(local_size_x = {size}, local_size_y = 8) in;")
    if fine:
        build("compute", {"shader": "a.comp"}, {}, {"o": COLOR})
    else:
        with pytest.raises(RenderGraphError):
            build("compute", {"shader": "a.comp"}, {}, {"o": COLOR})


# ---------------------------------------------------------------- draw


def test_draw_clears_to_nothing_and_far_unless_told() -> None:
    b = build("draw", TRIANGLE, {}, {"c": COLOR, "z": DEPTH})
    assert b.subpasses[0].clears == {"out_c": (0.0, 0.0, 0.0, 0.0), "out_z": (0.0, 0.0, 0.0, 0.0)}
    b = build("draw", TRIANGLE, {}, {"c": COLOR, "z": DEPTH}, depth="standard")
    assert b.subpasses[0].clears["out_z"][0] == 1.0
    b = build("draw", {**TRIANGLE, "keep": ["c", "z"]}, {}, {"c": COLOR, "z": DEPTH})
    assert b.subpasses[0].clears == {}
    assert access(b, "out_c").load
    assert access(b, "out_z").load


def test_draw_against_depth_that_is_read() -> None:
    b = build("draw", {**TRIANGLE, "depth_read": "z"}, {"z": DEPTH, "u": COLOR}, {"c": COLOR})
    assert access(b, "in_z") == Access("in_z", Usage.DEPTH_READ)
    assert not b.subpasses[0].state.depth_write
    assert access(b, "in_u").name == "u"


@pytest.mark.parametrize(
    ("params", "work"),
    [
        ({"vertices": 36, "instances": 4}, DrawArrays(36, 4)),
        ({"vertices": 8, "topology": "lines"}, DrawArrays(8, 1, "lines")),
        ({"vertices": 36, "instances": 4, "separate": True}, DrawArrays(36, 4, separate=True)),
        (
            {"vertices": 3, "tess_control": "a.tesc", "tess_evaluation": "a.tese", "geometry": "a.geom"},
            DrawArrays(3, 1, "patches"),
        ),
        ({"queues": ["opaque", "masked"], "cull": "back"}, DrawScene(("opaque", "masked"), 1, "back")),
        ({"indirect": "args", "draws": 4}, DrawIndirect("in_args", count=4)),
    ],
)
def test_what_is_drawn(params: dict[str, Any], work: Any) -> None:
    b = build("draw", {"vertex": "a.vert", "fragment": "a.frag", **params}, {"args": BUFFER}, {"c": COLOR})
    assert b.subpasses[0].work == work
    assert b.subpasses[0].program is not None
    assert len(b.subpasses[0].program.stages) == 2 + sum(isinstance(v, str) and v[:2] == "a." for v in params.values())


# ---------------------------------------------------------------- copy, clear


def test_copies() -> None:
    b = build("copy", {}, {"source": COLOR}, {"destination": TextureDesc("rg32f", 64, 32)})
    assert b.subpasses[0].work == CopyTexture("in_source", "out_destination")
    b = build("copy", {"blit": True, "linear": True}, {"source": COLOR}, {"destination": SMALL})
    assert b.subpasses[0].work == CopyTexture("in_source", "out_destination", True, True)
    b = build("copy", {"blit": True}, {"source": MULTI}, {"destination": COLOR})
    assert b.subpasses[0].work == CopyTexture("in_source", "out_destination", True)
    b = build("copy", {"mips": True}, {"source": COLOR}, {"destination": MIPS})
    assert b.subpasses[1].work == GenerateMips("out_destination")
    b = build("copy", {}, {"source": BUFFER}, {"destination": BUFFER})
    assert b.subpasses[0].work == CopyBuffer("in_source", "out_destination", 64)
    b = build("copy", {"path": "host"}, {"source": BUFFER}, {"destination": BUFFER})
    assert b.subpasses[0].work == CopyBuffer("in_source", "out_destination", 64, host=True)
    b = build("copy", {"path": "host"}, {"source": LAYERS}, {"destination": LAYERS})
    assert b.subpasses[0].work == CopyTexture("in_source", "out_destination", host=True)


@pytest.mark.parametrize(
    ("source", "destination", "params"),
    [
        (COLOR, TextureDesc("rg32f", 64, 32), {}),  # one view class, two formats
        (COLOR, SMALL, {"blit": True}),
        (MULTI, MULTI, {}),
        (STENCIL, STENCIL, {}),
    ],
)
def test_what_does_not_pass_through_the_host(source: Desc, destination: Desc, params: dict[str, Any]) -> None:
    build("copy", params, {"source": source}, {"destination": destination})
    with pytest.raises(RenderGraphError) as error:
        build("copy", {"path": "host", **params}, {"source": source}, {"destination": destination})
    assert error.value.diagnostics[0].code == "RG225"


@pytest.mark.parametrize("params", [{"indirect": "x"}, {"queues": ["opaque"]}, {"vertices": 1, "instances": 70000}])
def test_what_is_not_drawn_separately(params: dict[str, Any]) -> None:
    draw = find_node("draw").params_type
    draw(vertex="a.vert", fragment="a.frag", **params)
    with pytest.raises(ValueError, match="separate"):
        draw(vertex="a.vert", fragment="a.frag", separate=True, **params)


@pytest.mark.parametrize(
    ("desc", "params", "depth", "value"),
    [
        (COLOR, {}, "reversed", (0.0, 0.0, 0.0, 0.0)),
        (COLOR, {"value": 2}, "reversed", (2.0, 2.0, 2.0, 2.0)),
        (COLOR, {"value": [1.0, 2.0, 3.0, 4.0]}, "reversed", (1.0, 2.0, 3.0, 4.0)),
        (DEPTH, {"value": 1}, "reversed", (0.0, 0.0, 0.0, 0.0)),
        (DEPTH, {"value": 1}, "standard", (1.0, 0.0, 0.0, 0.0)),
        (STENCIL, {"value": 0.25, "stencil": 7}, "reversed", (0.75, 7.0, 0.0, 0.0)),
        (BUFFER, {"value": 4294967295}, "reversed", 4294967295),
    ],
)
def test_clears(desc: Desc, params: dict[str, Any], depth: str, value: Any) -> None:
    b = build("clear", params, {}, {"target": desc}, depth)
    assert b.subpasses[0].work == ClearResource("out_target", value)


# ---------------------------------------------------------------- mistakes


MISTAKES: dict[str, tuple[str, dict[str, Any], Ports, Ports]] = {
    "filter of nothing": ("fullscreen", {"shader": "a.frag", "filter": {"no": "linear"}}, {}, {"c": COLOR}),
    "wrap of nothing": ("fullscreen", {"shader": "a.frag", "wrap": {"no": "repeat"}}, {}, {"c": COLOR}),
    "stencil of nothing": ("fullscreen", {"shader": "a.frag", "stencil": ["no"]}, {}, {"c": COLOR}),
    "stencil of colour": ("fullscreen", {"shader": "a.frag", "stencil": ["u"]}, {"u": COLOR}, {"c": COLOR}),
    "keeps nothing": ("fullscreen", {"shader": "a.frag", "keep": ["no"]}, {}, {"c": COLOR}),
    "clears nothing": ("fullscreen", {"shader": "a.frag", "clear": {"no": 0.0}}, {}, {"c": COLOR}),
    "blends nothing": ("fullscreen", {"shader": "a.frag", "blend": {"no": "add"}}, {}, {"c": COLOR}),
    "kept and cleared": ("fullscreen", {"shader": "a.frag", "keep": ["c"], "clear": {"c": 0.0}}, {}, {"c": COLOR}),
    "two depths": ("fullscreen", {"shader": "a.frag"}, {}, {"c": DEPTH, "d": DEPTH}),
    "no texture": ("fullscreen", {"shader": "a.frag"}, {}, {"List": BUFFER}),
    "nine colours": ("fullscreen", {"shader": "a.frag"}, {}, {f"c{i}": COLOR for i in range(9)}),
    "image of nothing": ("compute", {"shader": "a.comp", "images": ["no"]}, {}, {"c": COLOR}),
    "updates nothing": ("compute", {"shader": "a.comp", "update": ["no"]}, {}, {"c": COLOR}),
    "computes nothing": ("compute", {"shader": "a.comp"}, {"u": COLOR}, {}),
    "covers nothing": ("compute", {"shader": "a.comp"}, {}, {"List": BUFFER}),
    "covers a buffer": ("compute", {"shader": "a.comp", "of": "List"}, {}, {"List": BUFFER, "c": COLOR}),
    "covers no port": ("compute", {"shader": "a.comp", "of": "no"}, {}, {"c": COLOR}),
    "indirect of nothing": ("compute", {"shader": "a.comp", "indirect": "no"}, {}, {"c": COLOR}),
    "one name twice": ("compute", {"shader": "a.comp"}, {"c": COLOR}, {"c": COLOR}),
    "no fragment shader": ("draw", {"vertex": "a.vert", "vertices": 3}, {}, {"c": COLOR}),
    "depth twice": ("draw", {**TRIANGLE, "depth_read": "z"}, {"z": DEPTH}, {"c": COLOR, "d": DEPTH}),
    "depth of nothing": ("draw", {**TRIANGLE, "depth_read": "no"}, {}, {"c": COLOR}),
    "arguments of nothing": ("draw", {"vertex": "a.vert", "fragment": "a.frag", "indirect": "no"}, {}, {"c": COLOR}),
    "sizes": ("copy", {}, {"source": COLOR}, {"destination": SMALL}),
    "view classes": ("copy", {}, {"source": COLOR}, {"destination": TextureDesc("rgba8", 64, 32)}),
    "copied layers": ("copy", {}, {"source": LAYERS}, {"destination": COLOR}),
    "copied samples": ("copy", {}, {"source": MULTI}, {"destination": COLOR}),
    "levels undefined": ("copy", {}, {"source": COLOR}, {"destination": MIPS}),
    "levels lost": ("copy", {}, {"source": MIPS}, {"destination": COLOR}),
    "levels of one": ("copy", {"mips": True}, {"source": COLOR}, {"destination": COLOR}),
    "depth to colour": ("copy", {"blit": True}, {"source": DEPTH}, {"destination": COLOR}),
    "depth to depth": ("copy", {"blit": True}, {"source": DEPTH}, {"destination": STENCIL}),
    "integer to real": ("copy", {"blit": True}, {"source": COUNTS}, {"destination": COLOR}),
    "interpolated depth": ("copy", {"blit": True, "linear": True}, {"source": DEPTH}, {"destination": DEPTH}),
    "scaled resolve": ("copy", {"blit": True}, {"source": MULTI}, {"destination": SMALL}),
    "to samples": ("copy", {"blit": True}, {"source": COLOR}, {"destination": MULTI}),
    "blitted layers": ("copy", {"blit": True}, {"source": LAYERS}, {"destination": COLOR}),
    "blitted levels": ("copy", {"blit": True}, {"source": MIPS}, {"destination": MIPS}),
    "texture to buffer": ("copy", {}, {"source": COLOR}, {"destination": BUFFER}),
    "buffer sizes": ("copy", {}, {"source": BUFFER}, {"destination": BufferDesc(32)}),
    "buffer to a fraction": ("clear", {"value": 0.5}, {}, {"target": BUFFER}),
    "buffer to a negative": ("clear", {"value": -1}, {}, {"target": BUFFER}),
    "depth beyond far": ("clear", {"value": 2}, {}, {"target": DEPTH}),
    "depth of four": ("clear", {"value": [0.0, 0.0, 0.0, 0.0]}, {}, {"target": DEPTH}),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes(name: str) -> None:
    node, params, inputs, outputs = MISTAKES[name]
    with pytest.raises(RenderGraphError) as caught:
        build(node, params, inputs, outputs)
    assert [d.code for d in caught.value.diagnostics] == ["RG225"]


@pytest.mark.parametrize(
    ("node", "params"),
    [
        ("fullscreen", {"shader": "a.comp"}),
        ("fullscreen", {"shader": "a.frag", "uniforms": {"u": [1.0]}}),
        ("fullscreen", {"shader": "a.frag", "uniforms": {"2u": 1.0}}),
        ("fullscreen", {"shader": "a.frag", "defines": {"A": "1\n#error"}}),
        ("compute", {"shader": "a.frag"}),
        ("compute", {"shader": "a.comp", "groups": [1, 1, 1], "per_texel": [8, 8]}),
        ("compute", {"shader": "a.comp", "groups": [1, 1, 1], "of": "c"}),
        ("compute", {"shader": "a.comp", "groups": [0, 1, 1]}),
        ("compute", {"shader": "a.comp", "per_texel": [64, 32]}),
        ("draw", {"vertex": "a.frag", "vertices": 3}),
        ("draw", {"vertex": "a.vert", "fragment": "a.vert", "vertices": 3}),
        ("draw", {"vertex": "a.vert"}),
        ("draw", {"fragment": "a.frag", "vertices": 3}),
        ("draw", {"fragment": "a.frag", "queues": ["opaque"], "tess_evaluation": "a.tese"}),
        ("draw", {"vertex": "a.vert", "vertices": 3, "queues": ["opaque"]}),
        ("draw", {"vertex": "a.vert", "vertices": 3, "tess_control": "a.tesc"}),
        ("draw", {"vertex": "a.vert", "vertices": 3, "tess_evaluation": "a.tese", "topology": "lines"}),
        ("clear", {"value": [1.0, 2.0]}),
    ],
)
def test_parameters_refused_when_the_file_is_loaded(tmp_path: Path, node: str, params: dict[str, Any]) -> None:
    import yaml

    document = {"rendergraph": 1, "passes": {"p": {"node": node, "write": {"target": "c"}, "set": params}}}
    path = tmp_path / "graph.yaml"
    path.write_text(yaml.safe_dump({**document, "outputs": {"c": {"file": "c.png"}}}))
    with pytest.raises(RenderGraphError) as caught:
        load_document(path)
    assert {d.code for d in caught.value.diagnostics} == {"RG205"}
    assert all(d.position is not None and d.position.line > 1 for d in caught.value.diagnostics)
