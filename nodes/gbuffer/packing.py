"""Which packing of a normal a texture format gets: the defines that shaders/packing.glsl is compiled with.

===================  =====  ==========  ==============================
format               bytes  packing     largest error (degrees)
===================  =====  ==========  ==============================
rg8, rg8_snorm       2      octahedral  0.95, 0.95
rg16, rg16_snorm     4      octahedral  0.0037, 0.0037
rg16f                4      octahedral  0.059 (0.118 where truncated)
rgb10_a2             4      xyz         0.096
rgba8, rgba8_snorm   4      xyz         0.39, 0.39
rgba16f              8      xyz         0.02 (0.04 where truncated)
rg32f                8      octahedral  float32 rounding
rgba32f              16     xyz         float32 rounding
===================  =====  ==========  ==============================

Signed formats hold zero, and with it the directions of the axes, exactly; unsigned ones miss it by half a code, and on
floors and walls of polished material that is seen (3 steps of 255 in a highlight of the atrium).

Octahedral normals: Cigolle et al., "A survey of efficient representations for independent unit vectors", JCGT 3(2),
2014. The figures are measured by tests/nodes/test_gbuffer.py over a million directions, poles and axes included.
"""

from __future__ import annotations

from rendergraph.document.formats import FORMATS, Channel

#: Formats a normal target may have, the preferred one first.
NORMAL_FORMATS = (
    "rg16_snorm", "rg16", "rgb10_a2", "rg8", "rg8_snorm", "rgba8", "rgba8_snorm", "rg16f", "rgba16f",
    "rg32f", "rgba32f",
)  # fmt: skip


def normal_defines(format: str) -> dict[str, int]:
    """``NORMAL_CHANNELS`` (2: octahedral, else xyz) and ``NORMAL_SIGNED`` of a format, for writer and readers alike."""
    row = FORMATS[format]
    return {"NORMAL_CHANNELS": row.channels, "NORMAL_SIGNED": int(row.channel is not Channel.UNORM)}
