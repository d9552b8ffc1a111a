"""Framebuffer objects over any texture, mip and layer; this module alone binds them.

moderngl keeps its own idea of the bound framebuffer: its ``Framebuffer`` objects are never used.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.texture_rules import level_size
from rendergraph.device.textures import Texture, create_texture
from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import TextureDesc

ColorTarget = tuple[Texture, int, int | None]
DepthTarget = tuple[Texture, int | None]

_STATUS: Final = {
    0x8CD6: "an attachment is incomplete", 0x8CD7: "there is no attachment", 0x8CDB: "a draw buffer has no attachment",
    0x8CDC: "the read buffer has no attachment", 0x8CDD: "the driver does not support this combination of formats",
    0x8D56: "the sample counts differ", 0x8DA8: "layered and single-layer targets are mixed",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Framebuffer:
    """Attachments ready to draw into; ``layers`` is above 1 for layered rendering."""

    glo: int
    width: int
    height: int
    layers: int
    samples: int
    colors: tuple[ColorTarget, ...]
    depth: DepthTarget | None
    label: str


def create_framebuffer(
    device: Device,
    colors: Sequence[ColorTarget],
    depth: DepthTarget | None,
    label: str,
    size: tuple[int, int] | None = None,
) -> Framebuffer:
    """A framebuffer of ``(texture, mip, layer)`` colours, in draw-buffer order, and a ``(texture, layer)`` depth.

    ``layer=None`` attaches a 2d texture, or all layers of a layered one. Without attachments, ``size`` is drawn into
    (shaders then write images or buffers).

    :raises RenderGraphError: RG523 where sizes, samples, layers or formats do not go together.
    """
    targets = [*colors, *([(depth[0], 0, depth[1])] if depth else [])]
    if reason := _mismatch(device, targets, depth, size):
        raise RenderGraphError([diagnose("RG523", label=label, reason=reason)])
    gl = device.gl
    device.debug.subject = label
    glo = device.create_object("glCreateFramebuffers", label=label)
    for index, (texture, mip, layer) in enumerate(colors):
        _attach(device, glo, e.COLOR_ATTACHMENT0 + index, texture, mip, layer)
    if depth is not None:
        point = e.DEPTH_STENCIL_ATTACHMENT if FORMATS[depth[0].desc.format].stencil else e.DEPTH_ATTACHMENT
        _attach(device, glo, point, depth[0], 0, depth[1])
    buffers = [e.COLOR_ATTACHMENT0 + index for index in range(len(colors))] or [e.NONE]
    gl.glNamedFramebufferDrawBuffers(glo, len(buffers), (ctypes.c_uint * len(buffers))(*buffers))
    gl.glNamedFramebufferReadBuffer(glo, buffers[0])
    if targets:
        width, height = (min(level_size(t.desc, m)[axis] for t, m, _ in targets) for axis in (0, 1))
        layered = targets[0][0].layered and targets[0][2] is None
        layers = min(level_size(t.desc, m)[2] for t, m, _ in targets) if layered else 1
        samples = targets[0][0].desc.samples
    else:
        assert size is not None
        width, height, layers, samples = *size, 1, 1
        gl.glNamedFramebufferParameteri(glo, e.FRAMEBUFFER_DEFAULT_WIDTH, width)
        gl.glNamedFramebufferParameteri(glo, e.FRAMEBUFFER_DEFAULT_HEIGHT, height)
    device.name(e.FRAMEBUFFER, glo, label)
    status = gl.glCheckNamedFramebufferStatus(glo, e.DRAW_FRAMEBUFFER)
    errors = device.debug.take_errors()
    if status != e.FRAMEBUFFER_COMPLETE or errors:
        device.delete_object("glDeleteFramebuffers", glo)
        reason = "; ".join(
            [_STATUS.get(status, hex(status)) if status != e.FRAMEBUFFER_COMPLETE else "", *errors]
        ).strip("; ")
        raise RenderGraphError([diagnose("RG523", label=label, reason=reason)])
    device.debug.subject = ""
    return Framebuffer(glo, width, height, layers, samples, tuple(colors), depth, label)


def destroy_framebuffer(device: Device, framebuffer: Framebuffer) -> None:
    """Delete a framebuffer; its textures live on."""
    device.delete_object("glDeleteFramebuffers", framebuffer.glo)


def bind_framebuffer(device: Device, framebuffer: Framebuffer) -> None:
    """Draw into a framebuffer from now on, over its whole size."""
    device.gl.glBindFramebuffer(e.DRAW_FRAMEBUFFER, framebuffer.glo)
    device.gl.glViewport(0, 0, framebuffer.width, framebuffer.height)


def clear_color(device: Device, framebuffer: Framebuffer, index: int, value: tuple[float, float, float, float]) -> None:
    """Set one colour target, all its attached layers, to a value, by the call its format needs.

    Colour masks apply (GL 4.5, 17.4.3); unlike :func:`clear_texture` sRGB targets encode the value.
    """
    channel = FORMATS[framebuffer.colors[index][0].desc.format].channel
    if channel is Channel.UINT:
        device.gl.glClearNamedFramebufferuiv(framebuffer.glo, e.COLOR, index, (ctypes.c_uint * 4)(*map(int, value)))
    elif channel is Channel.INT:
        device.gl.glClearNamedFramebufferiv(framebuffer.glo, e.COLOR, index, (ctypes.c_int * 4)(*map(int, value)))
    else:
        device.gl.glClearNamedFramebufferfv(framebuffer.glo, e.COLOR, index, (ctypes.c_float * 4)(*value))


def clear_depth(device: Device, framebuffer: Framebuffer, depth: float, stencil: int = 0) -> None:
    """Set the depth target, and its stencil where it has one. The depth mask must be on."""
    assert framebuffer.depth is not None
    if FORMATS[framebuffer.depth[0].desc.format].stencil:
        device.gl.glClearNamedFramebufferfi(framebuffer.glo, e.DEPTH_STENCIL, 0, depth, stencil)
    else:
        device.gl.glClearNamedFramebufferfv(framebuffer.glo, e.DEPTH, 0, (ctypes.c_float * 1)(depth))


def blit(device: Device, source: Framebuffer, destination: Framebuffer, *, linear: bool = False) -> None:
    """Copy the first colour target (or depth and stencil, where there is no colour), scaled, converted or resolved.

    Depth, stencil and integer texels are never filtered.
    """
    mask = _blit_mask(source)
    texture = source.colors[0][0] if source.colors else source.depth[0] if source.depth else None
    real = texture is not None and FORMATS[texture.desc.format].channel not in (
        Channel.UINT,
        Channel.INT,
        Channel.DEPTH,
    )
    device.gl.glBlitNamedFramebuffer(
        source.glo, destination.glo, 0, 0, source.width, source.height,
        0, 0, destination.width, destination.height, mask, e.LINEAR if linear and real else e.NEAREST,
    )  # fmt: skip


def resolve(device: Device, texture: Texture, layer: int) -> Texture:
    """One layer of a multisampled texture, averaged (depth, integers: one sample) into a new single-sample texture."""
    flat = TextureDesc(texture.desc.format, texture.desc.width, texture.desc.height)
    destination = create_texture(device, flat, f"{texture.label} resolved")
    at = layer if texture.layered else None
    pair = [_of_one(device, texture, at), _of_one(device, destination, None)]
    blit(device, pair[0], pair[1])
    for framebuffer in pair:
        destroy_framebuffer(device, framebuffer)
    return destination


def _of_one(device: Device, texture: Texture, layer: int | None) -> Framebuffer:
    if FORMATS[texture.desc.format].depth:
        return create_framebuffer(device, [], (texture, layer), texture.label)
    return create_framebuffer(device, [(texture, 0, layer)], None, texture.label)


def _blit_mask(source: Framebuffer) -> int:
    if source.colors or source.depth is None:
        return e.COLOR_BUFFER_BIT
    stencil = e.STENCIL_BUFFER_BIT if FORMATS[source.depth[0].desc.format].stencil else 0
    return e.DEPTH_BUFFER_BIT | stencil


def _attach(device: Device, glo: int, point: int, texture: Texture, mip: int, layer: int | None) -> None:
    if layer is None:
        device.gl.glNamedFramebufferTexture(glo, point, texture.glo, mip)
    else:
        device.gl.glNamedFramebufferTextureLayer(glo, point, texture.glo, mip, layer)


def _mismatch(
    device: Device, targets: Sequence[ColorTarget], depth: DepthTarget | None, size: tuple[int, int] | None
) -> str:
    if not targets:
        return "" if size is not None else "there is no target and no size"
    colors = len(targets) - (depth is not None)
    if colors > device.info.limits["max_color_attachments"]:
        return f"{colors} colour targets are above this device's {device.info.limits['max_color_attachments']}"
    for texture, mip, layer in targets:
        if mip >= texture.desc.mips:
            return f"'{texture.label}' has no mip {mip}"
        if layer is not None and (layer >= level_size(texture.desc, mip)[2] or not texture.layered):
            return f"'{texture.label}' has no layer {layer}"
    for what, seen in {
        "samples": {f"{t.label}: {t.desc.samples}" for t, _, _ in targets},
        "sizes": {f"{t.label}: {level_size(t.desc, m)[0]}x{level_size(t.desc, m)[1]}" for t, m, _ in targets},
    }.items():
        if len({text.rpartition(": ")[2] for text in seen}) > 1:
            return f"the {what} differ ({', '.join(sorted(seen))})"
    return ""
