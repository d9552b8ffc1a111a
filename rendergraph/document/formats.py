"""The texture formats a graph may name: one row each, shared by validation, the planner and the device. Pure data.

Enumerants and view classes are those of the OpenGL 4.5 core profile (tables 8.12, 8.13 and 8.22).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final


class Channel(Enum):
    """How a shader sees one channel of a texel."""

    UNORM = "unorm"
    SNORM = "snorm"
    FLOAT = "float"
    UINT = "uint"
    INT = "int"
    DEPTH = "depth"


@dataclass(frozen=True, slots=True)
class Format:
    """One texture format.

    ``texel_bytes`` is the storage of one texel of one sample; ``view_class`` names the set of formats that may share
    storage through ``glTextureView`` (depth and stencil formats stand alone); ``image`` is the GLSL layout qualifier
    for image load and store, ``None`` where GL refuses the format.
    """

    name: str
    internal_format: int
    texel_bytes: int
    channels: int
    channel: Channel
    view_class: str
    image: str | None = None
    stencil: bool = False
    renderable: bool = True
    srgb: bool = False

    @property
    def depth(self) -> bool:
        """Whether this is a depth (or depth-stencil) format."""
        return self.channel is Channel.DEPTH

    @property
    def sampler(self) -> str:
        """The GLSL sampler prefix: ``""``, ``"u"`` or ``"i"``."""
        return {Channel.UINT: "u", Channel.INT: "i"}.get(self.channel, "")


def _rows() -> dict[str, Format]:
    unorm, snorm, flt, uint, sint, depth = Channel
    rows = [
        Format("r8", 0x8229, 1, 1, unorm, "8", "r8"),
        Format("r8_snorm", 0x8F94, 1, 1, snorm, "8", "r8_snorm"),
        Format("r8ui", 0x8232, 1, 1, uint, "8", "r8ui"),
        Format("r8i", 0x8231, 1, 1, sint, "8", "r8i"),
        Format("r16", 0x822A, 2, 1, unorm, "16", "r16"),
        Format("r16f", 0x822D, 2, 1, flt, "16", "r16f"),
        Format("r16ui", 0x8234, 2, 1, uint, "16", "r16ui"),
        Format("r16i", 0x8233, 2, 1, sint, "16", "r16i"),
        Format("rg8", 0x822B, 2, 2, unorm, "16", "rg8"),
        Format("rg8_snorm", 0x8F95, 2, 2, snorm, "16", "rg8_snorm"),
        Format("rg8ui", 0x8238, 2, 2, uint, "16", "rg8ui"),
        Format("r32f", 0x822E, 4, 1, flt, "32", "r32f"),
        Format("r32ui", 0x8236, 4, 1, uint, "32", "r32ui"),
        Format("r32i", 0x8235, 4, 1, sint, "32", "r32i"),
        Format("rg16", 0x822C, 4, 2, unorm, "32", "rg16"),
        Format("rg16_snorm", 0x8F99, 4, 2, snorm, "32", "rg16_snorm"),
        Format("rg16f", 0x822F, 4, 2, flt, "32", "rg16f"),
        Format("rg16ui", 0x823A, 4, 2, uint, "32", "rg16ui"),
        Format("rgba8", 0x8058, 4, 4, unorm, "32", "rgba8"),
        Format("rgba8_snorm", 0x8F97, 4, 4, snorm, "32", "rgba8_snorm"),
        Format("rgba8ui", 0x8D7C, 4, 4, uint, "32", "rgba8ui"),
        Format("srgb8_a8", 0x8C43, 4, 4, unorm, "32", None, srgb=True),
        Format("rgb10_a2", 0x8059, 4, 4, unorm, "32", "rgb10_a2"),
        Format("rgb10_a2ui", 0x906F, 4, 4, uint, "32", "rgb10_a2ui"),
        Format("r11g11b10f", 0x8C3A, 4, 3, flt, "32", "r11f_g11f_b10f"),
        Format("rgba16", 0x805B, 8, 4, unorm, "64", "rgba16"),
        Format("rgba16_snorm", 0x8F9B, 8, 4, snorm, "64", "rgba16_snorm"),
        Format("rgba16f", 0x881A, 8, 4, flt, "64", "rgba16f"),
        Format("rgba16ui", 0x8D76, 8, 4, uint, "64", "rgba16ui"),
        Format("rg32f", 0x8230, 8, 2, flt, "64", "rg32f"),
        Format("rg32ui", 0x823C, 8, 2, uint, "64", "rg32ui"),
        Format("rgba32f", 0x8814, 16, 4, flt, "128", "rgba32f"),
        Format("rgba32ui", 0x8D70, 16, 4, uint, "128", "rgba32ui"),
        Format("rgba32i", 0x8D82, 16, 4, sint, "128", "rgba32i"),
        Format("d16", 0x81A5, 2, 1, depth, "d16"),
        Format("d24", 0x81A6, 4, 1, depth, "d24"),
        Format("d24s8", 0x88F0, 4, 1, depth, "d24s8", stencil=True),
        Format("d32f", 0x8CAC, 4, 1, depth, "d32f"),
        Format("d32fs8", 0x8CAD, 8, 1, depth, "d32fs8", stencil=True),
    ]
    return {row.name: row for row in rows}


FORMATS: Final[dict[str, Format]] = _rows()

COLOUR: Final[frozenset[str]] = frozenset(f.name for f in FORMATS.values() if not f.depth)
DEPTH: Final[frozenset[str]] = frozenset(f.name for f in FORMATS.values() if f.depth)
STENCIL: Final[frozenset[str]] = frozenset(f.name for f in FORMATS.values() if f.stencil)
STORABLE: Final[frozenset[str]] = frozenset(f.name for f in FORMATS.values() if f.image)
#: Colour formats whose channels read back as floating-point values in a shader.
REAL: Final[frozenset[str]] = frozenset(
    f.name for f in FORMATS.values() if f.channel in (Channel.UNORM, Channel.SNORM, Channel.FLOAT)
)
#: Colour formats without a ceiling of one: what linear radiance needs.
HDR: Final[frozenset[str]] = frozenset(f.name for f in FORMATS.values() if f.channel is Channel.FLOAT)
