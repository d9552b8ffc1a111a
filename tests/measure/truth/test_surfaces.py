"""What cameras see of squares whose place is known: depths, positions, textures, and what is admitted as unknown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rendergraph.measure.truth.decode import srgb_decode
from rendergraph.measure.truth.materials import Textures
from rendergraph.measure.truth.surfaces import trace_surfaces
from rendergraph.plan.graph import Frame
from rendergraph.scene.scene import Alpha, Camera, Image, Material, Scene, TextureUse, Wrap
from tests.measure.truth.traced_scenes import MATT, quads, square

pytest.importorskip("embreex")

#: Sees the square [-1, 1]^2 of the plane z = -1 fill the frame exactly.
FACING = Camera((0, 0, 0), (0, 0, -1), fov=np.pi / 2, near=0.05)
FRAME = Frame(16, 16)


def test_depth_and_position_of_a_facing_square() -> None:
    seen = trace_surfaces(quads([square(-2.0, 10.0)]), FACING, FRAME)
    assert seen.hit.all()
    assert seen.known.all()
    assert seen.view_depth == pytest.approx(np.full((16, 16), 2.0), rel=1e-14)
    assert seen.depth == pytest.approx(np.full((16, 16), 0.05 / 2.0), rel=1e-13)
    # The first pixel is the lower left one; its centre is half a pixel, an eighth of a metre at z = -2, inside.
    assert seen.position[0, 0] == pytest.approx((-1.875, -1.875, -2.0), abs=1e-13)
    assert seen.position[15, 3] == pytest.approx((-2.0 + 3.5 / 4.0, 1.875, -2.0), abs=1e-13)
    assert seen.geometric_normal[5, 5] == pytest.approx((0, 0, 1))
    assert seen.shading.normal[0] == pytest.approx((0, 0, 1))


@pytest.mark.parametrize(("depth", "far", "expected"), [
    ("reversed", 10.0, 0.05 * (10.0 - 2.0) / (2.0 * (10.0 - 0.05))),
    ("standard", 10.0, 10.0 * (2.0 - 0.05) / (2.0 * (10.0 - 0.05))),
    ("standard", None, 1.0 - 0.05 / 2.0),
])  # fmt: skip
def test_depth_conventions(depth: str, far: float | None, expected: float) -> None:
    seen = trace_surfaces(quads([square(-2.0, 0.5)]), replace(FACING, far=far), Frame(16, 16, depth=depth))
    assert seen.depth[8, 8] == pytest.approx(expected, rel=1e-13)
    assert seen.depth[0, 0] == (0.0 if depth == "reversed" else 1.0)
    assert not seen.hit[0, 0]


def test_near_and_far_planes_cut() -> None:
    scene = quads([square(-0.04, 10.0), square(-2.0, 10.0), square(-30.0, 10.0)])
    assert trace_surfaces(scene, FACING, FRAME).view_depth[8, 8] == pytest.approx(2.0)
    assert trace_surfaces(scene, replace(FACING, near=2.5), FRAME).view_depth[8, 8] == pytest.approx(30.0)
    assert not trace_surfaces(scene, replace(FACING, near=2.5, far=29.0), FRAME).hit.any()


def test_a_silhouette_through_a_pixels_centre_is_unknown() -> None:
    """The square's right edge runs through the centres of column 11, and between those of columns 11 and 12."""

    def known(right: float) -> np.ndarray:
        return trace_surfaces(quads([[[-5, -5, -2], [5 + right, 0, 0], [0, 10, 0]]]), FACING, FRAME).known[8]

    assert np.nonzero(~known(-2.0 + 4.0 * 11.5 / 16.0))[0].tolist() == [11]
    assert known(-2.0 + 4.0 * 12.0 / 16.0).all()


def test_a_crease_and_a_step_are_unknown_and_a_fold_of_one_plane_is_not() -> None:
    middle = -2.0 + 4.0 * 8.5 / 16.0  # column 8's centre
    left = [[-5, -5, -2], [5 + middle, 0, 0], [0, 10, 0]]

    def unknown(right: list[list[float]], joined: bool) -> list[int]:
        scene = quads([left, right])
        if joined:  # both quads in one mesh
            scene.indices = np.array([0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7], dtype=np.uint32)
            scene.meshes = [replace(scene.meshes[0], index_count=12)]
            scene.instances = scene.instances[:1]
        return np.nonzero(~trace_surfaces(scene, FACING, FRAME).known[8])[0].tolist()

    flat = [[middle, -5, -2], [5, 0, 0], [0, 10, 0]]
    assert unknown(flat, joined=True) == []
    assert unknown([[middle, -5, -2], [5, 0, -5], [0, 10, 0]], joined=True) == [8]
    assert unknown([[middle, -5, -2.2], [5, 0, 0], [0, 10, 0]], joined=True) == [8]
    assert unknown(flat, joined=False) == [8]


def test_what_glass_covers() -> None:
    glass = replace(MATT, alpha=Alpha.BLENDED)
    seen = trace_surfaces(quads([square(-2.0, 10.0), square(-1.0, 0.5)], [MATT, glass], of=[0, 1]), FACING, FRAME)
    assert seen.view_depth[8, 8] == pytest.approx(2.0)
    assert seen.behind_blended[8, 8]
    assert not seen.behind_blended[0, 0]
    behind = trace_surfaces(quads([square(-2.0, 10.0), square(-3.0, 5)], [MATT, glass], of=[0, 1]), FACING, FRAME)
    assert not behind.behind_blended.any()


