"""`rg fuzz`: random legal orders x poisoned transients x sharing x specialisation, which must all give one image.

What differs is made as small as it gets, and traced to the sub-pass, resource and texel where it begins.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from rendergraph.device.context import Device, open_device
from rendergraph.device.texels import POISONS
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.fuzz_minimise import minimise
from rendergraph.measure.fuzz_run import USUAL, FuzzCase, Images, TestBed
from rendergraph.measure.fuzz_trace import Culprit, find_culprit
from rendergraph.plan.compile import PlanError

Progress = Callable[[str, int, int], None]

#: Without a size of its own a graph is run this large at the most: what fuzzing finds does not hang on the size.
MOST_PIXELS_A_SIDE: Final = 256
MOST_FRAMES: Final = 3


@dataclass(frozen=True, slots=True)
class FuzzOptions:
    """``orders`` random legal orders beside the usual one, from ``seed`` on. ``size`` is the frame's, by default the
    file's, shrunk to 256 pixels a side; ``frames`` by default the file's, at most 3.
    """

    orders: int = 4
    seed: int = 0
    size: tuple[int, int] | None = None
    frames: int | None = None
    scene: str | None = None
    device: int | None = None


@dataclass(frozen=True, slots=True)
class Failure:
    """The smallest case whose image differs. ``guilty`` are its dimensions: without any one of them it does not fail;
    none at all where equal runs differ. ``output`` first differs in ``frame``. ``error`` is what a run ended with,
    where there is no image.
    """

    case: FuzzCase
    guilty: tuple[str, ...]
    swaps: tuple[tuple[str, str], ...] = ()
    output: str = ""
    frame: int = 0
    culprit: Culprit | None = None
    error: str = ""


@dataclass(frozen=True, slots=True)
class FuzzReport:
    """``runs`` cases were run, in ``orders`` different orders; ``failed`` of them differed."""

    runs: int
    orders: int
    size: tuple[int, int]
    frames: int
    failed: int = 0
    failure: Failure | None = None


def fuzz_document(
    document: Document, options: FuzzOptions | None = None, progress: Progress = lambda stage, done, total: None
) -> FuzzReport:
    """Run every variation and compare all outputs of all frames, bit for bit, with the usual run.

    :raises RenderGraphError: for the mistakes of the document, and what the usual run itself ends with.
    """
    options = options or FuzzOptions()
    model = document.model.frame
    size = options.size or shrunk(model.size)
    frames = options.frames or min(model.count, MOST_FRAMES)
    device: Device = open_device(options.device)
    with TestBed(document, device, size, frames, options.scene).closed() as bed:
        expected = bed.images(USUAL)
        cases = list(_cases(bed, options))
        failing: list[FuzzCase] = []
        orders = set()
        for done, case in enumerate(cases):
            progress("running variations", done, len(cases))
            if first_difference(bed, case, expected) is not None:
                failing.append(case)
            else:
                orders.add(tuple(step.name for step in bed.plan(case).order))
        report = FuzzReport(len(cases), len(orders), size, frames)
        if not failing:
            return report
        progress("reducing the failure", 0, 1)
        failure = _explain(bed, failing[0], expected)
        return FuzzReport(len(cases), len(orders), size, frames, len(failing), failure)


def shrunk(size: tuple[int, int]) -> tuple[int, int]:
    """A frame's size, scaled down to fit."""
    scale = min(1.0, MOST_PIXELS_A_SIDE / max(size))
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def _cases(bed: TestBed, options: FuzzOptions) -> Iterator[FuzzCase]:
    """All combinations, those with the fewest dimensions varied first; the usual one again begins. Orders that are the
    usual one, or another's, are left out.
    """
    chance = random.Random(options.seed)
    found = []
    for full in (False, True):
        known = {tuple(step.name for step in bed.plan(FuzzCase(full=full)).order)}
        orders: list[int | None] = [None]
        for seed in (chance.randrange(1 << 32) for _ in range(options.orders)):
            order = tuple(step.name for step in bed.plan(FuzzCase(order=seed, full=full)).order)
            if order not in known:
                known.add(order)
                orders.append(seed)
        found += [
            FuzzCase(order, poison, alias, full)
            for order in orders
            for alias in (True, False)
            for poison in (None, *POISONS)
        ]
    yield from sorted(found, key=lambda case: len(case.varied))


def first_difference(bed: TestBed, case: FuzzCase, expected: Images) -> tuple[str, int, str] | None:
    """The first frame's output that differs, and what the run ended with; ``None`` when all are the same."""
    try:
        images = bed.images(case)
    except (RenderGraphError, PlanError) as error:
        return "", 0, str(error)
    for frame in range(bed.frames):
        for name in images:
            one, other = expected[name][frame], images[name][frame]
            if one.dtype != other.dtype or one.shape != other.shape or one.tobytes() != other.tobytes():
                return name, frame, ""
    return None


def _explain(bed: TestBed, case: FuzzCase, expected: Images) -> Failure:
    smallest = minimise(bed, case, lambda tried: first_difference(bed, tried, expected) is not None)
    found = first_difference(bed, smallest.case, expected)
    if found is None:  # it failed before: runs of one plan differ among themselves
        return Failure(smallest.case, ())
    output, frame, error = found
    culprit = None if error else find_culprit(bed, USUAL, smallest.case, output, frame)
    return Failure(smallest.case, smallest.case.varied, smallest.swaps, output, frame, culprit, error)
