"""Packed bytes: the layouts against the shaders' own declarations, and the values inside."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.node.builder import SHADERS
from rendergraph.scene.draw_queues import DRAW_COMMAND, QUEUES, draw_runs
from rendergraph.scene.gpu_layout import (
    INSTANCE,
    LIGHT,
    MATERIAL,
    NO_TEXTURE,
    TEXTURE_REF,
    mirrored,
    normal_matrix,
    pack_instances,
    pack_lights,
    pack_materials,
    place_textures,
)
from rendergraph.scene.scene import Alpha, Image, Instance, Light, Material, Mesh, Scene, TextureUse, Wrap
from rendergraph.scene.texture_arrays import NO_ARRAY

# ---------------------------------------------------------------- layouts

SCALARS = {"float": (4, 4), "uint": (4, 4), "vec4": (16, 16), "mat4": (64, 16)}


def std430(source, name):
    """Offsets of a GLSL struct's members, and its size (GL 4.5, 7.6.2.2, rules 1 to 9)."""

    def measure(struct):
        body = re.search(rf"struct {struct} \{{(.*?)\}};", source, re.DOTALL)[1]
        offsets, end, align = {}, 0, 1
        for kind, member, count in re.findall(r"(\w+) (\w+)(?:\[(\d+)\])?;", re.sub(r"//.*", "", body)):
            size, alignment = SCALARS[kind] if kind in SCALARS else measure(kind)[1:]
            start = -(-end // alignment) * alignment
            offsets[member] = start
            end, align = start + size * int(count or 1), max(align, alignment)
        return offsets, -(-end // align) * align, align

    return measure(name)[:2]


@pytest.mark.parametrize(
    ("dtype", "file", "struct", "renamed"),
    [
        (INSTANCE, "scene.glsl", "Instance", {"normal": "normal_0"}),
        (TEXTURE_REF, "scene.glsl", "TextureRef", {}),
        (MATERIAL, "scene.glsl", "Material", {"rotation": "rotation_0", "reserved": "reserved_0"}),
        (LIGHT, "lights.glsl", "Light", {}),
    ],
)
def test_dtypes_mirror_the_shaders(dtype, file, struct, renamed):
    offsets, size = std430((SHADERS / file).read_text(), struct)
    assert dtype.itemsize == size
    assert {renamed.get(n, n): dtype.fields[n][1] for n in dtype.names}.items() <= offsets.items()


def test_the_layout_check_can_fail():
    offsets, size = std430("struct T { float a; vec4 b; };", "T")
    assert (offsets, size) == ({"a": 0, "b": 16}, 32)


def test_draw_command_is_tight():
    assert DRAW_COMMAND.itemsize == 20


# ---------------------------------------------------------------- a scene to pack


def scene_of(*instances, materials=None, images=(), lights=()):
    """Instances are (world, material) or worlds; every material has a unit box as its mesh."""
    materials = materials or [Material()]
    arrays = {name: np.zeros((3, width), np.float32) for name, width in
              (("positions", 3), ("normals", 3), ("tangents", 4), ("uv0", 2), ("uv1", 2), ("colors", 4))}  # fmt: skip
    meshes = [Mesh(3 * i, 3, 10 * i, i, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)) for i in range(len(materials))]
    placed = [Instance(i[1], i[0]) if isinstance(i, tuple) else Instance(0, i) for i in instances]
    return Scene("test", **arrays, indices=np.zeros(3, np.uint32), meshes=meshes, instances=placed, materials=materials,
                 images=list(images), lights=list(lights))  # fmt: skip


def at(x, y=0.0, z=0.0, scale=(1.0, 1.0, 1.0)):
    world = np.diag([*scale, 1.0])
    world[:3, 3] = (x, y, z)
    return world


def test_nothing_packs_to_one_dummy():
    empty = scene_of()
    empty.materials = []
    assert len(pack_instances(empty)) == 128
    assert len(pack_materials(empty, place_textures(empty))) == 256
    (light,) = np.frombuffer(pack_lights(empty), LIGHT)
    assert not light["intensity"][:3].any()
    assert light["position_radius"][3] == 0


# ---------------------------------------------------------------- instances


def test_instances():
    world = at(5, 6, 7)
    world[0, 1] = 9
    packed = np.frombuffer(
        pack_instances(scene_of(world, (at(0, scale=(-2, 1, 1)), 1), materials=[Material()] * 2)), INSTANCE
    )
    words = np.frombuffer(packed[0].tobytes(), np.float32)
    assert words[12:15].tolist() == [5, 6, 7]  # column-major: the last column comes last
    assert words[4] == 9
    assert packed["material"].tolist() == [0, 1]
    assert packed["flags"].tolist() == [0, 1]
    assert packed["object"].tolist() == [0, 1]
    np.testing.assert_allclose(packed[1]["normal"][:, :3], np.diag([-0.5, 1, 1]))


def test_normals_stay_perpendicular_under_shear():
    world = np.eye(4)
    world[0, 1] = 3.0
    tangent, normal = np.array([1.0, 1.0, 0.0]), np.array([1.0, -1.0, 0.0])
    assert abs((world[:3, :3] @ tangent) @ (normal_matrix(world) @ normal)) < 1e-12
    assert abs((world[:3, :3] @ tangent) @ (world[:3, :3] @ normal)) > 1  # the known-bad twin: the matrix itself


def test_flattened_instance_keeps_the_normal_of_its_plane():
    normal = normal_matrix(at(0, scale=(2, 0, 3))) @ [0.1, 1, 0.1]
    np.testing.assert_allclose(normal / np.linalg.norm(normal), [0, 1, 0])


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.sampled_from([0.0, 1.0, -1.0, 1e-18, 1e18, -1e-9, 2.5, 1e-300]), min_size=9, max_size=9))
def test_normal_matrix_is_finite_and_not_zero(values):
    world = np.eye(4)
    world[:3, :3] = np.reshape(values, (3, 3))
    matrix = normal_matrix(world).astype(np.float32)
    assert np.isfinite(matrix).all()
    assert matrix.any()
    with np.errstate(over="ignore"):
        assert np.isfinite(matrix @ np.float32([0.6, 0, 0.8])).all()


