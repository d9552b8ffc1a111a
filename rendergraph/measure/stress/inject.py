"""Bad texels in what a pass reads, put there right before it runs."""

from __future__ import annotations

import numpy as np

from rendergraph.device.context import Device
from rendergraph.device.textures import read_texture, upload_texture
from rendergraph.document.load import Document
from rendergraph.measure.stress.formats import holds_floats
from rendergraph.plan.graph import TextureDesc
from rendergraph.plan.plan import Plan
from rendergraph.run.runner import Runner


def injected_texels(width: int, height: int) -> tuple[tuple[int, int], ...]:
    """Where: the middle, two corners and an edge, ``(x, y)`` from the lower left."""
    return tuple(dict.fromkeys([(width // 2, height // 2), (0, 0), (width - 1, height - 1), (width - 1, height // 2)]))


def injectable(document: Document, plan: Plan, name: str) -> list[str]:
    """The resources that a pass reads and that can hold NaN: float colour of one sample."""
    return [r for r in document.model.passes[name].read.values() if _takes(plan, r)]


def _takes(plan: Plan, resource: str) -> bool:
    if resource not in plan.lifetimes:
        return False
    desc = plan.graph.resources[resource].desc
    return isinstance(desc, TextureDesc) and desc.samples == 1 and holds_floats(desc.format)


def inject(runner: Runner, document: Document, device: Device, name: str, frame: int, value: float) -> None:
    """Write ``value`` into texels of a pass's float inputs.

    What earlier passes let through is set to zero first, so that each pass meets the same bad texels and no more.
    """
    plan = runner.plan
    read = injectable(document, plan, name)
    written = [r for r in document.model.passes[name].write.values() if _takes(plan, r)]
    for resource in dict.fromkeys([*read, *written]):
        if plan.graph.resources[resource].file is not None:
            continue  # a file's image is uploaded once, and for all frames
        texture = runner.storage.texture(resource, frame)
        texels = np.nan_to_num(read_texture(device, texture), nan=0.0, posinf=0.0, neginf=0.0)
        if resource in read:
            for x, y in injected_texels(texture.desc.width, texture.desc.height):
                texels[..., y, x, :] = value
        upload_texture(device, texture, texels)
