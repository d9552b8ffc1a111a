"""The nodes for users' own shaders on the device: every image here has a closed form, and is equal to it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from graph_run import run_graph

pytestmark = [pytest.mark.gpu, pytest.mark.usefixtures("device")]

WIDTH, HEIGHT = 13, 7
FRAME = {"size": [WIDTH, HEIGHT]}
X, Y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
HEAD = "#version 450\n"
PLACE = HEAD + "out vec4 color;\nvoid main() { color = vec4(gl_FragCoord.xy, 1.0, 1.0); }\n"

Array = npt.NDArray[Any]


def run(
    folder: Path, passes: Mapping[str, Any], shaders: Mapping[str, str], resources: Mapping[str, Any], **frame: Any
) -> dict[str, Array]:
    """All declared resources that are written and can be read back, after the last frame."""
    outputs = {
        name: {"file": f"{name}.npy"}
        for name, r in resources.items()
        if r.get("samples", 1) == 1 and "previous" not in r
    }
    graph = {"frame": {**FRAME, **frame}, "resources": resources, "passes": passes, "outputs": outputs}
    return dict(run_graph(folder, graph, shaders).images)


def use(node: str, write: Mapping[str, str], read: Mapping[str, str] | None = None, **params: Any) -> dict[str, Any]:
    """A pass."""
    return {"node": node, "read": dict(read or {}), "write": dict(write), "set": params}


def words(buffer: Array) -> npt.NDArray[np.uint32]:
    """A buffer read back, as unsigned words."""
    return buffer.view(np.uint32).reshape(-1)


# ---------------------------------------------------------------- fullscreen


def test_fullscreen_writes_two_targets_with_uniforms_and_defines(tmp_path: Path) -> None:
    shader = (
        HEAD
        + """
in vec2 v_uv;
uniform float u_gain;
uniform ivec2 u_step;
uniform vec3 u_tint;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
    first = vec4(floor(gl_FragCoord.xy), u_gain, float(BIAS));
    vec2 away = abs(v_uv * textureSize_ - gl_FragCoord.xy);
    second = vec4(u_tint * vec3(u_step, 1), float(max(away.x, away.y) < 1e-4));
}
""".replace("textureSize_", f"vec2({WIDTH}, {HEIGHT})")
    )
    params = {"uniforms": {"u_gain": 3, "u_step": [2, 3], "u_tint": [0.5, 0.25, 8.0]}, "defines": {"BIAS": 7}}
    images = run(
        tmp_path,
        {"p": use("fullscreen", {"one": "a", "two": "b"}, shader="s.frag", **params)},
        {"s.frag": shader},
        {"a": {"format": "rgba32f"}, "b": {"format": "rgba32f"}},
    )
    assert np.array_equal(images["a"], np.stack([X, Y, np.full_like(X, 3), np.full_like(X, 7)], -1))
    assert np.array_equal(images["b"], np.broadcast_to([1.0, 0.75, 8.0, 1.0], (HEIGHT, WIDTH, 4)))


@pytest.mark.parametrize(
    ("blend", "expected"),
    [
        ("none", [0.5, 2.0, 4.0, 0.5]),
        ("add", [1.5, 3.0, 5.0, 1.5]),
        ("alpha", [0.75, 1.5, 2.5, 1.0]),
        ("premultiplied", [1.0, 2.5, 4.5, 1.0]),
        ("multiply", [0.5, 2.0, 4.0, 0.5]),
        ("min", [0.5, 1.0, 1.0, 0.5]),
        ("max", [1.0, 2.0, 4.0, 1.0]),
    ],
)
def test_blending_over_ones(tmp_path: Path, blend: str, expected: list[float]) -> None:
    shader = HEAD + "out vec4 color;\nvoid main() { color = vec4(0.5, 2.0, 4.0, 0.5); }\n"
    params = {"shader": "s.frag", "blend": blend, "clear": {"c": 1.0}}
    images = run(
        tmp_path, {"p": use("fullscreen", {"c": "a"}, **params)}, {"s.frag": shader}, {"a": {"format": "rgba32f"}}
    )
    assert np.array_equal(images["a"], np.broadcast_to(np.float32(expected), (HEIGHT, WIDTH, 4)))


def test_two_passes_blend_over_each_other_in_a_stated_order(tmp_path: Path) -> None:
    shader = HEAD + "uniform float u_v;\nout vec4 color;\nvoid main() { color = vec4(u_v, 0, 0, 0.5); }\n"
    over = {"shader": "s.frag", "blend": "alpha"}
    images = run(
        tmp_path,
        {
            "a_last": {**use("fullscreen", {"c": "a"}, uniforms={"u_v": 4.0}, **over), "after": ["b_first"]},
            "b_first": use("fullscreen", {"c": "a"}, uniforms={"u_v": 8.0}, **over),
            "c_zero": use("clear", {"target": "a"}, value=0),
        },
        {"s.frag": shader},
        {"a": {"format": "rgba32f"}},
    )
    assert np.array_equal(images["a"][..., 0], np.full((HEIGHT, WIDTH), 4.0 / 2 + 8.0 / 4))


def test_fullscreen_samples_with_filter_and_wrap(tmp_path: Path) -> None:
    read = (
        HEAD
        + """
