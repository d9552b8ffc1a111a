"""How sub-passes touch resources: the declared accesses that order, lifetimes and barriers are derived from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


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

    #: Members are single objects, so identity will do; hashing the name costs a call of Python.
    __hash__ = object.__hash__

    def __init__(self, word: str) -> None:
        # Plain attributes: the planner asks for them once an access.
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
