"""Sampler objects, made once for each combination of filter, wrap and depth convention."""

from __future__ import annotations

import ctypes
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.context import Device

FILTERS: Final = ("nearest", "linear", "mipmap", "compare")
WRAPS: Final = {"clamp": e.CLAMP_TO_EDGE, "repeat": e.REPEAT, "border": e.CLAMP_TO_BORDER}


def sampler(device: Device, filter: str, wrap: str, reversed_depth: bool) -> int:
    """The sampler object of a filter (``nearest``, ``linear``, ``mipmap``, ``compare``) and wrap mode.

    ``mipmap`` is trilinear. ``compare`` compares the reference with stored depth and filters the results (2x2 PCF):
    lit (1) where the reference is not farther, ``>=`` under reversed depth, ``<=`` under standard. Outside a
    ``border`` texture depth is the far plane (lit), colour transparent black.
    """
    key = (filter, wrap, reversed_depth if filter == "compare" else None)
    if key not in device.samplers:
        device.samplers[key] = _create(device, filter, wrap, reversed_depth)
    return device.samplers[key]


def _create(device: Device, filter: str, wrap: str, reversed_depth: bool) -> int:
    gl = device.gl
    label = f"{filter} {wrap}"
    glo = device.create_object("glCreateSamplers", label=label)
    smooth = e.NEAREST if filter == "nearest" else e.LINEAR
    gl.glSamplerParameteri(glo, e.TEXTURE_MAG_FILTER, smooth)
    gl.glSamplerParameteri(glo, e.TEXTURE_MIN_FILTER, e.LINEAR_MIPMAP_LINEAR if filter == "mipmap" else smooth)
    for axis in (e.TEXTURE_WRAP_S, e.TEXTURE_WRAP_T, e.TEXTURE_WRAP_R):
        gl.glSamplerParameteri(glo, axis, WRAPS[wrap])
    if filter == "compare":
        gl.glSamplerParameteri(glo, e.TEXTURE_COMPARE_MODE, e.COMPARE_REF_TO_TEXTURE)
        gl.glSamplerParameteri(glo, e.TEXTURE_COMPARE_FUNC, e.GEQUAL if reversed_depth else e.LEQUAL)
        far = 0.0 if reversed_depth else 1.0
        gl.glSamplerParameterfv(glo, e.TEXTURE_BORDER_COLOR, ctypes.byref((ctypes.c_float * 4)(far, far, far, far)))
    device.name(e.SAMPLER, glo, label)
    return glo
