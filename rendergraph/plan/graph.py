"""The expanded graph: resources, and the sub-passes that touch them. Plain frozen data, the vocabulary of every phase.

A pass of the YAML expands to one or more sub-passes named ``pass.step``. A sub-pass says everything the planner must
know (its accesses) and everything the device must know (its program, state and work); nothing here executes.

The words are defined in ``resources``, ``accesses`` and ``work`` and offered from here too: one vocabulary, one import.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rendergraph.plan.accesses import Access, Usage
from rendergraph.plan.resources import BufferDesc, Kind, Position, Resource, Target, TextureDesc
from rendergraph.plan.work import (
    ADDITIVE,
    PREMULTIPLIED,
    Blend,
    ClearResource,
    CopyBuffer,
    CopyTexture,
    Dispatch,
    DispatchIndirect,
    DrawArrays,
    DrawIndirect,
    DrawScene,
    Fullscreen,
    GenerateMips,
    Program,
    State,
    UniformValue,
    Work,
)

if TYPE_CHECKING:
    from rendergraph.scene.features import SceneFeatures

__all__ = [
    "ADDITIVE",
    "PREMULTIPLIED",
    "Access",
    "BarrierIntent",
    "Blend",
    "BufferDesc",
    "ClearResource",
    "CopyBuffer",
    "CopyTexture",
    "Decision",
    "Dispatch",
    "DispatchIndirect",
    "DrawArrays",
    "DrawIndirect",
    "DrawScene",
    "Frame",
    "Fullscreen",
    "GenerateMips",
    "Graph",
    "Kind",
    "Pass",
    "Position",
    "Program",
    "Resource",
    "State",
    "SubPass",
    "Target",
    "TextureDesc",
    "UniformValue",
    "Usage",
    "Work",
]


@dataclass(frozen=True, slots=True)
class SubPass:
    """One draw, dispatch, copy or clear. ``clears`` maps an attachment's resource to the value it starts from."""

    name: str
    parent: str
    accesses: tuple[Access, ...]
    work: Work
    program: Program | None = None
    state: State = field(default_factory=State)
    uniforms: Mapping[str, UniformValue] = field(default_factory=dict)
    clears: Mapping[str, tuple[float, float, float, float]] = field(default_factory=dict)
    position: Position | None = None


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