def test_mirrored():
    assert mirrored(at(0, scale=(-1, 1, 1)))
    assert not mirrored(at(0, scale=(-1, -1, 1)))
    assert not mirrored(at(0, scale=(0, -1, 1)))


# ---------------------------------------------------------------- materials and lights


def test_materials():
    pixels = np.zeros((4, 4, 4), np.uint8)
    use = TextureUse(1, 1, (Wrap.MIRROR, Wrap.CLAMP), (0.1, 0.2), (3.0, 4.0), 0.5)
    material = Material(
        base_color=(0.1, 0.2, 0.3, 0.4), metallic=0.5, roughness=0.6, emissive=(7.0, 8.0, 9.0), alpha=Alpha.MASKED,
        alpha_cutoff=0.25, double_sided=True, unlit=True, normal_scale=0.7, occlusion_strength=0.8,
        base_color_texture=TextureUse(0), emissive_texture=use,
    )  # fmt: skip
    images = [Image(pixels, True), Image(pixels, True), Image(pixels, False)]
    scene = scene_of(at(0), materials=[material], images=images)
    (packed,) = np.frombuffer(pack_materials(scene, place_textures(scene)), MATERIAL)
    np.testing.assert_allclose(packed["base_color"], [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(packed["emissive"], [7, 8, 9, 0.25])
    np.testing.assert_allclose(packed["factors"], [0.5, 0.6, 0.7, 0.8])
    assert packed["flags"] == 1 | 4 | 8
    assert packed["textures"]["array"].tolist() == [0, NO_TEXTURE, NO_TEXTURE, NO_TEXTURE, 0]
    assert packed["textures"]["layer"][[0, 4]].tolist() == [0, 1]
    emissive = packed["textures"][4]
    assert (emissive["uv_set"], emissive["wrap"]) == (1, 2 | 1 << 2)
    np.testing.assert_allclose(emissive["transform"], [0.1, 0.2, 3, 4])
    np.testing.assert_allclose(packed["rotation"], [0, 0, 0, 0, 0.5, 0, 0, 0])


def test_texture_of_a_material_that_nothing_draws_is_absent():
    use = TextureUse(0)
    scene = scene_of(materials=[Material(base_color_texture=use)], images=[Image(np.zeros((1, 1, 4), np.uint8), True)])
    placement = place_textures(scene)
    assert placement.arrays == []
    (packed,) = np.frombuffer(pack_materials(scene, placement), MATERIAL)
    assert packed["textures"]["array"][0] == NO_TEXTURE


def test_lights():
    point = Light((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 7.0)
    spot = Light((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 2.0, axis=(0.0, 0.0, -5.0), inner=0.9, outer=0.5)
    packed = np.frombuffer(pack_lights(scene_of(lights=[point, spot])), LIGHT)
    assert packed[0]["position_radius"].tolist() == [1, 2, 3, 7]
    np.testing.assert_allclose(packed[0]["intensity"], [4, 5, 6, 0.01])
    assert packed[0]["axis_outer"][3] == -2
    np.testing.assert_allclose(packed[1]["axis_outer"], [0, 0, -1, math.cos(0.5)], rtol=1e-6)
    assert packed[1]["inner"][0] == packed[1]["axis_outer"][3]  # inner is held to outer


# ---------------------------------------------------------------- draw commands

EYE = (0.0, 0.0, 0.0)


def runs_of(scene, eye):
    return draw_runs(scene, eye, place_textures(scene))


def order(runs):
    return [int(i) for run in runs for i in run.commands["base_instance"]]


def test_commands():
    scene = scene_of(at(0), (at(1), 1), materials=[Material(), Material()])
    runs = runs_of(scene, EYE)
    assert tuple(runs) == QUEUES
    (run,) = runs["opaque"]
    assert [tuple(c) for c in run.commands.tolist()] == [(3, 1, 0, 0, 0), (3, 1, 3, 10, 1)]


def test_queues_and_order():
    """Opaque and masked front to back, blended back to front, by distance to the centre of the bounds."""
    materials = [Material(alpha=alpha) for alpha in Alpha]
    places = [(at(x), kind) for kind in range(3) for x in (9.0, 1.0, 5.0)]
    runs = runs_of(scene_of(*places, materials=materials), EYE)
    assert order(runs["opaque"]) == [1, 2, 0]
    assert order(runs["masked"]) == [4, 5, 3]
    assert order(runs["blended"]) == [6, 8, 7]
    assert order(runs_of(scene_of(*places, materials=materials), (20.0, 0.0, 0.0))["opaque"]) == [0, 2, 1]


def test_ties_keep_the_scenes_order():
    runs = runs_of(scene_of(*[at(1)] * 20), EYE)
    assert order(runs["opaque"]) == list(range(20))


def test_runs_of_equal_state():
    """Opaque instances are grouped by sidedness and winding, the group of the nearest first; blended ones keep their
    order and are cut into runs.
    """
    materials = [Material(), Material(double_sided=True)]
    places = [(at(1), 0), (at(2), 1), (at(3), 0), (at(-4, scale=(-1, 1, 1)), 0)]
    runs = runs_of(scene_of(*places, materials=materials), EYE)["opaque"]
    assert [(r.double_sided, r.mirrored, order([r])) for r in runs] == [
        (False, False, [0, 2]), (True, False, [1]), (False, True, [3]),
    ]  # fmt: skip
    blended = [Material(alpha=Alpha.BLENDED, double_sided=side) for side in (False, True)]
    runs = runs_of(scene_of(*places, materials=blended), EYE)["blended"]
    assert order(runs) == [3, 2, 1, 0]
    assert [(r.double_sided, r.mirrored) for r in runs] == [
        (False, True),
        (False, False),
        (True, False),
        (False, False),
    ]


def test_runs_have_one_set_of_texture_arrays():
    """Images 0 and 2 share an array; a material that fills another slot, or none, is a set of its own."""
    images = [Image(np.zeros((side, side, 4), np.uint8), True) for side in (8, 16, 8)]
    colour = [Material(base_color_texture=TextureUse(image)) for image in range(3)]
    emission = Material(emissive_texture=TextureUse(0))
    materials = [*colour, emission, Material()]
    places = [(at(x), material) for x, material in ((5, 0), (1, 1), (2, 2), (3, 3), (4, 4))]
    runs = runs_of(scene_of(*places, materials=materials, images=images), EYE)["opaque"]
    no = NO_ARRAY
    assert [(r.arrays, order([r])) for r in runs] == [
        ((1, no, no, no, no), [1]),
        ((0, no, no, no, no), [2, 0]),
        ((no, no, no, no, 0), [3]),
        ((no, no, no, no, no), [4]),
    ]
    blended = [replace(material, alpha=Alpha.BLENDED) for material in materials]
    runs = runs_of(scene_of(*places, materials=blended, images=images), EYE)["blended"]
    assert order(runs) == [0, 4, 3, 2, 1]
    assert [r.arrays[0] for r in runs] == [0, no, no, 0, 1]


def test_empty_scene_and_empty_meshes_draw_nothing():
    assert runs_of(scene_of(), EYE) == {queue: [] for queue in QUEUES}
    scene = scene_of(at(0))
    scene.meshes[0] = Mesh(0, 0, 0, 0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert runs_of(scene, EYE)["opaque"] == []