# ---------------------------------------------------------------- materials

TEXELS = np.array([[[0, 0, 0, 255], [255, 0, 0, 255]], [[0, 255, 0, 255], [64, 0, 128, 255]]], dtype=np.uint8)


def sampled(uv: tuple[float, float], use: TextureUse, srgb: bool = False) -> np.ndarray:
    scene = quads([square(-1.0)], [replace(MATT, base_color_texture=use)], images=[Image(TEXELS, srgb=srgb)])
    return Textures(scene).sample(use, np.array([uv]))[0]


def test_bilinear_by_hand() -> None:
    assert sampled((0.25, 0.25), TextureUse(0))[:3] == pytest.approx((0, 0, 0))
    assert sampled((0.5, 0.25), TextureUse(0))[:3] == pytest.approx((0.5, 0, 0))
    assert sampled((0.5, 0.5), TextureUse(0))[:3] == pytest.approx(((1 + 64 / 255) / 4, 0.25, 128 / 255 / 4))
    linear = float(srgb_decode(np.array([64 / 255]))[0])
    assert sampled((0.75, 0.5), TextureUse(0), srgb=True)[0] == pytest.approx((1 + linear) / 2)  # decoded, then mixed


@pytest.mark.parametrize(("wrap", "u", "red"), [
    (Wrap.REPEAT, 1.0, 0.5), (Wrap.CLAMP, 1.0, 1.0), (Wrap.MIRROR, 1.0, 1.0),
    (Wrap.REPEAT, 1.25, 0.0), (Wrap.CLAMP, 1.25, 1.0), (Wrap.MIRROR, 1.25, 1.0),
    (Wrap.REPEAT, -0.25, 1.0), (Wrap.CLAMP, -0.25, 0.0), (Wrap.MIRROR, -0.75, 1.0),
])  # fmt: skip
def test_wrap_modes_by_hand(wrap: Wrap, u: float, red: float) -> None:
    assert sampled((u, 0.25), TextureUse(0, wrap=(wrap, Wrap.REPEAT)))[0] == pytest.approx(red)


def test_texture_transforms_by_hand() -> None:
    """Scale, then turn, then move: a quarter turn takes (u, v) to (v, -u)."""
    turned = TextureUse(0, rotation=np.pi / 2, offset=(0.0, 0.5), scale=(0.5, 1.0))
    assert sampled((0.5, 0.75), turned)[:3] == pytest.approx(sampled((0.75, 0.25), TextureUse(0))[:3])
    assert sampled((0.5, 0.75), turned)[:3] == pytest.approx((1, 0, 0))


def textured(size: int, **material: object) -> Scene:
    image = Image(np.full((size, size, 4), (230, 128, 205, 255), dtype=np.uint8), srgb=False)
    return quads([square(-1.0)], [Material(**{"metallic": 0.0, **material})], images=[image])  # type: ignore[arg-type]


def test_minified_textures_are_told_apart() -> None:
    small = trace_surfaces(textured(8, base_color_texture=TextureUse(0)), FACING, FRAME)
    large = trace_surfaces(textured(64, base_color_texture=TextureUse(0)), FACING, FRAME)
    assert small.magnified[small.hit].all()
    assert not large.magnified.any()
    assert large.magnified_slots[8, 8].tolist() == [False, True, True, True, True]
    assert large.textured[8, 8].tolist() == [True, False, False, False, False]


def test_normal_maps_lean_along_the_tangent() -> None:
    texel = np.array([230, 128, 205]) / 255.0 * 2.0 - 1.0
    seen = trace_surfaces(textured(4, normal_texture=TextureUse(0)), FACING, FRAME)
    assert seen.shading.normal[0] == pytest.approx(texel / np.linalg.norm(texel))
    weak = trace_surfaces(textured(4, normal_texture=TextureUse(0), normal_scale=0.0), FACING, FRAME)
    assert weak.shading.normal[0] == pytest.approx((0, 0, 1))


def test_factors_and_textures_multiply() -> None:
    scene = textured(4, metallic_roughness_texture=TextureUse(0), occlusion_texture=TextureUse(0),
                     emissive_texture=TextureUse(0), roughness=0.5, metallic=0.25, occlusion_strength=0.5,
                     emissive=(1.0, 2.0, 4.0))  # fmt: skip
    shading = trace_surfaces(scene, FACING, FRAME).shading
    assert shading.roughness[0] == pytest.approx(0.5 * 128 / 255)
    assert shading.metallic[0] == pytest.approx(0.25 * 205 / 255)
    assert shading.occlusion[0] == pytest.approx(1.0 + 0.5 * (230 / 255 - 1.0))
    assert shading.emissive[0] == pytest.approx((230 / 255, 2 * 128 / 255, 4 * 205 / 255))


def test_backs_of_double_sided_surfaces_face_the_viewer() -> None:
    away = [[-1, -1, -1], [0, 2, 0], [2, 0, 0]]
    seen = trace_surfaces(quads([away], [replace(MATT, double_sided=True)]), FACING, FRAME)
    assert seen.shading.normal[0] == pytest.approx((0, 0, 1))
    assert not trace_surfaces(quads([away]), FACING, FRAME).hit.any()
