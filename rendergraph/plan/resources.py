"""What a graph holds: textures and buffers, their descriptions, and how long each lives."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from rendergraph.document.formats import FORMATS


@dataclass(frozen=True, slots=True)
class Position:
    """A place in a text file: 1-based line and column."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Target(Enum):
    """The shape of a texture."""

    D2 = "2d"
    D2_ARRAY = "2d_array"
    CUBE = "cube"
    CUBE_ARRAY = "cube_array"
    D3 = "3d"


@dataclass(frozen=True, slots=True)
class TextureDesc:
    """An immutable texture: format name, size in texels, layers (or depth slices), mip levels and samples."""

    format: str
    width: int
    height: int
    layers: int = 1
    mips: int = 1
    samples: int = 1
    target: Target = Target.D2

    @property
    def bytes(self) -> int:
        """Storage of all levels, layers and samples, without the driver's padding."""
        total = 0
        for level in range(self.mips):
            width, height = max(1, self.width >> level), max(1, self.height >> level)
            layers = max(1, self.layers >> level) if self.target is Target.D3 else self.layers
            total += width * height * layers
        return total * self.samples * FORMATS[self.format].texel_bytes


@dataclass(frozen=True, slots=True)
class BufferDesc:
    """A range of buffer memory."""

    bytes: int


class Kind(Enum):
    """How long a resource lives."""

    TRANSIENT = "transient"  # within a frame: may share memory
    PERSISTENT = "persistent"  # kept across frames because some history reads it, or it is an output: never shared
    HISTORY = "history"  # last frame's content of `previous_of`; swapped with it at the frame boundary
    IMPORTED = "imported"  # read from a file once


@dataclass(frozen=True, slots=True)
class Resource:
    """A logical resource. ``declared`` is false for a node's internal targets, whose names are ``pass.name``."""

    name: str
    desc: TextureDesc | BufferDesc
    kind: Kind = Kind.TRANSIENT
    previous_of: str | None = None
    file: Path | None = None
    declared: bool = True
    position: Position | None = None
