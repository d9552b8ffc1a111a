"""Options that several commands take, declared once."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import Annotated

import typer


class Format(StrEnum):
    """How data is printed."""

    TEXT = "text"
    JSON = "json"


class Order(StrEnum):
    """Which of the legal orders the passes run in."""

    DEFAULT = "default"
    MEMORY = "memory"
    RANDOM = "random"


GraphArgument = Annotated[str, typer.Argument(metavar="GRAPH", help="A graph file, or a shipped graph's name.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Override a value: passes.occlude.set.radius=2 (repeatable)."),
]
SceneOption = Annotated[
    str | None,
    typer.Option(
        "--scene", metavar="SOURCE", help="Draw this scene instead: atrium, cornell, spheres or a .gltf/.glb file."
    ),
]
SizeOption = Annotated[str | None, typer.Option("--size", metavar="WxH", help="Frame size in pixels, as 640x360.")]
FramesOption = Annotated[int | None, typer.Option("--frames", min=1, max=10000, help="Frames to render.")]
FormatOption = Annotated[Format, typer.Option("--format", help="How to print.")]
FullOption = Annotated[bool, typer.Option("--full", help="Do not specialise on the scene: build every variant.")]
NoAliasOption = Annotated[bool, typer.Option("--no-alias", help="Give every target memory of its own.")]
NoCullOption = Annotated[bool, typer.Option("--no-cull", help="Run passes that nothing reads.")]
OrderOption = Annotated[
    Order, typer.Option("--order", help="Pass order; memory searches for the smallest peak, random takes --order-seed.")
]
SeedOption = Annotated[int, typer.Option("--order-seed", min=0, help="Seed of the random order.")]


def parse_size(text: str | None) -> tuple[int, int] | None:
    """``"640x360"`` as a pair. Raises ``typer.BadParameter``."""
    from rendergraph.document.field_types import MAX_SIZE

    if text is None:
        return None
    match = re.fullmatch(r"([0-9]{1,9})[xX]([0-9]{1,9})", text)
    if match is None:
        raise typer.BadParameter(f"{text!r} is not WIDTHxHEIGHT, as 640x360", param_hint="--size")
    size = int(match[1]), int(match[2])
    if not all(1 <= extent <= MAX_SIZE for extent in size):
        raise typer.BadParameter(f"{text}: each side must be 1 to {MAX_SIZE} pixels", param_hint="--size")
    return size
