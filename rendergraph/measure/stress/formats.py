"""A document's targets in other formats: ``--set`` arguments for those that every connected port takes."""

from __future__ import annotations

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.load import Document
from rendergraph.node.discovery import find_node

_DEPTHS = ("d16", "d24", "d32f")
_HDR = ("r11g11b10f", "rgba16f", "rgba32f")


def depth_format(document: Document, *, format: str) -> tuple[str, ...]:
    """Depth targets (without stencil) in another format."""
    return _swapped(document, _DEPTHS, format)


def radiance_format(document: Document, *, format: str) -> tuple[str, ...]:
    """Float colour targets of three and four channels in another format."""
    return _swapped(document, _HDR, format)


def depth_convention(document: Document, *, depth: str, format: str = "") -> tuple[str, ...]:
    """The other depth convention, with another depth format where one is given; only where depth is stored."""
    if not any(_depth(r.format) for r in document.model.resources.values()):
        return ()
    return (f"frame.depth={depth}", *(depth_format(document, format=format) if format else ()))


def _depth(format: str | None) -> bool:
    return format is not None and FORMATS[format].depth


def _swapped(document: Document, among: tuple[str, ...], format: str) -> tuple[str, ...]:
    return tuple(
        f"resources.{name}.format={format}"
        for name, resource in document.model.resources.items()
        if resource.format in among and resource.format != format and accepted(document, name, format)
    )


def accepted(document: Document, resource: str, format: str) -> bool:
    """Whether every port that the resource is connected to takes a format."""
    for model in document.model.passes.values():
        node = find_node(model.node)
        for ports, connected in ((node.inputs, model.read), (node.outputs, model.write)):
            for port, name in connected.items():
                declared = ports.get(port)
                if name == resource and declared is not None and declared.formats and format not in declared.formats:
                    return False
    return True


def holds_floats(format: str) -> bool:
    """Whether texels of a format can be NaN or infinite; depth cannot."""
    row = FORMATS[format]
    return row.channel is Channel.FLOAT and not row.depth