uniform sampler2D u_smooth, u_near;
out vec4 color;
void main() {
    // a quarter texel right of the first column's left edge, one whole texture further right
    float u = 1.0 + 0.25 / 13.0, v = 0.5 / 7.0;
    color = vec4(texture(u_smooth, vec2(u, v)).r, texture(u_near, vec2(u, v)).r, 0.0, 1.0);
}
"""
    )
    images = run(
        tmp_path,
        {
            "make": use("fullscreen", {"c": "a"}, shader="p.frag"),
            "read": use(
                "fullscreen", {"c": "b"}, {"u_smooth": "a", "u_near": "a"},
                shader="s.frag", filter={"u_smooth": "linear"}, wrap={"u_smooth": "repeat"},
            ),
        },
        {"p.frag": PLACE, "s.frag": read},
        {"a": {"format": "rgba32f"}, "b": {"format": "rgba32f"}},
    )  # fmt: skip
    # repeated, filtered: three quarters of column 0 (0.5), a quarter of column 12 (12.5); clamped, nearest: 12.5
    assert np.allclose(images["b"][..., 0], 0.75 * 0.5 + 0.25 * 12.5, atol=0.05)
    assert np.array_equal(images["b"][..., 1], np.full((HEIGHT, WIDTH), 12.5))


def test_fullscreen_writes_depth_and_reads_it(tmp_path: Path) -> None:
    write = HEAD + "void main() { gl_FragDepth = floor(gl_FragCoord.x) / 16.0; }\n"
    read = (
        HEAD
        + """
uniform sampler2D u_depth;
out vec4 color;
void main() { color = vec4(texelFetch(u_depth, ivec2(gl_FragCoord.xy), 0).r); }
"""
    )
    images = run(
        tmp_path,
        {
            "w": use("fullscreen", {"z": "depth"}, shader="w.frag"),
            "r": use("fullscreen", {"c": "a"}, {"u_depth": "depth"}, shader="r.frag"),
        },
        {"w.frag": write, "r.frag": read},
        {"depth": {"format": "d32f"}, "a": {"format": "r32f"}},
    )
    assert np.array_equal(images["a"][..., 0], np.float32(X / 16.0))
    assert np.array_equal(images["depth"][..., 0], np.float32(X / 16.0))


def test_fullscreen_adds_to_a_buffer(tmp_path: Path) -> None:
    shader = (
        HEAD
        + """
layout(std430) buffer Count { uint count[4]; };
out vec4 color;
void main() { atomicAdd(count[uint(gl_FragCoord.x) & 3u], 1u); color = vec4(1); }
"""
    )
    images = run(
        tmp_path,
        {
            "z": use("clear", {"target": "n"}, value=100),
            "p": use("fullscreen", {"c": "a", "Count": "n"}, shader="s.frag"),
        },
        {"s.frag": shader},
        {"a": {"format": "r8"}, "n": {"bytes": 16}},
    )
    assert words(images["n"]).tolist() == [100 + HEIGHT * 4, 100 + HEIGHT * 3, 100 + HEIGHT * 3, 100 + HEIGHT * 3]


# ---------------------------------------------------------------- compute


LIMIT = "ivec2 t = ivec2(gl_GlobalInvocationID.xy); if (any(greaterThanEqual(t, imageSize({})))) return;"


@pytest.mark.parametrize("tile", [(8, 8), (16, 4), (5, 3)])
def test_compute_covers_every_texel_once(tmp_path: Path, tile: tuple[int, int]) -> None:
    shader = (
        HEAD
        + """
