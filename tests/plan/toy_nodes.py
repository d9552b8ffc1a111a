"""Small nodes for tests of expansion, and what makes the loader and expansion see them."""

# ruff: noqa: RUF012 (a node's ports are class attributes)

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rendergraph.document import node_checks
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.node import discovery
from rendergraph.node.bindings import color, sample, store_image
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.discovery import find_node
from rendergraph.node.params import GraphFile, Params, knob
from rendergraph.plan import build_passes
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import Decision, Graph

HERE = Path(__file__).resolve().parent


class Maker(Node[Params]):
    """Writes one colour texture."""

    outputs = {"color": Port("Colour.", formats=("rgba16f", "rgba8"))}

    def build(self, b: Builder) -> None:
        b.raster("draw", b.program("make.frag"), color=[color(b.output("color"))])


class Filter(Node[Params]):
    """Colour to colour of one size; a buffer if connected."""

    inputs = {
        "color": Port("Colour.", formats=("rgba16f", "rgba8")),
        "table": Port("A table.", buffer=True, optional=True),
    }
    outputs = {"color": Port("Colour.", formats=("rgba16f", "rgba8"), like="color")}

    def build(self, b: Builder) -> None:
        bind = {"u_color": sample(b.input("color"))}
        b.raster("draw", b.program("filter.frag"), color=[color(b.output("color"))], bind=bind)


class Over(Node[Params]):
    """Draws over what is there."""

    inputs = {"color": Port("Colour.", formats=("rgba16f",), optional=True)}
    outputs = {"color": Port("Colour.", formats=("rgba16f",), modify=True)}

    def build(self, b: Builder) -> None:
        b.raster("draw", b.program("over.frag"), color=[color(b.output("color"), load=True)])


class Layered(Node[Params]):
    """Takes four layers and four samples."""

    inputs = {
        "layers": Port("Four layers.", formats=("rgba16f",), layers=4, optional=True),
        "samples": Port("Four samples.", formats=("rgba16f",), samples=(4,), optional=True),
    }
    outputs = {"color": Port("Colour.", formats=("rgba16f",))}

    def build(self, b: Builder) -> None:
        b.raster("draw", b.program("x.frag"), color=[color(b.output("color"))])


class Inner(Node[Params]):
    """Has an internal target, and another where the scene has masked geometry."""

    outputs = {"color": Port("Colour.", formats=("rgba16f",))}

    def build(self, b: Builder) -> None:
        half = b.texture("half", "rgba16f", scale=0.5)
        b.raster("down", b.program("x.frag"), color=[color(half)])
        if b.requires("masked", "cut"):
            cut = b.texture("cut", "r8")
            b.raster("cut", b.program("x.frag"), color=[color(cut)])
        b.raster("up", b.program("x.frag"), color=[color(b.output("color"))], bind={"u_half": sample(half)})


class PeekParams(Params):
    """Files, in every shape a parameter may hold them."""

    file: GraphFile | None = knob(None, "One.")
    table: dict[str, GraphFile] = knob({}, "Several.")


class Peek(Node[PeekParams]):
    """Reads two textures of any size."""

    inputs = {name: Port("Colour.", formats=("rgba16f", "r8"), optional=True) for name in ("a", "b")}
    outputs = {"color": Port("Colour.", formats=("rgba16f",))}

    def build(self, b: Builder) -> None:
        bind = {f"u_{port}": sample(b.input(port)) for port in b.inputs}
        b.raster("draw", b.program("x.frag"), color=[color(b.output("color"))], bind=bind)


class NeedsScene(Maker):
    """Reads lights."""

    needs_scene = True


class Raises(Maker):
    """A defect."""

    def build(self, b: Builder) -> None:
        raise ZeroDivisionError("division by zero")


class WritesNothing(Maker):
    """A defect."""

    def build(self, b: Builder) -> None:
        pass


class WritesInput(Filter):
    """A defect."""

    def build(self, b: Builder) -> None:
        b.clear("input", b.input("color"))
        super().build(b)


class Trespasser(Maker):
    """A defect."""

    def build(self, b: Builder) -> None:
        super().build(b)
        b.raster("far", b.program("x.frag"), color=[color("elsewhere")])


class StoresWrongly(Maker):
    """Stores into whatever it is given, on a level that may not exist."""

    outputs = {"color": Port("Colour.", formats=("srgb8_a8", "rgba8"))}

    def build(self, b: Builder) -> None:
        bind = {"u_out": store_image(b.output("color"), mip=1)}
        b.compute("store", b.program("x.comp"), (1, 1, 1), bind=bind)


TOYS: dict[str, type[Node[Any]]] = {
    "toy_maker": Maker, "toy_filter": Filter, "toy_over": Over, "toy_layered": Layered, "toy_inner": Inner,
    "toy_peek": Peek, "toy_scene": NeedsScene, "toy_raises": Raises, "toy_writes_nothing": WritesNothing,
    "toy_writes_input": WritesInput, "toy_trespasser": Trespasser, "toy_stores": StoresWrongly,
}  # fmt: skip


def _find(name: str) -> type[Node[Any]]:
    if name not in TOYS:
        return find_node(name)
    TOYS[name].name, TOYS[name].folder = name, HERE
    return TOYS[name]


def install_toys(patch: pytest.MonkeyPatch) -> None:
    """Let graphs name the nodes above."""
    known = (*node_checks.node_names(), *TOYS)
    patch.setattr(node_checks, "node_names", lambda: known)
    patch.setattr(discovery, "find_node", _find)
    patch.setattr(build_passes, "find_node", _find)
    discovery.try_node.cache_clear()


def write(folder: Path, text: str) -> Document:
    """A document from text, loaded as a user's file would be."""
    path = folder / "graph.yaml"
    path.write_text("rendergraph: 1\n" + text, encoding="utf-8")
    return load_document(path)


def codes(folder: Path, text: str, **options: Any) -> list[str]:
    """The codes of the errors, in file order; warnings' codes when there are none."""
    try:
        return [found.code for found in expand(write(folder, text), **options)[1]]
    except RenderGraphError as error:
        return [found.code for found in error.diagnostics]


def graph(folder: Path, text: str, **options: Any) -> Graph:
    """The expanded graph."""
    return expand(write(folder, text), **options)[0]


def reasons(decisions: tuple[Decision, ...], subject: str) -> set[str]:
    """Reason codes on a subject."""
    return {d.reason for d in decisions if d.subject == subject}
