"""Node hierarchy, default scene, cameras, lights, skins and animations."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rendergraph.scene.scene import Light

HALF = math.sqrt(0.5)
QUARTER_TURN_Y = [0, HALF, 0, HALF]  # takes -z to -x


def chain(tiny, *nodes):
    """Nodes each the child of the one before, the last with the triangle; returns the scene."""
    tiny.triangle()
    tiny.json["nodes"] = [{**node, "children": [i + 1]} for i, node in enumerate(nodes[:-1])] + [
        {"mesh": 0, **nodes[-1]}
    ]
    tiny.json["scenes"] = [{"nodes": [0]}]
    return tiny.load()


def test_trs_composes_scale_then_rotation_then_translation(tiny):
    scene = chain(tiny, {"translation": [1, 2, 3], "rotation": QUARTER_TURN_Y, "scale": [2, 3, 4]})
    np.testing.assert_allclose(scene.instances[0].world @ [1, 1, 1, 1], [1 + 4, 2 + 3, 3 - 2, 1], atol=1e-12)


def test_parents_apply_last_and_matrices_are_column_major(tiny):
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1]
    scene = chain(tiny, {"scale": [2, 2, 2]}, {"matrix": matrix})
    np.testing.assert_allclose(scene.instances[0].world @ [0, 0, 0, 1], [20, 40, 60, 1])


def test_composition_is_float64(tiny):
    """A large offset and its inverse leave a small one intact, which float32 would lose."""
    scene = chain(tiny, {"translation": [1e8, 0, 0]}, {"translation": [0.125, 0, 0]}, {"translation": [-1e8, 0, 0]})
    assert scene.instances[0].world[0, 3] == 0.125
    assert np.float32(1e8) + np.float32(0.125) - np.float32(1e8) == 0  # the known-bad twin


def test_rotation_is_normalised(tiny):
    scene = chain(tiny, {"rotation": [0, 3, 0, 3]})
    np.testing.assert_allclose(
        scene.instances[0].world[:3, :3] @ scene.instances[0].world[:3, :3].T, np.eye(3), atol=1e-12
    )


def test_default_scene(tiny):
    tiny.triangle()
    tiny.json["nodes"] = [{"mesh": 0, "name": "hidden"}, {"mesh": 0, "name": "shown"}]
    tiny.json.update(scenes=[{"nodes": [0]}, {"nodes": [1]}], scene=1)
    scene = tiny.load()
    assert [i.name for i in scene.instances] == ["shown"]
    assert len(scene.notes) == 1
    assert [n.name for n in scene.nodes] == ["hidden", "shown"]


def test_without_scenes_all_roots_are_shown(tiny):
    tiny.triangle()
    tiny.json["nodes"] = [{"mesh": 0, "children": [1]}, {"mesh": 0}]
    del tiny.json["scenes"]
    assert len(tiny.load().instances) == 2


def test_nodes_keep_what_animation_replaces(tiny):
    node = chain(tiny, {}, {"translation": [1, 2, 3], "rotation": QUARTER_TURN_Y, "scale": [2, 2, 2]}).nodes[1]
    assert (node.parent, node.translation, node.scale) == (0, (1, 2, 3), (2, 2, 2))
    assert node.rotation == pytest.approx(QUARTER_TURN_Y)


# ---------------------------------------------------------------- cameras and lights


def test_perspective_camera(tiny):
    lens = {"yfov": 0.8, "znear": 0.1, "zfar": 50}
    tiny.append("cameras", {"type": "perspective", "name": "lens", "perspective": lens})
    scene = chain(
        tiny, {"translation": [1, 2, 3], "rotation": QUARTER_TURN_Y, "camera": 0, "name": "tripod", "scale": [3, 3, 3]}
    )
    camera = scene.cameras[0]
    assert (camera.fov, camera.near, camera.far, camera.name, camera.node) == (0.8, 0.1, 50, "lens", "tripod")
    assert camera.position == (1, 2, 3)
    assert camera.target == pytest.approx((0, 2, 3))
    assert camera.up == pytest.approx((0, 1, 0))


def test_infinite_and_orthographic_cameras(tiny):
    tiny.append("cameras", {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})
    tiny.append("cameras", {"type": "orthographic", "orthographic": {}})
    scene = chain(tiny, {"camera": 0}, {"camera": 1})
    assert [c.far for c in scene.cameras] == [None]
    assert len(scene.notes) == 1


def lights_of(tiny, *lights):
    tiny.json["extensions"] = {"KHR_lights_punctual": {"lights": list(lights)}}
    nodes = [{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(len(lights))]
    nodes[0].update(translation=[1, 2, 3], rotation=QUARTER_TURN_Y)
    return chain(tiny, *nodes)


def test_point_light(tiny):
    (light,) = lights_of(tiny, {"type": "point", "color": [1, 0.5, 0], "intensity": 40, "range": 7}).lights
    assert light == Light((1, 2, 3), (40, 20, 0), 7)


def test_light_without_range_ends_where_its_irradiance_is_low(tiny):
    (light,) = lights_of(tiny, {"type": "point", "intensity": 50}).lights
    assert 50 / light.radius**2 == pytest.approx(0.02)
    (dark,) = lights_of(tiny, {"type": "point", "intensity": 0}).lights
    assert dark.radius > 0


def test_spot_light(tiny):
    cone = {"innerConeAngle": 0.2, "outerConeAngle": 0.4}
    (light,) = lights_of(tiny, {"type": "spot", "spot": cone}).lights
    assert (light.inner, light.outer) == (0.2, 0.4)
    assert light.axis == pytest.approx((-1, 0, 0))


def test_directional_lights(tiny):
    scene = lights_of(tiny, {"type": "directional", "color": [1, 0.5, 0], "intensity": 3}, {"type": "directional"})
    assert scene.sun.direction == pytest.approx((-1, 0, 0))
    assert scene.sun.irradiance == (3, 1.5, 0)
    assert len(scene.notes) == 1  # there is one sun
    assert scene.lights == []


# ---------------------------------------------------------------- skins and animations


def skinned(tiny, offset):
    """A triangle bound to two joints one unit apart; at rest the second joint is ``offset`` from where it was bound."""
    weights = tiny.accessor([[1, 0, 0, 0]] * 3)
    tiny.triangle(JOINTS_0=tiny.accessor([[0, 1, 0, 0]] * 3, "u1"), WEIGHTS_0=weights)
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, :3, 3] = (0, -1, 0)
    matrices = tiny.accessor(bind.transpose(0, 2, 1).reshape(2, 16))
    tiny.json["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"translation": [5, 0, 0], "children": [2]},
        {"translation": [0, 1 + offset, 0]},
    ]
    tiny.json["scenes"] = [{"nodes": [0, 1]}]
    tiny.append("skins", {"joints": [1, 2], "inverseBindMatrices": matrices})
    return tiny.load()


def test_skinned_mesh_is_placed_by_its_joints(tiny):
    scene = skinned(tiny, 0)
    assert scene.skins[0].joints == (1, 2)
    assert scene.skins[0].inverse_bind[1, :3, 3].tolist() == [0, -1, 0]
    assert scene.instances[0].skin == 0
    assert scene.instances[0].world[:3, 3].tolist() == [5, 0, 0]  # not the node's own 100
    assert scene.features().skinned
    assert scene.notes == []


def test_posed_skin_is_noted(tiny):
    assert len(skinned(tiny, 0.5).notes) == 1


def test_skin_without_matrices(tiny):
    tiny.triangle()
    tiny.append("skins", {"joints": [0]})
    assert tiny.load().skins[0].inverse_bind.tolist() == np.eye(4)[None].tolist()


def animated(tiny, path, values, dtype="f4", interpolation="LINEAR", times=(0.0, 1.0)):
    sampler = {"input": tiny.accessor(list(times)), "interpolation": interpolation}
    sampler["output"] = tiny.accessor(values, dtype, normalized=dtype != "f4")
    channels = [{"sampler": 0, "target": {"path": path, "node": 0}}, {"sampler": 0, "target": {"path": path}}]
    tiny.triangle()
    tiny.append("animations", {"name": "walk", "channels": channels, "samplers": [sampler]})
    (animation,) = tiny.load().animations
    assert animation.name == "walk"
    (channel,) = animation.channels  # the one without a node is left out
    return channel


def test_animation_channels(tiny):
    channel = animated(tiny, "translation", [[0, 0, 0], [1, 2, 3]])
    assert (channel.node, channel.path, channel.interpolation) == (0, "translation", "LINEAR")
    assert channel.times.tolist() == [0, 1]
    assert channel.values.tolist() == [[0, 0, 0], [1, 2, 3]]


def test_quantised_rotations(tiny):
    channel = animated(tiny, "rotation", [[0, 0, 0, 32767], [32767, 0, 0, 0]], "i2", "STEP")
    assert channel.values.tolist() == [[0, 0, 0, 1], [1, 0, 0, 0]]


def test_cubic_spline_and_weights_have_wide_rows(tiny):
    assert animated(tiny, "scale", [[i, i, i] for i in range(6)], interpolation="CUBICSPLINE").values.shape == (2, 9)


def test_morph_weights(tiny):
    assert animated(tiny, "weights", list(range(6))).values.tolist() == [[0, 1, 2], [3, 4, 5]]
