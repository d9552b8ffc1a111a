"""Shadow maps against rays: what they store, what they make of visible surfaces, and mistakes in both caught."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from observed import SMALL, above, broken_invariants, judge, mistake, observe_graph, with_output

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.shadow_map.lookup import Cascades, look_up

SHADOW = ("resources.shadow.fixed=[512, 512]",)


def wrong_share(run: PassRun) -> float:
    """The mean error of visibility."""
    truth = judge("shadow_map", run)["visibility"]
    assert truth.judged is not None
    return float(np.abs(truth.judged - truth.value)[truth.mask].mean())


@pytest.fixture(scope="module")
def spheres(session_device: Device) -> PassRun:
    pytest.importorskip("embreex")
    return observe_graph(session_device, "shadow_map", *SMALL, *SHADOW)["shadows"]


@pytest.mark.gpu
def test_spheres_are_within_tolerance(spheres: PassRun) -> None:
    assert above("shadow_map", spheres) == []
    assert broken_invariants("shadow_map", spheres) == []


@pytest.mark.gpu
@pytest.mark.parametrize("settings", [
    ("frame.depth=standard",), ("resources.shadow.format=d16",),
    ("resources.shadow.format=d24", "frame.depth=standard"), ("resources.shadow.layers=1",),
    ("passes.shadows.set.cascades=2",), ("passes.shadows.set.slope_bias=6",), ("passes.shadows.set.slope_bias=0",),
    ("scene.lights.sun.direction=[0.7, -0.6, -0.3]",),
], ids=lambda settings: settings[0].rpartition(".")[2])  # fmt: skip
def test_variants_are_within_tolerance(device: Device, settings: tuple[str, ...]) -> None:
    assert above("shadow_map", observe_graph(device, "shadow_map", *SMALL, *SHADOW, *settings)["shadows"]) == []


@pytest.mark.gpu
def test_the_atrium_with_its_cut_out_leaves_is_within_tolerance(device: Device) -> None:
    run = observe_graph(device, "deferred_shading", *SMALL)["shadows"]
    assert above("shadow_map", run) == []


@pytest.mark.gpu
def test_wrongly_lit_share_falls_with_the_resolution(device: Device) -> None:
    shares = [
        wrong_share(observe_graph(device, "shadow_map", *SMALL, f"resources.shadow.fixed=[{size}, {size}]")["shadows"])
        for size in (32, 128, 1024)
    ]
    assert shares[0] > 1.2 * shares[1]
    assert shares[1] > 2.0 * shares[2]


@pytest.mark.gpu
def test_without_bias_visibility_is_above_its_tolerance(device: Device) -> None:
    unbiased = ("passes.shadows.set.slope_bias=0", "passes.shadows.set.normal_bias=0")
    found = above("shadow_map", observe_graph(device, "shadow_map", *SMALL, *SHADOW, *unbiased)["shadows"])
    assert found == ["visibility"]  # the map holds what it should: it is the lookup that needs a bias


@pytest.mark.gpu
def test_mistakes_in_the_map_are_caught(spheres: PassRun) -> None:
    layers = spheres.outputs["map"]
    assert "map" in above("shadow_map", with_output(spheres, "map", layers + 2e-5))
    assert "map" in above("shadow_map", with_output(spheres, "map", 0.5 * (layers + np.roll(layers, 1, axis=2))))
    assert {"map", "visibility"} <= set(above("shadow_map", with_output(spheres, "map", layers[::-1])))
    assert "visibility" in above("shadow_map", with_output(spheres, "map", np.roll(layers, 6, axis=1)))
    assert "visibility" in above("shadow_map", with_output(spheres, "map", np.zeros_like(layers)))
    other = replace(spheres, params=spheres.params.model_copy(update={"slope_bias": -1.5}))
    assert "map" in above("shadow_map", other)
    assert broken_invariants("shadow_map", with_output(spheres, "map", layers * 3.0))
    words = np.array(spheres.outputs["cascades"])
    words[64:68] = words[64:68][::-1]
    assert broken_invariants("shadow_map", with_output(spheres, "cascades", words))


@pytest.mark.gpu
@pytest.mark.parametrize(("file", "right", "wrong"), [
    ("scene.vert", "cascades.to_clip[gl_InstanceID] * world", "cascades.to_clip[gl_InstanceID] * (world + vec4(0.05))"),
    ("cascades.comp", "used ? texel : 0.0", "used ? 0.0 * texel : 0.0"),
])  # fmt: skip
def test_mistakes_in_the_shaders_are_caught(
    device: Device, monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str
) -> None:
    mistake(monkeypatch, file, right, wrong)
    run = observe_graph(device, "shadow_map", *SMALL, *SHADOW)["shadows"]
    assert above("shadow_map", run)


# ---------------------------------------------------------------- the lookup, by hand


def one_cascade(texels: int = 8, normal_bias: float = 0.0) -> Cascades:
    """Light from above on the square [-1, 1]^2: x to the right, z down the map, 1 nearest at y = 1, 0 at y = -1."""
    to_clip = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, 0.5, 0, 0.5], [0, 0, 0, 1]])
    return Cascades(np.stack([to_clip] * 4), np.array([10.0, 0, 0, 0]), np.full(4, 2.0 / texels), 1, normal_bias)


UP = np.array([0.0, 1.0, 0.0])


def lit(x: float, height: float, layer: np.ndarray, taps: int = 1, depth: float = 1.0) -> float:
    point = np.array([[x, height, 0.125]])
    found = look_up(layer[None], one_cascade(), point, UP[None], np.array([depth]), UP, taps, True)
    return float(found.lit[0])


def half_map(depth: float) -> np.ndarray:
    """A caster at a depth over the left half of the map, nothing over the right."""
    layer = np.zeros((8, 8))
    layer[:, :4] = depth
    return layer


def test_bilinear_comparisons_by_hand() -> None:
    layer = half_map(0.75)  # a caster at y = 0.5
    assert lit(-0.5, 0.0, layer) == 0.0
    assert lit(-0.5, 0.6, layer) == 1.0  # above the caster
    assert lit(0.5, 0.0, layer) == 1.0
    assert lit(0.0, 0.0, layer) == pytest.approx(0.5)  # between the texels' centres
    assert lit(0.25 * 0.25, 0.0, layer) == pytest.approx(0.75)  # a quarter of a texel to the right
    assert lit(0.0, 0.0, layer, taps=3) == pytest.approx(0.5)
    assert lit(0.25, 0.0, layer, taps=3) == pytest.approx((0.0 + 1.0 + 1.0) / 3 + 0.5 / 3)
    assert lit(0.25, 0.0, layer, taps=2) == pytest.approx(1.0)
    assert lit(0.125, 0.0, layer, taps=2) == pytest.approx((0.5 + 1.0) / 2 + 0.0)


def test_standard_depth_compares_the_other_way() -> None:
    layer = 1.0 - half_map(0.75)
    cascades = one_cascade()
    flipped = cascades.to_clip.copy()
    flipped[:, 2] = [0, -0.5, 0, 0.5]
    found = look_up(layer[None], replace(cascades, to_clip=flipped), np.array([[-0.5, 0.0, 0.1], [-0.5, 0.6, 0.1]]),
                    np.stack([UP, UP]), np.ones(2), UP, 1, False)  # fmt: skip
    assert found.lit.tolist() == [0.0, 1.0]


def test_shadows_fade_out_and_end() -> None:
    layer = half_map(0.75)
    assert lit(-0.5, 0.0, layer, depth=8.9) == 0.0
    assert lit(-0.5, 0.0, layer, depth=9.5) == pytest.approx(0.5)
    assert lit(-0.5, 0.0, layer, depth=10.0) == 1.0


def test_what_float32_may_decide_otherwise_is_not_sure() -> None:
    layer, place = half_map(0.75), np.array([[-0.5, 0.5, 0.1], [-0.5, 0.5 + 1e-7, 0.1], [-0.5, 0.49, 0.1]])
    found = look_up(layer[None], one_cascade(), place, np.tile(UP, (3, 1)), np.ones(3), UP, 1, True)
    assert found.sure.tolist() == [False, False, True]
