"""An extreme made ready to run: what the contract says of it, and what is done to frame, scene and inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from rendergraph.node.reference import Extreme

if TYPE_CHECKING:
    from rendergraph.document.load import Document
    from rendergraph.scene.load import LoadedScene

#: What is checked of every pass, in the order of the report. Driver errors and exceptions end the whole run instead.
CHECKS: Final = {
    "finite": "every value of a float output is finite",
    "bounded": "outputs keep the bounds that the node declares",
    "energy": "no more light leaves than arrived",
    "invariants": "what the node says must always hold",
    "error": "the error is within what the node's reference allows",
}


@dataclass(frozen=True, slots=True)
class Case:
    """One extreme. ``common`` ones are tried on every graph, others are a node's own.

    ``size`` is the frame's; ``edit`` changes the scene; ``swap`` gives ``--set`` arguments for the document (none: the
    extreme does not apply); ``inject`` is written into texels of every float input right before each pass; ``light`` is
    the largest radiance that the scene's light allows. ``skips`` are checks left out, by node and check, with reasons.
    """

    extreme: Extreme
    common: bool = True
    size: tuple[int, int] | None = None
    edit: Callable[[LoadedScene], LoadedScene] | None = None
    swap: Callable[[Document], tuple[str, ...]] | None = None
    inject: float | None = None
    light: float | None = None
    skips: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The extreme's."""
        return self.extreme.name