layout(local_size_x = TILE_X, local_size_y = TILE_Y) in;
layout(r32ui) uniform uimage2D u_count;
layout(r32ui) readonly uniform uimage2D u_before;
void main() {
    LIMIT
    imageAtomicAdd(u_count, t, imageLoad(u_before, t).r + uint(t.x + 100 * t.y));
}
""".replace("LIMIT", LIMIT.format("u_count"))
    )
    images = run(
        tmp_path,
        {
            "z": use("clear", {"target": "a"}, value=1000),
            "y": use("clear", {"target": "b"}, value=5),
            "p": use(
                "compute", {"u_count": "a"}, {"u_before": "b"},
                shader="s.comp", per_texel=list(tile), images=["u_before"], update=["u_count"],
            ),
        },
        {"s.comp": shader},
        {"a": {"format": "r32ui"}, "b": {"format": "r32ui"}},
    )  # fmt: skip
    assert np.array_equal(images["a"][..., 0], 1005 + X + 100 * Y)


def test_compute_writes_layers_and_buffers(tmp_path: Path) -> None:
    shader = (
        HEAD
        + """
layout(local_size_x = TILE_X, local_size_y = TILE_Y) in;
layout(r32f) writeonly uniform image2DArray u_layers;
layout(std430) buffer Rows { uint rows[]; };
void main() {
    ivec3 t = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(t, imageSize(u_layers)))) return;
    imageStore(u_layers, t, vec4(t.x + 10 * t.z));
    if (t.x == 0 && t.z == 0) rows[t.y] = uint(t.y * t.y);
}
"""
    )
    images = run(
        tmp_path,
        {"p": use("compute", {"u_layers": "a", "Rows": "rows"}, shader="s.comp")},
        {"s.comp": shader},
        {"a": {"format": "r32f", "layers": 3}, "rows": {"bytes": 4 * HEIGHT}},
    )
    assert np.array_equal(images["a"][..., 0], np.concatenate([X + 10 * layer for layer in range(3)], axis=1))
    assert words(images["rows"]).tolist() == [y * y for y in range(HEIGHT)]


def test_compute_runs_as_many_groups_as_a_buffer_says(tmp_path: Path) -> None:
    shader = (
        HEAD
        + """
layout(local_size_x = 1) in;
layout(std430) buffer Sum { uint sum; };
void main() { atomicAdd(sum, 1u + gl_WorkGroupID.z); }
"""
    )
    images = run(
        tmp_path,
        {
            "args": use("clear", {"target": "args"}, value=3),
            "zero": use("clear", {"target": "sum"}, value=0),
            "p": use("compute", {"Sum": "sum"}, {"groups": "args"}, shader="s.comp", indirect="groups", update=["Sum"]),
        },
        {"s.comp": shader},
        {"args": {"bytes": 12}, "sum": {"bytes": 4}},
    )
    assert words(images["sum"]).tolist() == [9 * (1 + 2 + 3)]


def test_history_counts_frames(tmp_path: Path) -> None:
    shader = (
        HEAD
        + """
#include <frame.glsl>
uniform usampler2D u_last;
out uvec4 color;
void main() {
    uint before = frame.counts.x == 0u ? 100u : texelFetch(u_last, ivec2(gl_FragCoord.xy), 0).r;
    color = uvec4(before + 1u);
}
"""
    )
    images = run(
        tmp_path,
        {"p": use("fullscreen", {"c": "a"}, {"u_last": "last"}, shader="s.frag")},
        {"s.frag": shader},
        {"a": {"format": "r32ui"}, "last": {"previous": "a"}},
        count=5,
    )
    assert np.array_equal(images["a"], np.full((HEIGHT, WIDTH, 1), 105))


# ---------------------------------------------------------------- draw


#: A quad over the left `u_split` of the target at distance `u_z` of 0 (near) to 1 (far), counter-clockwise.
QUAD = (
    HEAD
    + """
