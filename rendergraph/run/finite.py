"""`--check-finite`: after each sub-pass, every level of each float texture it wrote is searched for NaN and Inf.

Buffers are not: what their words mean is known to the shaders alone.
"""

from __future__ import annotations

import numpy as np

from rendergraph.device import enums
from rendergraph.device.context import Device
from rendergraph.device.textures import read_texture
from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import SubPass, TextureDesc
from rendergraph.plan.plan import Plan
from rendergraph.run.allocation import Allocation


def check_finite_writes(device: Device, plan: Plan, subpass: SubPass, storage: Allocation, frame: int) -> None:
    """Raise RenderGraphError RG565 for the first texel, in reading order, that is not finite."""
    device.gl.glMemoryBarrier(enums.TEXTURE_UPDATE_BARRIER_BIT)
    for access in subpass.accesses:
        desc = plan.graph.resources[access.resource].desc
        if not access.usage.writes or not isinstance(desc, TextureDesc):
            continue
        if FORMATS[desc.format].channel not in (Channel.FLOAT, Channel.DEPTH):
            continue
        texture = storage.texture(access.resource, frame)
        for mip in range(desc.mips) if access.mip is None else (access.mip,):
            pixels = read_texture(device, texture, mip, access.layer)
            layers = pixels if pixels.ndim == 4 else pixels[None]
            bad = ~np.isfinite(layers).all(axis=-1)
            if not bad.any():
                continue
            layer, y, x = (int(v) for v in np.argwhere(bad)[0])
            texel = layers[layer, y, x]
            where = "" if mip == 0 and len(layers) == 1 else f", mip {mip}, layer {layer}"
            raise RenderGraphError([
                diagnose(
                    "RG565", subpass.position, subpass=subpass.name, resource=access.resource, x=x, y=y, where=where,
                    value="(" + ", ".join(f"{v:g}" for v in texel) + ")", count=int(bad.sum()), total=bad.size,
                )
            ])  # fmt: skip
