"""Which textures and views a device can make, said before it is asked: reasons for people instead of GL error codes."""

from __future__ import annotations

from typing import Final

from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import Target, TextureDesc

_CUBES: Final = (Target.CUBE, Target.CUBE_ARRAY)
_MULTISAMPLE: Final = (Target.D2, Target.D2_ARRAY)


def level_size(desc: TextureDesc, mip: int) -> tuple[int, int, int]:
    """Width, height and layers (or slices) of one mip level."""
    layers = max(1, desc.layers >> mip) if desc.target is Target.D3 else desc.layers
    return max(1, desc.width >> mip), max(1, desc.height >> mip), layers


def say(desc: TextureDesc) -> str:
    """A description in words."""
    samples = f" x{desc.samples}" if desc.samples > 1 else ""
    return f"{desc.format} {desc.target.value} {desc.width}x{desc.height}x{desc.layers}{samples}"


def why_impossible(desc: TextureDesc, limits: dict[str, int]) -> str:
    """Why no texture can be made so on a device of these limits; empty when it can."""
    name = {Target.D3: "max_3d_texture_size", Target.CUBE: "max_cube_map_texture_size"}.get(
        desc.target, "max_texture_size"
    )
    sides = (desc.width, desc.height, desc.layers) if desc.target is Target.D3 else (desc.width, desc.height)
    if min(desc.width, desc.height, desc.layers, desc.mips, desc.samples) < 1:
        return f"{say(desc)} has a size of zero"
    if max(sides) > limits[name]:
        return f"{say(desc)} is above this device's {limits[name]} texels a side"
    if desc.target is not Target.D3 and desc.layers > limits["max_array_texture_layers"]:
        return f"{desc.layers} layers are above this device's {limits['max_array_texture_layers']}"
    if desc.samples > limits["max_samples"]:
        return f"{desc.samples} samples are above this device's {limits['max_samples']}"
    if desc.mips > max(sides).bit_length():
        return f"{desc.mips} mips are more than a side of {max(sides)} has"
    if desc.samples > 1 and (desc.mips > 1 or desc.target not in _MULTISAMPLE):
        return "multisampled textures are 2d or 2d_array, with one mip"
    if desc.target in _CUBES and (desc.width != desc.height or desc.layers % 6):
        return f"a cube is square with 6 layers (faces) a cube, not {say(desc)}"
    if desc.target is Target.CUBE and desc.layers != 6:
        return f"one cube has 6 layers, not {desc.layers}"
    if desc.target is Target.D2 and desc.layers != 1:
        return f"a 2d texture has one layer, not {desc.layers}"
    if desc.target is Target.D3 and FORMATS[desc.format].depth:
        return "a volume cannot have a depth format"
    return ""


def why_not_viewable(storage: TextureDesc, view: TextureDesc, mip: int, layer: int) -> str:
    """Why storage cannot be seen as ``view`` from that mip and layer on (GL 4.5, 8.18); empty when it can."""
    if FORMATS[storage.format].view_class != FORMATS[view.format].view_class:
        return f"view classes {FORMATS[storage.format].view_class} and {FORMATS[view.format].view_class} differ"
    if storage.samples != view.samples:
        return "the sample counts differ"
    if (storage.target is Target.D3) != (view.target is Target.D3):
        return "a volume can only be viewed as a volume"
    if mip + view.mips > storage.mips:
        return f"it has {storage.mips} mips"
    if (view.width, view.height) != level_size(storage, mip)[:2]:
        return "the sizes differ"
    if storage.target is not Target.D3 and layer + view.layers > storage.layers:
        return f"it has {storage.layers} layers"
    return ""