uniform float u_split, u_z;
void main() {
    vec2 corner = vec2[](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(1, 1))[gl_VertexID];
    float depth = DEPTH_REVERSED == 1 ? 1.0 - u_z : u_z;
    gl_Position = vec4(corner * vec2(u_split, 1.0) * 2.0 - 1.0, depth, 1.0);
}
"""
)
FLAT = HEAD + "uniform float u_v;\nout vec4 color;\nvoid main() { color = vec4(u_v); }\n"
QUADS = {"q.vert": QUAD, "f.frag": FLAT}


def quad(
    split: float, z: float, value: float, write: Mapping[str, str], after: str | None = None, **params: Any
) -> Any:
    """A pass that draws the quad."""
    uniforms = {"u_split": split, "u_z": z, "u_v": value}
    strip = {"vertices": 4, "topology": "triangle_strip"}
    made = use("draw", write, vertex="q.vert", fragment="f.frag", uniforms=uniforms, **strip, **params)
    return made | ({"after": [after]} if after else {})


@pytest.mark.parametrize("depth", ["reversed", "standard"])
@pytest.mark.parametrize(
    ("test", "z", "wins"),
    [
        ("closer", 0.25, True),
        ("closer", 0.75, False),
        ("closer", 0.5, False),
        ("closer_equal", 0.5, True),
        ("equal", 0.5, True),
        ("farther", 0.75, True),
        ("always", 0.75, True),
        ("none", 0.75, True),
    ],
)
def test_depth_tests_mean_distance(tmp_path: Path, depth: str, test: str, z: float, wins: bool) -> None:
    target = {"c": "a", "z": "depth"}
    images = run(
        tmp_path,
        {
            "back": quad(1.0, 0.5, 1.0, target),
            "front": quad(7 / 13, z, 2.0, target, "back", depth_test=test, keep=["c", "z"]),
        },
        QUADS,
        {"a": {"format": "r32f"}, "depth": {"format": "d32f"}},
        depth=depth,
    )
    assert np.array_equal(images["a"][..., 0], np.where((X < 7) & wins, 2.0, 1.0))


def test_draw_starts_from_zero_and_from_a_value(tmp_path: Path) -> None:
    images = run(
        tmp_path,
        {
            "p": quad(7 / 13, 0.5, 2.0, {"c": "a"}),
            "q": quad(7 / 13, 0.5, 2.0, {"c": "b"}, clear={"c": 9.0}),
            "r": quad(7 / 13, 0.5, 2.0, {"c": "c"}, cull="back"),
            "s": quad(7 / 13, 0.5, 2.0, {"c": "d"}, cull="front"),
        },
        QUADS,
        {name: {"format": "r32f"} for name in "abcd"},
    )
    assert np.array_equal(images["a"][..., 0], np.where(X < 7, 2.0, 0.0))
    assert np.array_equal(images["b"][..., 0], np.where(X < 7, 2.0, 9.0))
    assert np.array_equal(images["c"], images["a"])
    assert not images["d"].any()


def test_draw_against_depth_it_does_not_write(tmp_path: Path) -> None:
    front = quad(1.0, 0.5, 2.0, {"c": "a"}, depth_read="z")
    images = run(
        tmp_path,
        {
            "mask": {**quad(7 / 13, 0.25, 0.0, {"z": "depth"})},
            "front": {**front, "read": {"z": "depth"}},
        },
        QUADS,
        {"a": {"format": "r32f"}, "depth": {"format": "d32f"}},
    )
    assert np.array_equal(images["a"][..., 0], np.where(X < 7, 0.0, 2.0))
    assert np.array_equal(images["depth"][..., 0], np.where(X < 7, 0.75, 0.0).astype(np.float32))


def test_draw_takes_its_arguments_from_a_buffer_and_makes_points(tmp_path: Path) -> None:
    arguments = (
        HEAD
        + """
layout(local_size_x = 1) in;
layout(std430) writeonly buffer Args { uint args[8]; };
void main() { args = uint[](3u, 2u, 0u, 0u, 1u, 1u, 5u, 0u); }
"""
    )
    points = (
        HEAD
        + f"""
void main() {{
    vec2 texel = vec2(gl_VertexID, 2 * gl_InstanceID) + 0.5;
    gl_Position = vec4(texel / vec2({WIDTH}, {HEIGHT}) * 2.0 - 1.0, 0.5, 1.0);
    gl_PointSize = 1.0;
}}
"""
    )
    images = run(
        tmp_path,
        {
            "write": use("compute", {"Args": "args"}, shader="a.comp", groups=[1, 1, 1]),
            "draw": use(
                "draw", {"c": "a"}, {"args": "args"},
                vertex="p.vert", fragment="f.frag", indirect="args", draws=2, topology="points", uniforms={"u_v": 1.0},
            ),
        },
        {"a.comp": arguments, "p.vert": points, "f.frag": FLAT},
        {"args": {"bytes": 32}, "a": {"format": "r32f"}},
    )  # fmt: skip
    # two instances of vertices 0 to 2, two rows apart; then vertex 5 alone
    assert np.array_equal(images["a"][..., 0], ((X < 3) & ((Y == 0) | (Y == 2))) | ((X == 5) & (Y == 0)))


def test_draw_with_tessellation_and_geometry_shaders(tmp_path: Path) -> None:
    shaders = {
        "v.vert": HEAD + """
