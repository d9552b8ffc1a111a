"""Immutable textures and views of their storage, of every target; upload, clear and read back.

Rows run bottom-up everywhere: row 0 of an array is the texel row at y = 0 (docs/conventions.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.texels import Poison, clear_value, poison_value, transfer
from rendergraph.device.texture_rules import level_size as level_size
from rendergraph.device.texture_rules import say, why_impossible, why_not_viewable
from rendergraph.document.formats import FORMATS
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Target, TextureDesc

_TARGETS: Final = {
    Target.D2: e.TEXTURE_2D, Target.D2_ARRAY: e.TEXTURE_2D_ARRAY, Target.CUBE: e.TEXTURE_CUBE_MAP,
    Target.CUBE_ARRAY: e.TEXTURE_CUBE_MAP_ARRAY, Target.D3: e.TEXTURE_3D,
}  # fmt: skip
_MULTISAMPLE: Final = {
    Target.D2: e.TEXTURE_2D_MULTISAMPLE, Target.D2_ARRAY: e.TEXTURE_2D_MULTISAMPLE_ARRAY,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Texture:
    """A texture object. A view does not own its storage; ``target`` is the GL enumerant."""

    glo: int
    desc: TextureDesc
    target: int
    label: str
    view: bool = False

    @property
    def layered(self) -> bool:
        """Whether it has layers, faces or slices to attach at once."""
        return self.desc.target is not Target.D2


def gl_target(desc: TextureDesc) -> int:
    """The GL texture target of a description; ``KeyError`` for multisampled cubes and volumes, which GL has not."""
    return (_MULTISAMPLE if desc.samples > 1 else _TARGETS)[desc.target]


def create_texture(device: Device, desc: TextureDesc, label: str) -> Texture:
    """A texture with immutable storage of all its mips, layers and samples; content undefined, filter nearest.

    :raises RenderGraphError: RG520 beyond the device's limits or a shape GL has not, RG521 out of memory.
    """
    if reason := why_impossible(desc, device.info.limits):
        raise RenderGraphError([diagnose("RG520", label=label, reason=reason)])
    gl, internal, target = device.gl, FORMATS[desc.format].internal_format, gl_target(desc)
    device.debug.subject = label
    glo = device.create_object("glCreateTextures", target, label=label)
    size = (desc.width, desc.height)
    if desc.samples > 1 and desc.target is Target.D2_ARRAY:
        gl.glTextureStorage3DMultisample(glo, desc.samples, internal, *size, desc.layers, 1)
    elif desc.samples > 1:
        gl.glTextureStorage2DMultisample(glo, desc.samples, internal, *size, 1)
    elif desc.target in (Target.D2, Target.CUBE):
        gl.glTextureStorage2D(glo, desc.mips, internal, *size)
    else:
        gl.glTextureStorage3D(glo, desc.mips, internal, *size, desc.layers)
    if desc.samples == 1:
        _filter_nearest(device, glo)
    device.name(e.TEXTURE, glo, label)
    _accept(device, glo, label, desc)
    return Texture(glo, desc, target, label)


def create_view(
    device: Device,
    texture: Texture,
    desc: TextureDesc,
    label: str,
    *,
    mip: int = 0,
    layer: int = 0,
    stencil: bool = False,
) -> Texture:
    """Another reading of a texture's storage: ``desc`` from level ``mip`` and layer ``layer`` on, in its view class.

    ``stencil`` makes samplers see the stencil value of a depth-stencil texture instead of its depth.

    :raises RenderGraphError: RG522 where the formats, sizes, samples or shapes do not allow it.
    """
    if reason := why_not_viewable(texture.desc, desc, mip, layer):
        raise RenderGraphError([
            diagnose("RG522", label=label, view=say(desc), storage=say(texture.desc), reason=reason)
        ])  # fmt: skip
    device.debug.subject = label
    glo = device.create_object("glGenTextures", label=label)
    internal, target = FORMATS[desc.format].internal_format, gl_target(desc)
    # A volume is one layer to glTextureView, whatever its depth.
    layers = 1 if desc.target is Target.D3 else desc.layers
    device.gl.glTextureView(glo, target, texture.glo, internal, mip, desc.mips, layer, layers)
    if desc.samples == 1:
        _filter_nearest(device, glo)
    if stencil:
        device.gl.glTextureParameteri(glo, e.DEPTH_STENCIL_TEXTURE_MODE, e.STENCIL_INDEX)
    device.name(e.TEXTURE, glo, label)
    _accept(device, glo, label, desc)
    return Texture(glo, desc, target, label, view=True)


def destroy_texture(device: Device, texture: Texture) -> None:
    """Delete a texture or view; storage goes with the last texture that uses it."""
    device.delete_object("glDeleteTextures", texture.glo)


def upload_texture(
    device: Device, texture: Texture, data: NDArray[Any], *, mip: int = 0, layer: int | None = None
) -> None:
    """Fill a level, or one layer of it, from ``[h, w, c]`` (all layers: ``[layers, h, w, c]``) of the format's dtype.

    :raises RenderGraphError: RG524 for another shape or dtype.
    """
    layout = transfer(texture.desc.format)
    width, height, layers = level_size(texture.desc, mip)
    depth = 1 if layer is not None else layers
    shape = (height, width, layout.channels)
    expected = (depth, *shape)
    if data.dtype != layout.dtype or data.shape not in ({expected, shape} if depth == 1 else {expected}):
        reason = f"{data.dtype}{list(data.shape)} given, {np.dtype(layout.dtype)}{list(expected)} expected"
        raise RenderGraphError([diagnose("RG524", label=texture.label, reason=reason)])
    device.debug.subject = texture.label
    block = np.ascontiguousarray(data)
    arguments = (layout.format, layout.type, block.ctypes.data)
    if texture.desc.target is Target.D2:
        device.gl.glTextureSubImage2D(texture.glo, mip, 0, 0, width, height, *arguments)
    else:
        device.gl.glTextureSubImage3D(texture.glo, mip, 0, 0, layer or 0, width, height, depth, *arguments)
    device.counters.bytes_uploaded += block.nbytes
    device.debug.subject = ""


def clear_texture(
    device: Device,
    texture: Texture,
    value: tuple[float, float, float, float],
    *,
    mip: int | None = None,
    layer: int | None = None,
) -> None:
    """Set every texel (of one mip, one layer) to a value; depth formats take depth and stencil first.

    sRGB targets store the value as given, without encoding it.
    """
    texel, format, kind = clear_value(texture.desc.format, value)
    device.debug.subject = texture.label
    for level in range(texture.desc.mips) if mip is None else (mip,):
        if layer is None:
            device.gl.glClearTexImage(texture.glo, level, format, kind, texel.ctypes.data)
        else:
            width, height, _ = level_size(texture.desc, level)
            device.gl.glClearTexSubImage(
                texture.glo, level, 0, 0, layer, width, height, 1, format, kind, texel.ctypes.data
            )
    device.debug.subject = ""


def poison_texture(device: Device, texture: Texture, poison: Poison = "nan") -> None:
    """Fill with what must never be seen: see :func:`rendergraph.device.texels.poison_value`."""
    clear_texture(device, texture, poison_value(texture.desc.format, poison))


def read_texture(
    device: Device, texture: Texture, mip: int = 0, layer: int | None = None, *, aspect: str = "color"
) -> NDArray[Any]:
    """One level as ``[h, w, c]`` (with ``layer=None`` on a layered texture ``[layers, h, w, c]``), rows bottom-up.

    dtype: float16 and float32 as stored, unsigned or signed integers of the channel's width for (s)norm and integer
    formats, float32 for r11g11b10f, rgb10_a2 and depth, uint8 for ``aspect="stencil"``. Multisampled textures are
    resolved first (depth and integers: one sample).
    """
    from rendergraph.device.framebuffers import resolve

    if texture.desc.samples > 1:
        flat = resolve(device, texture, layer or 0)
        try:
            return read_texture(device, flat, aspect=aspect)
        finally:
            destroy_texture(device, flat)
    layout = transfer(texture.desc.format, aspect)
    width, height, layers = level_size(texture.desc, mip)
    first, count = (layer, 1) if layer is not None else (0, layers)
    texels = np.empty((count, height, width, layout.channels), layout.dtype)
    device.debug.subject = texture.label
    device.gl.glGetTextureSubImage(
        texture.glo, mip, 0, 0, first, width, height, count, layout.format, layout.type,
        texels.nbytes, texels.ctypes.data,
    )  # fmt: skip
    device.debug.subject = ""
    return texels if texture.layered and layer is None else texels[0]


def generate_mips(device: Device, texture: Texture) -> None:
    """Fill the lower levels from the first by the driver's box filter."""
    device.debug.subject = texture.label
    device.gl.glGenerateTextureMipmap(texture.glo)
    device.debug.subject = ""


