"""Materials, textures, texture transforms and images."""

from __future__ import annotations

import base64
import io
import math
import struct
import zlib

import numpy as np
import pytest
from PIL import Image as PillowImage

from rendergraph.document.messages import RenderGraphError
from rendergraph.scene.gltf.images import EncodedImage
from rendergraph.scene.scene import Alpha, Material, Wrap


def material_of(tiny, **definition):
    """The scene of one triangle with the material, and the material as loaded."""
    primitive = tiny.triangle(TEXCOORD_0=tiny.accessor([[0, 0], [1, 0], [0, 1]]))
    primitive["material"] = tiny.append("materials", definition)
    scene = tiny.load()
    return scene, scene.materials[0]


def test_defaults(tiny):
    assert material_of(tiny)[1] == Material()


def test_factors(tiny):
    _, material = material_of(
        tiny,
        name="brass",
        pbrMetallicRoughness={"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6},
        emissiveFactor=[0.1, 0.2, 0.5],
        alphaMode="MASK",
        alphaCutoff=0.25,
        doubleSided=True,
        extensions={"KHR_materials_unlit": {}, "KHR_materials_emissive_strength": {"emissiveStrength": 10}},
    )
    assert material.name == "brass"
    assert material.base_color == (0.1, 0.2, 0.3, 0.4)
    assert (material.metallic, material.roughness) == (0.5, 0.6)
    assert material.emissive == (1.0, 2.0, 5.0)
    assert (material.alpha, material.alpha_cutoff) == (Alpha.MASKED, 0.25)
    assert material.double_sided
    assert material.unlit


@pytest.mark.parametrize(
    ("mode", "alpha"), [("OPAQUE", Alpha.OPAQUE), ("MASK", Alpha.MASKED), ("BLEND", Alpha.BLENDED)]
)
def test_alpha_modes(tiny, mode, alpha):
    assert material_of(tiny, alphaMode=mode)[1].alpha is alpha


def test_every_slot_and_its_encoding(tiny):
    """One image used as colour and as data becomes two scene images, each shared by its users."""
    index = tiny.texture()
    scene, material = material_of(
        tiny,
        pbrMetallicRoughness={"baseColorTexture": {"index": index}, "metallicRoughnessTexture": {"index": index}},
        normalTexture={"index": index, "scale": 0.5},
        occlusionTexture={"index": index, "strength": 0.25, "texCoord": 1},
        emissiveTexture={"index": index},
    )
    assert len(scene.images) == 2
    assert scene.images[material.base_color_texture.image].srgb
    assert scene.images[material.emissive_texture.image].srgb
    data = {material.metallic_roughness_texture.image, material.normal_texture.image, material.occlusion_texture.image}
    assert [scene.images[i].srgb for i in data] == [False]
    assert (material.normal_scale, material.occlusion_strength) == (0.5, 0.25)
    assert material.occlusion_texture.uv_set == 1
    features = scene.features()
    assert features.textured
    assert features.normal_mapped
    assert features.occlusion_mapped
    assert features.texture_arrays == 2
    assert features.second_uv
    assert (features.texture_wraps, features.texture_transforms, features.vertex_colors) == (False, False, False)


def test_sampler_wrap_and_nearest_note(tiny):
    sampler = tiny.append("samplers", {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728})
    texture = {"index": tiny.texture(sampler=sampler)}
    scene, material = material_of(tiny, pbrMetallicRoughness={"baseColorTexture": texture})
    assert material.base_color_texture.wrap == (Wrap.CLAMP, Wrap.MIRROR)
    assert scene.features().texture_wraps
    assert len(scene.notes) == 1


def test_texture_transform_and_its_uv_set(tiny):
    transform = {"offset": [0.1, 0.2], "scale": [2, 3], "rotation": 0.5, "texCoord": 1}
    texture = {"index": tiny.texture(), "texCoord": 0, "extensions": {"KHR_texture_transform": transform}}
    scene, material = material_of(tiny, pbrMetallicRoughness={"baseColorTexture": texture})
    use = material.base_color_texture
    assert scene.features().texture_transforms
    assert (use.offset, use.scale, use.rotation, use.uv_set) == ((0.1, 0.2), (2.0, 3.0), 0.5, 1)


def test_third_uv_set_and_texture_without_source_are_noted(tiny):
    tiny.texture()
    tiny.append("textures", {"extensions": {"KHR_texture_basisu": {"source": 0}}})
    pbr = {"baseColorTexture": {"index": 0, "texCoord": 2}, "metallicRoughnessTexture": {"index": 1}}
    scene, material = material_of(tiny, pbrMetallicRoughness=pbr)
    assert material.base_color_texture.uv_set == 0
    assert material.metallic_roughness_texture is None
    assert len(scene.notes) == 2


@pytest.mark.parametrize("rotation", [0.0, math.pi / 2])
def test_generated_tangents_follow_the_transformed_uvs(tiny, rotation):
    """U runs along +x. With the coordinates turned by a quarter, the map's u runs along another axis: dP/du of
    u' = v, v' = -u is +v's direction.
    """
    transform = {"KHR_texture_transform": {"rotation": rotation}}
    normal = tiny.accessor([[0, 0, 1]] * 3)
    uv = tiny.accessor([[0, 1], [1, 1], [0, 0]])  # v downward, as glTF has it
    primitive = tiny.triangle(NORMAL=normal, TEXCOORD_0=uv)
    primitive["material"] = tiny.append(
        "materials", {"normalTexture": {"index": tiny.texture(), "extensions": transform}}
    )
    expected = [1, 0, 0, 1] if rotation == 0 else [0, -1, 0, 1]
    np.testing.assert_allclose(tiny.load().tangents, [expected] * 3, atol=1e-6)


def test_normal_map_without_uvs_is_noted(tiny):
    primitive = tiny.triangle(NORMAL=tiny.accessor([[0, 0, 1]] * 3))
    primitive["material"] = tiny.append("materials", {"normalTexture": {"index": tiny.texture()}})
    scene = tiny.load()
    assert len(scene.notes) == 1
    np.testing.assert_allclose(np.linalg.norm(scene.tangents[:, :3], axis=1), 1, rtol=1e-6)


# ---------------------------------------------------------------- images


def encode(mode, color, format, size=(4, 3)):
    stream = io.BytesIO()
    PillowImage.new(mode, size, color).save(stream, format)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("mode", "color", "format", "expected"),
    [
        ("RGBA", (1, 2, 3, 4), "PNG", (1, 2, 3, 4)),
        ("RGB", (1, 2, 3), "PNG", (1, 2, 3, 255)),
        ("L", 9, "PNG", (9, 9, 9, 255)),
        ("LA", (9, 8), "PNG", (9, 9, 9, 8)),
        ("P", 0, "PNG", None),
        ("I;16", 0x1280, "PNG", (0x12, 0x12, 0x12, 255)),
        ("L", 128, "JPEG", (128, 128, 128, 255)),
        ("RGB", (128, 128, 128), "JPEG", (128, 128, 128, 255)),
        ("CMYK", (0, 0, 0, 0), "JPEG", (255, 255, 255, 255)),
    ],
)
def test_decoding(mode, color, format, expected):
    image = EncodedImage(encode(mode, color, format), "here")
    assert (image.width, image.height) == (4, 3)
    pixels = image.decode()
    assert pixels.shape == (3, 4, 4)
    if expected is not None:
        assert pixels[0, 0].tolist() == list(expected)


