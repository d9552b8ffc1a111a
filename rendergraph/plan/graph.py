"""The expanded graph: resources, and the sub-passes that touch them. Plain frozen data, the vocabulary of every phase.

A pass of the YAML expands to one or more sub-passes named ``pass.step``. A sub-pass says everything the planner must
know (its accesses) and everything the device must know (its program, state and work); nothing here executes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rendergraph.document.formats import FORMATS

if TYPE_CHECKING:
    from rendergraph.scene.features import SceneFeatures


@dataclass(frozen=True, slots=True)
class Position:
    """A place in a text file: 1-based line and column."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


# ---------------------------------------------------------------- resources


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


# ---------------------------------------------------------------- accesses


class Usage(Enum):
    """One way a sub-pass touches a resource."""

    COLOR = "color"  # colour attachment, written (blending reads it too: `load`)
    DEPTH = "depth"  # depth or stencil attachment, written
    DEPTH_READ = "depth_read"  # depth attachment, tested only
    SAMPLED = "sampled"  # texture fetch or sampler
    IMAGE_READ = "image_read"
    IMAGE_WRITE = "image_write"
    IMAGE_UPDATE = "image_update"  # loads and stores, or atomics
    STORAGE_READ = "storage_read"  # shader storage block
    STORAGE_WRITE = "storage_write"
    STORAGE_UPDATE = "storage_update"
    UNIFORM = "uniform"  # uniform block
    INDIRECT = "indirect"  # draw or dispatch arguments
    VERTEX = "vertex"
    INDEX = "index"
    COPY_FROM = "copy_from"
    COPY_TO = "copy_to"
    CLEAR = "clear"
    HOST_READ = "host_read"

    def __init__(self, word: str) -> None:
        # Plain attributes: the planner asks for them once an access, and hashing an enum member is slow.
        #: Whether it is a shader store or atomic, which GL orders only by ``glMemoryBarrier`` (GL 4.5, 7.13.2).
        self.incoherent = word in {"image_write", "image_update", "storage_write", "storage_update"}
        #: Whether the access can change the resource.
        self.writes = self.incoherent or word in {"color", "depth", "copy_to", "clear"}


@dataclass(frozen=True, slots=True)
class Access:
    """One declared access of a sub-pass.

    ``name`` is the shader's name for it (sampler, image or block), ``None`` for attachments, copies and the like.
    ``load`` says that content from before this sub-pass is needed: always so for reads; for writes it is what tells
    "adds to" (blend, depth test, atomics) from "replaces all". ``mip`` and ``layer`` narrow the access; ``None`` is all
    (a layered attachment, a whole array).
    """

    resource: str
    usage: Usage
    name: str | None = None
    load: bool = True
    mip: int | None = None
    layer: int | None = None
    aspect: str = "color"  # "depth" | "stencil" for sampling a depth-stencil texture
    filter: str = "nearest"  # "nearest" | "linear" | "mipmap" | "compare" (linear PCF, >= under reversed depth)
    wrap: str = "clamp"  # "clamp" | "repeat" | "border"


# ---------------------------------------------------------------- programs, state, work


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


@dataclass(frozen=True, slots=True)
class SubPass:
    """One draw, dispatch, copy or clear. ``clears`` maps an attachment's resource to the value it starts from."""

    name: str
    parent: str
    accesses: tuple[Access, ...]
    work: Work
    program: Program | None = None
    state: State = State()
    uniforms: Mapping[str, UniformValue] = field(default_factory=dict)
    clears: Mapping[str, tuple[float, float, float, float]] = field(default_factory=dict)
    position: Position | None = None


# ---------------------------------------------------------------- graph


@dataclass(frozen=True, slots=True)
class Frame:
    """The frame's constants: size in pixels, number of frames, random seed, depth convention."""

    width: int
    height: int
    count: int = 1
    seed: int = 0
    depth: str = "reversed"  # "reversed" | "standard"


@dataclass(frozen=True, slots=True)
class BarrierIntent:
    """A barrier the author wrote: between two passes or sub-passes, on a resource, of a kind."""

    resource: str
    after: str
    before: str
    kind: str
    position: Position | None = None


@dataclass(frozen=True, slots=True)
class Decision:
    """Something the compiler decided, as data: ``kind`` (expand, specialise, cull, order, alias, barrier), a stable
    ``reason`` code, the subject's name and the evidence behind it.
    """

    kind: str
    reason: str
    subject: str
    evidence: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Pass:
    """A pass of the document after expansion: its sub-passes in program order, and what it waits for by name."""

    name: str
    node: str
    subpasses: tuple[SubPass, ...]
    after: tuple[str, ...] = ()
    keep: bool = False
    position: Position | None = None


@dataclass(frozen=True, slots=True)
class Graph:
    """Everything the planner works on. ``outputs`` are the resources whose final content must exist."""

    frame: Frame
    resources: Mapping[str, Resource]
    passes: Mapping[str, Pass]
    outputs: tuple[str, ...]
    barriers: tuple[BarrierIntent, ...] | None = None  # None: the author stated none, all are derived
    features: SceneFeatures | None = None
    decisions: tuple[Decision, ...] = ()

    def _repr_html_(self) -> str:
        from rendergraph.report.notebook import graph_html

        return graph_html(self)

    def _repr_png_(self) -> bytes | None:
        from rendergraph.report.notebook import graph_picture

        return graph_picture(self)