def copy_texture(device: Device, source: Texture, destination: Texture) -> None:
    """Copy all texels of every common mip and layer, unconverted, between textures of one size and view class."""
    device.debug.subject = destination.label
    for mip in range(min(source.desc.mips, destination.desc.mips)):
        width, height, layers = level_size(source.desc, mip)
        device.gl.glCopyImageSubData(
            source.glo, source.target, mip, 0, 0, 0, destination.glo, destination.target, mip, 0, 0, 0,
            width, height, min(layers, level_size(destination.desc, mip)[2]),
        )  # fmt: skip
    device.debug.subject = ""


def _filter_nearest(device: Device, glo: int) -> None:
    """The defaults filter linearly, which makes integer textures incomplete for texelFetch."""
    device.gl.glTextureParameteri(glo, e.TEXTURE_MIN_FILTER, e.NEAREST)
    device.gl.glTextureParameteri(glo, e.TEXTURE_MAG_FILTER, e.NEAREST)


def _accept(device: Device, glo: int, label: str, desc: TextureDesc) -> None:
    if not device.debug.synchronous:
        device.debug.poll()
    if texts := device.debug.take_errors():
        device.delete_object("glDeleteTextures", glo)
        if any("OUT_OF_MEMORY" in text.upper().replace(" ", "_") for text in texts):
            raise RenderGraphError([diagnose("RG521", label=label, bytes=desc.bytes)])
        raise RenderGraphError([diagnose("RG520", label=label, reason="; ".join(texts))])
    device.debug.subject = ""
