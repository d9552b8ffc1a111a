"""What a node is: typed ports, parameters, and a ``build`` that adds sub-passes without OpenGL."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar, get_args

from rendergraph.node.params import Params
from rendergraph.node.reference import Extreme, Reference

if TYPE_CHECKING:
    from rendergraph.node.builder import Builder


ParamsT = TypeVar("ParamsT", bound=Params)


@dataclass(frozen=True, slots=True)
class Port:
    """A typed connection of a node.

    ``formats`` lists what the port takes, the preferred one first (an undeclared output resource gets it); empty for a
    buffer. With both ``formats`` and ``buffer`` the port takes either. ``like`` names another port whose size this one
    must have. ``modify`` marks an output that adds to what the resource already holds. ``layers``: exact number of
    layers, ``None`` for any. ``holds`` says what an output contains, in a word that nodes agree on (``scene_depth``,
    ``emission``, ``materials``, ``sun_shadow``): a node that reads it may rely on it (``Builder.holds``).
    """

    help: str
    formats: tuple[str, ...] = ()
    buffer: bool = False
    optional: bool = False
    modify: bool = False
    like: str | None = None
    samples: tuple[int, ...] = (1,)
    layers: int | None = 1
    holds: str = ""


class Node(ABC, Generic[ParamsT]):
    """Base class of every node: ``class Blur(Node[BlurParams])`` in ``nodes/blur/__init__.py``, found by its folder.

    ``open_ports`` nodes take any port name, for users' own shaders. ``needs_scene`` nodes draw geometry or read lights.
    ``reference`` names the truth that its outputs are held against, ``exact`` nodes have none to approximate: their
    outputs equal it. ``bounds`` are the least and largest value that an output port may ever hold, and ``extremes`` the
    cases beyond the common ones (measure/stress) that it must survive. ``accuracy_axes`` are what of the node's own
    graph trades accuracy beside its knobs, as ``rg sweep --over`` takes it (``resources.hdr.format=rgba16f|rgba32f``),
    with the measure whose error it lowers. ``exempt`` are demands of the conformance suite that the node does not meet,
    each with the reason, which reports show.
    """

    name: ClassVar[str] = ""  # set by discovery to the folder's name
    folder: ClassVar[Path] = Path()  # set by discovery
    inputs: ClassVar[Mapping[str, Port]] = {}
    outputs: ClassVar[Mapping[str, Port]] = {}
    params_type: ClassVar[type[Params]] = Params  # set from the type argument
    open_ports: ClassVar[bool] = False
    needs_scene: ClassVar[bool] = False
    reference: ClassVar[Reference | None] = None
    exact: ClassVar[bool] = False
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {}
    extremes: ClassVar[tuple[Extreme, ...]] = ()
    accuracy_axes: ClassVar[Mapping[str, str]] = {}
    exempt: ClassVar[Mapping[str, str]] = {}

    def __init__(self, params: ParamsT) -> None:
        self.params = params

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        for base in getattr(cls, "__orig_bases__", ()):
            for argument in get_args(base):
                if isinstance(argument, type) and issubclass(argument, Params):
                    cls.params_type = argument

    def modifies(self, port: str) -> bool:
        """Whether an output keeps content from before: by its declaration, or by parameters where ports are open."""
        return port in self.outputs and self.outputs[port].modify

    @abstractmethod
    def build(self, b: Builder) -> None:
        """Add this node's sub-passes to ``b``. Runs without OpenGL and without numpy; must be deterministic."""

    @classmethod
    def summary(cls) -> str:
        """The first line of the class's docstring."""
        return (cls.__doc__ or "").strip().partition("\n")[0]
