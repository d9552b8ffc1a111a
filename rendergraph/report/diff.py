"""Compares two records: exact quantities exactly, times by statistics, images by metric."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.measure.statistics import (
    LEAST_COMPARED,
    Change,
    Thresholds,
    Verdict,
    compare_blocks,
    compare_runs,
)
from rendergraph.report.diff_counts import common_steps, compare_bounds, compare_counts, compare_passes
from rendergraph.report.diff_errors import compare_errors
from rendergraph.report.diff_exact import Direction, ExactChange, compare_resources, worst_first
from rendergraph.report.diff_images import TOLERANCE, ImageChange, compare_image_files
from rendergraph.report.diff_names import Matching, match_passes
from rendergraph.report.read_records import Record, Times, read_pair, read_record
from rendergraph.report.record_models import AccuracyRecord

#: The name of the whole frame among the passes; no pass can have it.
FRAME: Final = ""
GATES: Final = ("exact", "time", "all")


@dataclass(frozen=True, slots=True)
class DiffOptions:
    """How to compare. ``image_tolerance`` is a root mean square error in shares of the full range."""

    thresholds: Thresholds = field(default_factory=Thresholds)
    image_tolerance: float = TOLERANCE
    force: bool = False


@dataclass(frozen=True, slots=True)
class TimeChange:
    """The time of a pass, a sub-pass (``pass.step``), or the whole frame (name ``FRAME``), before and after."""

    name: str
    node: str
    change: Change


@dataclass(frozen=True, slots=True)
class Comparison:
    """Everything found, worst first. ``compared`` says what both records hold: exact, time, images."""

    before: str
    after: str
    compared: frozenset[str]
    exact: tuple[ExactChange, ...]
    times: tuple[TimeChange, ...]
    images: tuple[ImageChange, ...]
    options: DiffOptions
    warnings: tuple[Diagnostic, ...] = ()

    def regressions(self, gate: str = "all") -> list[ExactChange | TimeChange | ImageChange]:
        """What fails the gate: ``exact`` (images too: same graph, same machine, same texels), ``time`` or ``all``."""
        found: list[ExactChange | TimeChange | ImageChange] = []
        if gate != "time":
            found += [change for change in self.exact if change.direction is Direction.WORSE]
            found += [change for change in self.images if change.worse]
        if gate != "exact":
            found += [entry for entry in self.times if entry.change.verdict is Verdict.SLOWER]
        return found


def diff_records(before: str, after: str | None = None, options: DiffOptions | None = None) -> Comparison:
    """Compare two records by their paths, or the two sides of one bench file.

    :raises RenderGraphError: RG730 to RG735 (no sound record), RG736 (measured under other conditions), RG737 (nothing
        to compare), RG563 (a broken image).
    """
    options = options or DiffOptions()
    if after is None:
        a, b = read_pair(before)
        return compare_records(a, b, options, paired=True)
    return compare_records(read_record(before), read_record(after), options)


def require_gate(comparison: Comparison, gate: str) -> None:
    """Refuse a gate that nothing can fail: it would let everything through. Raises RenderGraphError RG737."""
    judged = {"exact": {"exact", "images"}, "time": {"time"}, "all": {"exact", "images", "time"}}[gate]
    if not comparison.compared & judged:
        reason = f"the records hold nothing for the gate '{gate}'"
        hint = f"they hold {', '.join(sorted(comparison.compared))}: choose another --gate, or give other records"
        raise RenderGraphError([diagnose("RG737", name=comparison.before, reason=reason, hint=hint)], exit_code=2)


def compare_records(a: Record, b: Record, options: DiffOptions, *, paired: bool = False) -> Comparison:
    """Compare two records; ``paired`` when their runs are interleaved blocks. Raises as :func:`diff_records`."""
    compared = _common(a, b)
    warnings = _check_setup(a, b, force=options.force)
    times: list[TimeChange] = []
    exact: list[ExactChange] = []
    names = Matching({}, (), ())
    if a.times and b.times:
        names = match_passes(_nodes(a.times), _nodes(b.times))
        exact += [*compare_passes(names), *compare_counts(a.times, b.times, names), *compare_bounds(a.times, b.times)]
        times = _compare_times(a.times, b.times, names, options.thresholds, paired=paired)
        warnings += _too_few(times, paired=paired)
    if a.resources and b.resources:
        exact += compare_resources(a.resources, b.resources, names)
    if a.accuracy and b.accuracy:
        if not (a.times and b.times):
            names = match_passes(_judged_nodes(a.accuracy), _judged_nodes(b.accuracy))
        exact += compare_errors(a.accuracy, b.accuracy, names)
    images = compare_image_files(a.images, b.images, options.image_tolerance) if "images" in compared else []
    return Comparison(
        a.name,
        b.name,
        frozenset(compared),
        tuple(sorted(exact, key=worst_first)),
        tuple(sorted(times, key=_slowest_first)),
        tuple(images),
        options,
        tuple(warnings),
    )


def _common(a: Record, b: Record) -> set[str]:
    compared = set()
    if a.times and b.times:
        compared |= {"time", "exact"}
    if a.resources and b.resources:
        compared.add("exact")
    if a.accuracy and b.accuracy:
        compared.add("exact")
    if a.images and b.images:
        compared.add("images")
    if not compared & {"time", "exact"}:
        reason = f"'{b.name}' holds other kinds of records"
        hint = "compare two folders, two records of a kind, or bench files"
        raise RenderGraphError([diagnose("RG737", name=a.name, reason=reason, hint=hint)], exit_code=2)
    return compared


def _check_setup(a: Record, b: Record, *, force: bool) -> list[Diagnostic]:
    """Refuse what was measured under other conditions; only say so under ``force``."""
    before, after = _setup(a, b), _setup(b, a)
    fields = [name for name in before if before[name] != after[name]]
    if not fields:
        return []
    details = "; ".join(f"{name} '{before[name]}' and '{after[name]}'" for name in fields)
    found = diagnose("RG739" if force else "RG736", fields=", ".join(fields), details=details)
    if not force:
        raise RenderGraphError([found], exit_code=2)
    return [found]


def _setup(record: Record, other: Record) -> dict[str, str]:
    if record.times and other.times:
        return record.times.setup
    if record.accuracy and other.accuracy:  # rasterisers round differently
        device = record.accuracy.device
        return {"renderer": device.renderer, "driver": device.driver, "size": _extent(record.accuracy.size)}
    assert record.resources is not None
    return {"size": _extent(record.resources.size)}


def _extent(size: list[int]) -> str:
    return "x".join(str(extent) for extent in size)


def _nodes(times: Times) -> dict[str, str]:
    return {name: entry.node for name, entry in times.passes.items()}


def _judged_nodes(record: AccuracyRecord) -> dict[str, str]:
    return {entry.name: entry.node for entry in record.passes}


def _compare_times(a: Times, b: Times, names: Matching, thresholds: Thresholds, *, paired: bool) -> list[TimeChange]:
    """All in one family of tests: a pass and its sub-passes are several chances of one false alarm."""
    steps = common_steps(a, b, names)
    before = {FRAME: a.frame, **{names.after_name(name): entry.runs for name, entry in a.passes.items()}}
    before |= {after: a.steps[name].runs for name, after in steps.items()}
    after = {FRAME: b.frame, **{name: entry.runs for name, entry in b.passes.items()}}
    after |= {name: b.steps[name].runs for name in steps.values()}
    changes = (compare_blocks if paired else compare_runs)(before, after, thresholds)
    nodes = {FRAME: "", **_nodes(b), **{name: b.steps[name].node for name in steps.values()}}
    return [TimeChange(name, nodes[name], change) for name, change in changes.items()]


def _too_few(times: list[TimeChange], *, paired: bool) -> list[Diagnostic]:
    """One warning for all that have too few samples: they have them in common."""
    few = [entry for entry in times if entry.change.reason in ("no_samples", "too_few_samples")]
    if not few:
        return []
    least = min(entry.change.compared for entry in few)
    what = "everything" if len(few) == len(times) else ", ".join(entry.name or "the whole frame" for entry in few)
    unit = ("paired block" if paired else "sample") + ("s" if least != 1 else "")
    return [diagnose("RG738", name=what, samples=least, unit=unit, least=LEAST_COMPARED)]


_VERDICTS: Final = tuple(Verdict)


def _slowest_first(entry: TimeChange) -> tuple[int, float, str]:
    return _VERDICTS.index(entry.change.verdict), -(entry.change.relative or 0.0), entry.name