def test_first_row_is_on_top():
    stream = io.BytesIO()
    PillowImage.fromarray(np.array([[[255, 0, 0]], [[0, 0, 255]]], np.uint8)).save(stream, "PNG")
    assert EncodedImage(stream.getvalue(), "here").decode()[0, 0].tolist() == [255, 0, 0, 255]


@pytest.mark.parametrize("source", ["view", "data", "file"])
def test_image_sources_and_laziness(tiny, source, monkeypatch):
    content = tiny.png((10, 20, 30, 40))
    (tiny.folder / "tex.png").write_bytes(content)
    uri = {"data": "data:image/png;base64," + base64.b64encode(content).decode(), "file": "tex.png"}
    image = {"bufferView": tiny.view(content)} if source == "view" else {"uri": uri[source]}
    tiny.append("textures", {"source": tiny.append("images", image)})
    decoded = []
    decode = EncodedImage.decode
    monkeypatch.setattr(EncodedImage, "decode", lambda self: decoded.append(1) or decode(self))
    scene, _ = material_of(tiny, pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    assert (scene.images[0].width, scene.images[0].height) == (2, 2)
    assert decoded == []
    assert scene.images[0].pixels[0, 0].tolist() == [10, 20, 30, 40]
    assert scene.images[0].pixels is scene.images[0].pixels
    assert decoded == [1]


def bomb(width, height):
    """A PNG whose header claims a size that its few bytes could never fill."""
    header = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunk = struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))
    return b"\x89PNG\r\n\x1a\n" + chunk


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (bomb(100_000, 100_000), "RG614"),
        (bomb(2**31 - 1, 2**31 - 1), "RG614"),
        (bomb(0, 5), "RG613"),
        (b"", "RG613"),
        (b"\x89PNG", "RG613"),
        (b"\xff\xd8\xff", "RG613"),
        (b"\xff\xd8\xff\xe0\x00\x01", "RG613"),
        (b"\xff\xd8" + b"\xff" * 50, "RG613"),
        (b"GIF89a" + bytes(50), "RG613"),
    ],
)
def test_unusable_images_are_refused_by_their_header(content, code):
    with pytest.raises(RenderGraphError) as caught:
        EncodedImage(content, "here")
    assert caught.value.diagnostics[0].code == code


@pytest.mark.parametrize("format", ["PNG", "JPEG"])
def test_corrupt_image_data(format):
    content = encode("RGB", (1, 2, 3), format, (64, 64))
    for damaged in (content[: len(content) // 2], content[:20] + bytes(40) + content[60:]):
        with pytest.raises(RenderGraphError) as caught:
            EncodedImage(damaged, "here").decode()
        assert caught.value.diagnostics[0].code == "RG613"


def test_images_too_large_together(tiny, monkeypatch):
    monkeypatch.setattr("rendergraph.scene.gltf.images.MAX_TOTAL_PIXELS", 7)
    textures = [{"index": tiny.texture()} for _ in range(2)]  # 2 x 2 pixels each
    pbr = {"baseColorTexture": textures[0], "metallicRoughnessTexture": textures[1]}
    with pytest.raises(RenderGraphError) as caught:
        material_of(tiny, pbrMetallicRoughness=pbr)
    assert caught.value.diagnostics[0].code == "RG614"
