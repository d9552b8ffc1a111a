"""How to run a document."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from rendergraph.device.context import Device
from rendergraph.device.texels import Poison
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument
from rendergraph.run.result import Pixels
from rendergraph.run.runner import Inspect

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class RenderOptions:
    """How to run a document. ``size``, ``frames`` and ``scene`` replace the file's own; ``samples`` is the number of
    extra frames timed after the images are taken. ``inspect`` is called with every texture of
    one more frame, so that reading them back disturbs no figure. ``take_frame`` is handed the file name and pixels of
    every ``{frame}`` output as soon as it is there, and the result keeps none of them: a long run needs no more memory
    than a short one, and an interrupted one has written what it finished. ``afterwards`` is called with the plan and
    the device once all figures are taken.
    """

    size: tuple[int, int] | None = None
    frames: int | None = None
    samples: int = 5
    scene: str | None = None
    captures: tuple[str, ...] = ()
    inspect: Inspect | None = None
    take_frame: Callable[[str, Pixels], None] | None = None
    afterwards: Callable[[PlannedDocument, Device], None] | None = None
    poison: bool | Poison = False
    full: bool = False
    check_finite: bool = False
    device: int | None = None
    plan: PlanOptions = field(default_factory=PlanOptions)
