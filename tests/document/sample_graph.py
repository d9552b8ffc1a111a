"""A small graph, and the nodes it is made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Literal

from pydantic import model_validator

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob

GRAPH = """\
rendergraph: 1
frame: {size: [64, 32]}
resources:
  first: {format: rgba8}
passes:
  blur:
    node: blur
    read: {color: first}
    write: {color: image}
    set: {radius: 2}
outputs:
  image: {file: image.png}
"""


class BlurParams(Params):
    """Parameters of every kind."""

    radius: float = knob(..., "Reach.", unit="texels", ge=0, le=64)
    taps: int = knob(5, "Samples.", ge=1)
    mode: Literal["fast", "exact"] = knob("fast", "How.")
    offset: float | tuple[float, float] = knob(0.0, "Shift.")
    wrap: bool = knob(False, "Repeat at the border.")

    @model_validator(mode="after")
    def _odd(self) -> BlurParams:
        _ = 1 / (self.taps - 13)  # a defect of the node, for a test
        if self.mode == "exact" and self.taps % 2 == 0:
            raise ValueError("exact mode needs an odd number of taps")
        return self


class Blur(Node[BlurParams]):
    """Blurs."""

    name = "blur"
    inputs: ClassVar = {"color": Port("Source.", ("rgba8",)), "mask": Port("Where.", ("r8",), optional=True)}
    outputs: ClassVar = {"color": Port("Result.", ("rgba8",))}

    def build(self, b: Builder) -> None:
        """Nothing."""


class Open(Node[Params]):
    """Takes any ports."""

    name = "open"
    open_ports = True

    def build(self, b: Builder) -> None:
        """Nothing."""


NODES: dict[str, type[Node[Any]]] = {"blur": Blur, "open": Open}


def find_node(name: str) -> type[Node[Any]]:
    """In place of discovery; the node `broken` cannot be imported."""
    if name == "broken":
        raise ImportError("no module named 'nonsense'")
    return NODES[name]


Load = Callable[..., Document]
Fail = Callable[..., list[Diagnostic]]


def places(diagnostics: list[Diagnostic]) -> list[tuple[str, int, int]]:
    """Code, line and column of each."""
    return [(d.code, d.position.line, d.position.column) for d in diagnostics if d.position is not None]
