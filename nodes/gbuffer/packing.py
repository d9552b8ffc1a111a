"""Which packing of a normal a texture format gets: the defines that shaders/packing.glsl is compiled with.

Signed formats hold zero, and with it the directions of the axes, exactly; unsigned ones miss it by half a code, and on
floors and walls of polished material that is seen (3 steps of 255 in a highlight of the atrium).

Octahedral normals: Cigolle et al., "A survey of efficient representations for independent unit vectors", JCGT 3(2),
2014. docs/normal_formats.md has the errors measured over a million directions, poles and axes included.
"""

from __future__ import annotations

from rendergraph.document.formats import FORMATS, Channel

#: Formats a normal target may have, the preferred one first.
NORMAL_FORMATS = (
    "rg16_snorm", "rg16", "rgb10_a2", "rg8", "rg8_snorm", "rgba8", "rgba8_snorm", "rg16f", "rgba16f",
    "rg32f", "rgba32f",
)  # fmt: skip

#: Largest angle between a unit vector and what a format holds of it, degrees. Half floats: where they are truncated, as
#: OpenGL allows (2.3.4.1) and llvmpipe does. 32-bit floats: the shader's own arithmetic.
NORMAL_ERROR = {
    "rg8": 0.95, "rg8_snorm": 0.95, "rgba8": 0.39, "rgba8_snorm": 0.39, "rgb10_a2": 0.097, "rg16": 0.0037,
    "rg16_snorm": 0.0037, "rg16f": 0.12, "rgba16f": 0.026, "rg32f": 5e-5, "rgba32f": 5e-5,
}  # fmt: skip


def normal_defines(format: str) -> dict[str, int]:
    """``NORMAL_CHANNELS`` (2: octahedral, else xyz) and ``NORMAL_SIGNED`` of a format, for writer and readers alike."""
    row = FORMATS[format]
    return {"NORMAL_CHANNELS": row.channels, "NORMAL_SIGNED": int(row.channel is not Channel.UNORM)}
