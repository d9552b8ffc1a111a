"""Texture arrays: grouping, merging and resampling."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.scene.scene import Image, Instance, Material, Mesh, Scene, TextureUse
from rendergraph.scene.texture_arrays import MAX_ARRAYS, halved, place_textures, resample, size_class


def scene_with(*images):
    """A scene that draws every image: (width, height, srgb) each, one material an image."""
    pixels = [Image(np.full((h, w, 4), i, np.uint8), srgb, f"{i}") for i, (w, h, srgb) in enumerate(images)]
    materials = [Material(base_color_texture=TextureUse(i)) for i in range(len(images))]
    meshes = [Mesh(0, 3, 0, i, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)) for i in range(len(images))]
    arrays = {name: np.zeros((0, width), np.float32) for name, width in
              (("positions", 3), ("normals", 3), ("tangents", 4), ("uv0", 2), ("uv1", 2), ("colors", 4))}  # fmt: skip
    return Scene("test", **arrays, indices=np.zeros(0, np.uint32), meshes=meshes, materials=materials, images=pixels,
                 instances=[Instance(i, np.eye(4)) for i in range(len(images))])  # fmt: skip


def test_images_share_an_array_by_size_class_and_encoding():
    scene = scene_with((256, 256, True), (200, 130, True), (256, 256, False), (16, 8, True))
    placement = place_textures(scene)
    assert [(a.size, a.srgb, len(a.images)) for a in placement.arrays] == [
        (16, True, 1),
        (256, True, 2),
        (256, False, 1),
    ]
    assert [placement.ref(i) for i in range(4)] == [(1, 0), (1, 1), (2, 0), (0, 0)]
    assert placement.ref(99) is None
    assert scene.features().texture_arrays == 3


@pytest.mark.parametrize(
    ("size", "expected"),
    [((1, 1), 1), ((2, 1), 2), ((3, 1), 4), ((256, 256), 256), ((257, 3), 512), ((9999, 9999), 4096)],
)
def test_size_class(size, expected):
    assert size_class(*size) == expected


def test_classes_merge_upward_until_eight_are_left():
    """Eleven classes: 1 to 2 is cheapest, for either encoding; then 2 to 4, and the first of equals."""
    colour = [(2**k, 2**k, True) for k in range(6)]
    data = [(2**k, 2**k, False) for k in range(5)]
    placement = place_textures(scene_with(*colour, *data))
    assert len(placement.arrays) == MAX_ARRAYS
    assert [(a.size, a.srgb, len(a.images)) for a in placement.arrays] == [
        (2, True, 2), (4, True, 1), (8, True, 1), (16, True, 1), (32, True, 1),
        (4, False, 3), (8, False, 1), (16, False, 1),
    ]  # fmt: skip
    assert len({placement.ref(i) for i in range(11)}) == 11


def test_many_layers_are_not_moved_for_one():
    """A class of many small images is dearer to move than a single larger one."""
    sizes = [(1, 1)] * 100 + [(2 ** (k + 1), 1) for k in range(8)]
    placement = place_textures(scene_with(*[(w, h, True) for w, h in sizes]))
    assert placement.arrays[0].size == 1
    assert [len(a.images) for a in placement.arrays] == [100, 2, 1, 1, 1, 1, 1, 1]


def test_too_many_layers(monkeypatch):
    monkeypatch.setattr("rendergraph.scene.texture_arrays.MAX_LAYERS", 2)
    with pytest.raises(RenderGraphError) as caught:
        place_textures(scene_with(*[(1, 1, True)] * 3))
    assert caught.value.diagnostics[0].code == "RG617"


def test_pixels_are_in_layer_order():
    array = place_textures(scene_with((4, 4, True), (3, 2, True), (4, 4, True))).arrays[0]
    pixels = array.pixels()
    assert pixels.shape == (3, 4, 4, 4)
    assert pixels[:, 0, 0, 3].tolist() == [0, 1, 2]
    assert array.bytes == pixels.nbytes


def test_corrupt_image_surfaces_when_decoded():
    class Corrupt:
        width = height = 4

        def decode(self):
            raise RenderGraphError([])

    scene = scene_with((4, 4, True))
    scene.images[0] = Image(Corrupt(), True)
    with pytest.raises(RenderGraphError):
        place_textures(scene).arrays[0].pixels()


# ---------------------------------------------------------------- resampling


def test_same_size_is_untouched():
    pixels = np.random.default_rng(1).integers(0, 256, (8, 8, 4), np.uint8)
    assert resample(pixels, 8, True) is pixels


@pytest.mark.parametrize("srgb", [True, False])
@pytest.mark.parametrize("size", [1, 4, 64])
def test_constant_images_stay_constant_for_every_code(srgb, size):
    codes = np.arange(256, dtype=np.uint8)
    for code in codes[::15]:
        pixels = np.full((5, 3, 4), code, np.uint8)
        assert (resample(pixels, size, srgb) == code).all()


def test_colour_is_averaged_in_linear_light():
    """Half black, half white: linear 0.5 is sRGB code 188; data, alpha, and the known-bad twin give 128 or 127."""
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0] = 255
    assert resample(pixels, 1, True)[0, 0].tolist()[:3] == [188] * 3
    assert resample(pixels, 1, True)[0, 0, 3] in (127, 128)
    assert set(resample(pixels, 1, False)[0, 0].tolist()) <= {127, 128}


def test_rows_and_columns_keep_their_places():
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0, 0, 0], pixels[0, 1, 1], pixels[1, 0, 2] = 255, 255, 255
    large = resample(pixels, 16, False)
    assert large[0, 0].tolist() == [255, 0, 0, 0]
    assert large[0, -1].tolist() == [0, 255, 0, 0]
    assert large[-1, 0].tolist() == [0, 0, 255, 0]


def test_neutral_normals_stay_neutral_down_the_chain() -> None:
    """Drivers that round each level their own way drift; means taken before rounding do not."""
    flat = np.full((8, 8, 4), (128, 127, 255, 255), dtype=np.uint8)
    levels = halved(flat, srgb=False)
    assert [level.shape for level in levels] == [(4, 4, 4), (2, 2, 4), (1, 1, 4)]
    assert all((level == flat[0, 0]).all() for level in levels)


def test_levels_are_means_of_the_first_level() -> None:
    pixels = np.random.default_rng(5).integers(0, 256, (16, 16, 4), dtype=np.uint8)
    last = halved(pixels, srgb=False)[-1][0, 0]
    assert (np.abs(last - pixels.astype(np.float64).mean(axis=(0, 1))) <= 0.5 + 1e-3).all()


def test_levels_of_colour_are_averaged_in_linear_light() -> None:
    checker = np.zeros((2, 2, 4), dtype=np.uint8)
    checker[0, 0] = checker[1, 1] = 255
    # half of full linear light encodes to 188 in sRGB; the mean of the codes would be 128, which alpha keeps
    assert halved(checker, srgb=True)[0][0, 0].tolist() == [188, 188, 188, 128]
