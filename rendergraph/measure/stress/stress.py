"""`rg stress`: tries a target at every extreme, in a process of its own, so that a driver's crash costs one extreme."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rendergraph.document.load import Document
from rendergraph.measure.stress.case import Case
from rendergraph.measure.stress.cases import cases_of
from rendergraph.measure.stress.outcome import CaseOutcome
from rendergraph.measure.stress.process import StressJob, try_in_process
from rendergraph.measure.stress.target import StressTarget, find_target, frame_size, load_target

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class StressOptions:
    """``only`` names extremes (none: all). ``size`` is the frame's where the extreme does not set it. ``isolate``: in a
    child process, a new one only after a crash or after ``timeout`` seconds for one extreme: that costs one start of
    Python and of the driver in all, so it is the default.
    """

    only: tuple[str, ...] = ()
    overrides: tuple[str, ...] = ()
    size: tuple[int, int] | None = None
    device: int | None = None
    isolate: bool = True
    timeout: float = 300.0


@dataclass(frozen=True, slots=True)
class StressReport:
    """``size`` is the frame's where the extreme does not set it."""

    target: StressTarget
    document: Document
    size: tuple[int, int]
    cases: tuple[CaseOutcome, ...]
    renderer: str
    driver: str

    @property
    def failed(self) -> tuple[CaseOutcome, ...]:
        """Extremes in which something is wrong."""
        return tuple(case for case in self.cases if case.failed)


def stress(
    target: str, options: StressOptions | None = None, progress: Progress = lambda stage, done, total: None
) -> StressReport:
    """Try a graph, or a node on its own graph, at the extremes.

    :raises RenderGraphError: RG768, RG769 and RG771 for names that are not known, RG770 where no process can be
        started, and what loading the graph raises. What goes wrong at an extreme is in the report.
    """
    options = options or StressOptions()
    found = find_target(target)
    document = load_target(found, options.overrides)
    cases = cases_of(found, document, options.only)
    size = options.size or frame_size(document)
    outcomes = []
    facts = ("", "")
    for event in _events(found, cases, options, size, progress):
        if isinstance(event, CaseOutcome):
            outcomes.append(event)
        else:
            facts = event
    return StressReport(found, document, size, tuple(outcomes), *facts)


def _events(
    target: StressTarget,
    cases: tuple[Case, ...],
    options: StressOptions,
    size: tuple[int, int],
    progress: Progress,
) -> Iterator[CaseOutcome | tuple[str, str]]:
    if options.isolate:
        job = StressJob(
            str(target.file), target.node, target.own, options.overrides, size, options.device, options.timeout
        )
        yield from try_in_process(job, cases, progress)
        return
    from rendergraph.device.context import open_device
    from rendergraph.measure.stress.try_case import Bench
    from rendergraph.measure.truth.cache import open_cache

    device = open_device(options.device)
    yield device.info.renderer, device.info.driver
    bench = Bench(target, options.overrides, size, device, open_cache())
    for index, case in enumerate(cases):
        progress(case.name, index, len(cases))
        yield bench.attempt(case)
