"""What a sub-pass executes: its program, fixed-function state, and the draw, dispatch, copy or clear itself."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Program:
    """Shader files by stage (``vertex``, ``fragment``, ``geometry``, ``tess_control``, ``tess_evaluation``,
    ``compute``) and the defines of this variant, sorted by name.
    """

    stages: tuple[tuple[str, Path], ...]
    defines: tuple[tuple[str, str], ...] = ()

    @property
    def is_compute(self) -> bool:
        """Whether this is a compute program."""
        return self.stages[0][0] == "compute"


@dataclass(frozen=True, slots=True)
class Blend:
    """Blending of one colour target: factors and equation by GL name without prefix, lower case."""

    source: str = "one"
    destination: str = "one"
    source_alpha: str | None = None  # None: same as colour
    destination_alpha: str | None = None
    equation: str = "add"  # add | subtract | reverse_subtract | min | max


ADDITIVE = Blend("one", "one")
PREMULTIPLIED = Blend("one", "one_minus_src_alpha")


@dataclass(frozen=True, slots=True)
class State:
    """Fixed-function state of a draw.

    ``depth_test`` is written for the reader: ``"closer"`` (and ``"closer_equal"``) means nearer to the camera and the
    device turns it into GREATER or LESS by the frame's depth convention; ``"equal"``, ``"always"``, ``"farther"``.
    ``cull`` is ``none | back | front`` with counter-clockwise fronts. ``None`` depth test switches the test off.
    """

    depth_test: str | None = None
    depth_write: bool = True
    cull: str = "none"
    blend: tuple[Blend | None, ...] = ()  # per colour attachment; empty: off
    color_mask: bool = True
    depth_clamp: bool = False
    depth_bias: tuple[float, float] = (0.0, 0.0)  # (slope factor, constant units), pushed away from the camera


@dataclass(frozen=True, slots=True)
class Fullscreen:
    """One triangle over the whole target; the vertex shader is the library's."""


@dataclass(frozen=True, slots=True)
class DrawArrays:
    """``vertices`` vertices, ``instances`` times, with no vertex attributes: the shader makes them from gl_VertexID.

    ``separate``: a draw call an instance, told apart by the base instance, in place of one instanced call.
    """

    vertices: int
    instances: int = 1
    topology: str = "triangles"  # triangles | triangle_strip | lines | line_strip | points | patches (of 3 vertices)
    separate: bool = False


@dataclass(frozen=True, slots=True)
class DrawIndirect:
    """Arguments (4 words a draw) read from a buffer resource."""

    buffer: str
    offset: int = 0
    count: int = 1
    topology: str = "triangles"


@dataclass(frozen=True, slots=True)
class DrawScene:
    """The scene's geometry by multi-draw-indirect: the queues named, in order. ``instances`` replays each draw (one a
    cascade or cube face); the shader tells them apart by ``gl_InstanceID``.
    """

    queues: tuple[str, ...]  # of "opaque", "masked", "blended"
    instances: int = 1
    cull: str = "back"  # applied to single-sided geometry; double-sided geometry is never culled


@dataclass(frozen=True, slots=True)
class Dispatch:
    """Work groups."""

    x: int
    y: int = 1
    z: int = 1


@dataclass(frozen=True, slots=True)
class DispatchIndirect:
    """Work-group counts (3 words) read from a buffer resource."""

    buffer: str
    offset: int = 0


@dataclass(frozen=True, slots=True)
class CopyTexture:
    """Texel for texel (``blit=False``: same size and view class) or a filtered blit or multisample resolve.

    ``host``: through the host's memory, waiting for the device on the way.
    """

    source: str
    destination: str
    blit: bool = False
    linear: bool = False
    host: bool = False


@dataclass(frozen=True, slots=True)
class CopyBuffer:
    """Bytes from one buffer to another; ``host``: through the host's memory, waiting for the device on the way."""

    source: str
    destination: str
    bytes: int
    host: bool = False


@dataclass(frozen=True, slots=True)
class ClearResource:
    """A whole texture (4 values; for depth the first, for stencil the second) or buffer (one 32-bit word repeated)."""

    resource: str
    value: tuple[float, float, float, float] | int = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class GenerateMips:
    """All levels of a texture from its first, by the driver's box filter."""

    resource: str


Work = (
    Fullscreen
    | DrawArrays
    | DrawIndirect
    | DrawScene
    | Dispatch
    | DispatchIndirect
    | CopyTexture
    | CopyBuffer
    | ClearResource
    | GenerateMips
)

UniformValue = float | int | tuple[float, ...] | tuple[int, ...]
