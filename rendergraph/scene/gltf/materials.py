"""Materials, textures and samplers (glTF 2.0, 3.8-3.9; KHR_texture_transform, _emissive_strength, _unlit)."""

from __future__ import annotations

from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.images import Images
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.scene import Alpha, Material, TextureUse, Wrap

_ALPHA = {"OPAQUE": Alpha.OPAQUE, "MASK": Alpha.MASKED, "BLEND": Alpha.BLENDED}
_WRAP = {10497: Wrap.REPEAT, 33071: Wrap.CLAMP, 33648: Wrap.MIRROR}
_FILTERS = (9728, 9729, 9984, 9985, 9986, 9987)
_NEAREST = 9728


def read_material(item: Item, document: Document, images: Images) -> Material:
    """One element of ``materials``. ``RenderGraphError`` RG604-RG606, RG611-RG614."""
    pbr = item.get("pbrMetallicRoughness") or Item({}, item.file)
    alpha = item.get("alphaMode")
    if alpha is not None and alpha.as_text() not in _ALPHA:
        raise alpha.wrong("OPAQUE, MASK or BLEND")
    strength = item.extension("KHR_materials_emissive_strength")
    boost = 1.0 if strength is None else strength.number("emissiveStrength", 1.0, 0.0)
    red, green, blue = item.numbers("emissiveFactor", (0.0, 0.0, 0.0), 0.0)
    base = pbr.numbers("baseColorFactor", (1.0, 1.0, 1.0, 1.0), 0.0)
    normal, occlusion = item.get("normalTexture"), item.get("occlusionTexture")
    return Material(
        name=item.text("name"),
        base_color=(base[0], base[1], base[2], base[3]),
        metallic=pbr.number("metallicFactor", 1.0, 0.0, 1.0),
        roughness=pbr.number("roughnessFactor", 1.0, 0.0, 1.0),
        emissive=(_float32(red * boost), _float32(green * boost), _float32(blue * boost)),
        alpha=Alpha.OPAQUE if alpha is None else _ALPHA[alpha.as_text()],
        alpha_cutoff=item.number("alphaCutoff", 0.5, 0.0),
        double_sided=item.boolean("doubleSided"),
        unlit=item.extension("KHR_materials_unlit") is not None,
        normal_scale=1.0 if normal is None else normal.number("scale", 1.0),
        occlusion_strength=1.0 if occlusion is None else occlusion.number("strength", 1.0, 0.0, 1.0),
        base_color_texture=_texture(pbr.get("baseColorTexture"), True, document, images),
        metallic_roughness_texture=_texture(pbr.get("metallicRoughnessTexture"), False, document, images),
        normal_texture=_texture(normal, False, document, images),
        occlusion_texture=_texture(occlusion, False, document, images),
        emissive_texture=_texture(item.get("emissiveTexture"), True, document, images),
    )


def _float32(value: float) -> float:
    return min(value, 3.4e38)


def _texture(info: Item | None, srgb: bool, document: Document, images: Images) -> TextureUse | None:
    if info is None:
        return None
    texture = document.arrays["textures"][document.as_index(info.require("index"), "textures")]
    source = document.index(texture, "source", "images")
    if source is None:
        document.note(f"{texture.path} has no PNG or JPEG source and was ignored")
        return None
    uv_set = info.integer("texCoord", 0)
    offset, scale, rotation = (0.0, 0.0), (1.0, 1.0), 0.0
    transform = info.extension("KHR_texture_transform")
    if transform is not None:
        offset_x, offset_y = transform.numbers("offset", offset)
        scale_x, scale_y = transform.numbers("scale", scale)
        offset, scale = (offset_x, offset_y), (scale_x, scale_y)
        rotation = transform.number("rotation", 0.0)
        uv_set = transform.integer("texCoord", uv_set)
    if uv_set > 1:
        document.note(f"{info.path} uses TEXCOORD_{uv_set}; only two sets are kept, set 0 is used instead")
        uv_set = 0
    wrap = _wrap(document, texture)
    return TextureUse(images.use(source, srgb), uv_set, wrap, offset, scale, rotation)


def _wrap(document: Document, texture: Item) -> tuple[Wrap, Wrap]:
    index = document.index(texture, "sampler", "samplers")
    if index is None:
        return Wrap.REPEAT, Wrap.REPEAT
    sampler = document.arrays["samplers"][index]
    for name in ("magFilter", "minFilter"):
        mode = sampler.get(name)
        if mode is not None and mode.as_integer() not in _FILTERS:
            raise mode.wrong("a texture filter of glTF")
        if mode is not None and mode.as_integer() == _NEAREST:
            document.note(f"{sampler.path} asks for nearest filtering; all textures are filtered trilinearly")
    modes = []
    for name in ("wrapS", "wrapT"):
        mode = sampler.get(name)
        if mode is not None and mode.as_integer() not in _WRAP:
            raise gltf_error("RG604", str(mode), expected="10497, 33071 or 33648", got=str(mode.value))
        modes.append(Wrap.REPEAT if mode is None else _WRAP[mode.as_integer()])
    return modes[0], modes[1]