void main() { gl_Position = vec4(vec2[](vec2(-1, -1), vec2(3, -1), vec2(-1, 3))[gl_VertexID], 0.5, 1.0); }
""",
        "c.tesc": HEAD + """
layout(vertices = 3) out;
void main() {
    gl_out[gl_InvocationID].gl_Position = gl_in[gl_InvocationID].gl_Position;
    gl_TessLevelInner[0] = 4.0;
    gl_TessLevelOuter[0] = gl_TessLevelOuter[1] = gl_TessLevelOuter[2] = 4.0;
}
""",
        "e.tese": HEAD + """
layout(triangles, equal_spacing, ccw) in;
void main() {
    gl_Position = gl_TessCoord.x * gl_in[0].gl_Position + gl_TessCoord.y * gl_in[1].gl_Position
                + gl_TessCoord.z * gl_in[2].gl_Position;
}
""",
        "g.geom": HEAD + """
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
flat out int g_primitive;
void main() {
    for (int i = 0; i < 3; ++i) { gl_Position = gl_in[i].gl_Position; g_primitive = gl_PrimitiveIDIn; EmitVertex(); }
    EndPrimitive();
}
""",
        "f.frag": HEAD + "flat in int g_primitive;\nout vec4 color;\nvoid main() { color = vec4(1.0); }\n",
    }  # fmt: skip
    files = {"vertex": "v.vert", "tess_control": "c.tesc", "tess_evaluation": "e.tese", "geometry": "g.geom"}
    images = run(
        tmp_path,
        {"p": use("draw", {"c": "a"}, **files, fragment="f.frag", vertices=3, blend="add", clear={"c": 0.0})},
        shaders,
        {"a": {"format": "r32f"}},
    )
    # the patch's parts cover every texel exactly once
    assert np.array_equal(images["a"][..., 0], np.ones((HEIGHT, WIDTH)))


def test_draw_of_the_scene_as_it_is_and_as_patches(tmp_path: Path) -> None:
    """The library's vertex shader does what a user's would, and tessellation of level one changes nothing."""
    vertex = (
        HEAD
        + """
#extension GL_ARB_shader_draw_parameters : require
#include <frame.glsl>
#include <scene.glsl>
in vec3 in_position;
void main() {
    Instance instance = instances[gl_BaseInstanceARB + gl_InstanceID];
    gl_Position = frame.view_projection * instance.world * vec4(in_position, 1.0);
}
"""
    )
    control = (
        HEAD
        + """
layout(vertices = 3) out;
void main() {
    gl_out[gl_InvocationID].gl_Position = gl_in[gl_InvocationID].gl_Position;
    gl_TessLevelInner[0] = gl_TessLevelOuter[0] = gl_TessLevelOuter[1] = gl_TessLevelOuter[2] = 1.0;
}
"""
    )
    evaluation = (
        HEAD
        + """
layout(triangles) in;
void main() {
    gl_Position = gl_TessCoord.x * gl_in[0].gl_Position + gl_TessCoord.y * gl_in[1].gl_Position
                + gl_TessCoord.z * gl_in[2].gl_Position;
}
"""
    )
    fragment = HEAD + "out vec4 color;\nvoid main() { color = vec4(gl_FragCoord.z); }\n"
    common = {"fragment": "f.frag", "queues": ["opaque"]}
    patches = {"vertex": "v.vert", "tess_control": "c.tesc", "tess_evaluation": "e.tese"}
    graph = {
        "frame": FRAME,
        "scene": {"source": "cornell", "detail": 0.0},
        "resources": {
            **{name: {"format": "d32f"} for name in ("x", "y", "z", "only")},
            **{name: {"format": "r32f"} for name in ("a", "b", "c")},
        },
        "passes": {
            "plain": use("draw", {"c": "a", "z": "z"}, **common),
            "own": use("draw", {"c": "b", "z": "y"}, **common, vertex="v.vert"),
            "patches": use("draw", {"c": "c", "z": "x"}, **common, **patches),
            "depth": use("draw", {"z": "only"}, queues=["opaque"]),
        },
        "outputs": {name: {"file": f"{name}.npy"} for name in ("a", "b", "c", "only")},
    }
    shaders = {"v.vert": vertex, "f.frag": fragment, "c.tesc": control, "e.tese": evaluation}
    images = run_graph(tmp_path, graph, shaders).images
    assert (images["a"] > 0).mean() > 0.5
    assert np.array_equal(images["only"], images["a"])
    assert np.allclose(images["b"], images["a"], rtol=1e-5, atol=0)
    assert np.allclose(images["c"], images["a"], rtol=1e-5, atol=0)


# ---------------------------------------------------------------- copy, clear


def test_copy_keeps_bits_and_blit_scales(tmp_path: Path) -> None:
    images = run(
        tmp_path,
        {
            "p": use("fullscreen", {"c": "a"}, shader="p.frag"),
            "bits": use("copy", {"destination": "bits"}, {"source": "a"}),
            "large": use("copy", {"destination": "large"}, {"source": "a"}, blit=True),
        },
        {"p.frag": PLACE},
        {"a": {"format": "rgba32f"}, "bits": {"format": "rgba32ui"}, "large": {"format": "rgba16f", "scale": 2}},
    )
    assert np.array_equal(images["bits"].view(np.float32), images["a"])
    assert np.array_equal(images["large"], images["a"].repeat(2, 0).repeat(2, 1).astype(np.float16))


def test_copy_of_a_buffer(tmp_path: Path) -> None:
    images = run(
        tmp_path,
        {"z": use("clear", {"target": "a"}, value=0xDEADBEEF), "c": use("copy", {"destination": "b"}, {"source": "a"})},
        {},
        {"a": {"bytes": 64}, "b": {"bytes": 64}},
    )
    assert words(images["b"]).tolist() == [0xDEADBEEF] * 16


def test_copy_resolves_samples(tmp_path: Path) -> None:
    split = HEAD + "uniform float u_v;\nout vec4 color;\nvoid main() { color = vec4(gl_SampleID < 2 ? u_v : 3.0); }\n"
    images = run(
        tmp_path,
        {
            "p": quad(1.0, 0.5, 1.0, {"c": "many"}),
            "r": use("copy", {"destination": "a"}, {"source": "many"}, blit=True),
        },
        {"q.vert": QUAD, "f.frag": split},
        {"many": {"format": "r32f", "samples": 4}, "a": {"format": "r32f"}},
    )
    assert np.array_equal(images["a"][..., 0], np.full((HEIGHT, WIDTH), 2.0))


def test_copy_fills_the_mip_chain_with_means(tmp_path: Path) -> None:
    read = (
        HEAD
        + """
uniform sampler2D u_chain;
out vec4 color;
void main() { color = vec4(textureLod(u_chain, vec2(0.5), 3.0).r, float(textureQueryLevels(u_chain)), 0, 0); }
"""
    )
    images = run(
        tmp_path,
        {
            "p": use("fullscreen", {"c": "a"}, shader="p.frag"),
            "m": use("copy", {"destination": "chain"}, {"source": "a"}, mips=True),
            "r": use("fullscreen", {"c": "b"}, {"u_chain": "chain"}, shader="r.frag", filter="mipmap"),
        },
        {"p.frag": PLACE, "r.frag": read},
        {"a": {"format": "rgba32f"}, "chain": {"like": "a", "mips": 0}, "b": {"format": "rgba32f"}},
        size=[8, 8],
    )
    assert np.array_equal(images["b"][..., 0], np.full((8, 8), 4.0))  # the mean of 0.5 to 7.5
    assert np.array_equal(images["b"][..., 1], np.full((8, 8), 4.0))


@pytest.mark.parametrize(
    ("format", "value", "expected"),
    [
        ("rgba32f", [1.5, -2.0, 0.25, 7.0], [1.5, -2.0, 0.25, 7.0]),
        ("rgba8", 1.0, [255] * 4),
        ("r32ui", 70000, [70000]),
        ("r32i", -5, [-5]),
        ("d32f", 0.25, [0.75]),
    ],
)
def test_clear_sets_every_texel_of_every_layer(tmp_path: Path, format: str, value: Any, expected: list[float]) -> None:
    images = run(
        tmp_path, {"p": use("clear", {"target": "a"}, value=value)}, {}, {"a": {"format": format, "layers": 2}}
    )
    assert np.array_equal(images["a"], np.broadcast_to(expected, (HEIGHT, 2 * WIDTH, len(expected))))
