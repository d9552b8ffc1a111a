"""What a node's page says of its accuracy, its speed for it, and the extremes: measured, as Markdown."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

from rendergraph.conformance.knobs import MORE_SIZES, SIZE, Line, settled
from rendergraph.conformance.quality_axes import QualityAxis, quality_axes
from rendergraph.conformance.subject import Subject
from rendergraph.measure.stress.outcome import CaseOutcome, PassOutcome
from rendergraph.measure.sweep.outcome import sweep_outcome
from rendergraph.measure.sweep.run import Sweep, new_job
from rendergraph.report.sweep import sweep_record
from rendergraph.report.sweep_png import write_sweep_png

PLOT_SIZE: Final = (320, 180)


def measured(name: str, folder: Path) -> str:
    """All tables of a node; the plot is written below ``folder``."""
    subject = Subject(name)
    parts = [*_accuracy(subject), *_along(subject), *_front(subject, folder), *_extremes(subject)]
    return "\n\n".join(parts)


def _number(value: float | None, unit: str = "") -> str:
    text = "0" if value is None else f"{value:.3g}"
    return f"{text} {unit}".strip()


def _accuracy(subject: Subject) -> Iterator[str]:
    renderer = subject.device.info.renderer
    yield "## Accuracy"
    yield (
        f"Measured on {renderer}, in `graphs/{subject.name}.yaml` at {SIZE[0]} x {SIZE[1]}, procedural scenes at their "
        "least detail. *Known* is the share of texels whose truth is known."
    )
    rows = ["| Pass | Measure | Metric | Error | Stated | Known | Held against |", "|---|---|---|---|---|---|---|"]
    for entry in subject.judge(subject.document, SIZE):
        for one in entry.judgements:
            known = one.verdict != "cannot_judge"
            error = _number(one.value, one.unit) if known else "not known in this graph"
            share = f"{100 * (1 - one.masked):.3g} %" if known else "0"
            against = "the ideal" if one.ideal else "the same algorithm"
            rows.append(
                f"| `{entry.name}` | `{one.measure}` | {one.metric} | {error} | {_number(one.tolerance, one.unit)} "
                f"| {share} | {against}, {one.method} |"
            )
    yield "\n".join(rows)


def _along(subject: Subject) -> Iterator[str]:
    axes = list(quality_axes(subject))
    if not axes:
        return
    rows = [
        "| Along | Error | " + " | ".join(f"{k}" for k in ("cheap", "", "accurate")) + " |",
        "|---|---|---|---|---|",
    ]
    for axis in axes:
        for line in settled(subject, axis):
            if line.shape not in ("flat", "unknown"):
                rows.append(_row(axis, line))
    yield "### What buys it"
    yield (
        "Errors along each quality knob, and along formats and sizes of the graph that trade accuracy; where one image "
        f"does not show which way they go, the mean over {1 + len(MORE_SIZES)} sizes of the frame."
    )
    yield "\n".join(rows)


def _row(axis: QualityAxis, line: Line) -> str:
    cells = [f"{value}: {_number(error, line.unit)}" for value, error in zip(axis.values, line.values, strict=True)]
    while len(cells) < 3:
        cells.insert(-1, "")
    return f"| `{axis.name}` | `{line.pass_name}.{line.measure}` {line.metric} | " + " | ".join(cells) + " |"


def _front(subject: Subject, folder: Path) -> Iterator[str]:
    """A sweep over the axes that move one measure, with its plot."""
    axes = list(quality_axes(subject))
    if not axes:
        return
    measures = subject.node.reference.measures if subject.node.reference else {}
    ideal = next((key for key, measure in measures.items() if measure.ideal), "")
    group = [axis for axis in axes if (axis.measure or ideal) == (axes[0].measure or ideal)]
    lines = [line for axis in group for line in settled(subject, axis) if line.shape != "unknown"]
    falling = next((line for line in lines if line.shape == "falls"), lines[0])
    over = [_over(axis, alone=len(group) == 1) for axis in group]
    detail = [o for o in ("scene.detail=0",) if subject.document.model.scene is not None]
    job = new_job(str(subject.target.file), overrides=tuple(detail), size=PLOT_SIZE, frames=3, rounds=16)
    sweep = Sweep(job, over=over, error=f"{falling.pass_name}.{falling.measure}")
    with tempfile.TemporaryDirectory() as scratch:
        sweep.run(Path(scratch) / "sweep")
    record = sweep_record(sweep, sweep_outcome(sweep))
    plots = folder / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    write_sweep_png(plots / f"{subject.name}.png", record)
    yield "### Time for error"
    yield (
        f"![Error over time of each setting, the front marked](plots/{subject.name}.png)\n\n"
        f"`rg sweep {subject.name} --over {','.join(over)}` at {PLOT_SIZE[0]} x {PLOT_SIZE[1]}: the settings that no "
        "other beats in both time and error. Times are of the whole frame, relative to the graph as it is written; in "
        "software they are other than on a GPU."
    )
    front = sorted((p for p in record["points"] if p["front"]), key=lambda p: p["error"] or 0.0)
    rows = ["| Setting | Time | Error |", "|---|---|---|"]
    for point in front:
        setting = ", ".join(_short(override) for override in point["set"])
        rows.append(f"| `{setting}` | {_relative(point)} | {_number(point['error'])} |")
    yield "\n".join(rows)


def _short(override: str) -> str:
    """`passes.light.set.taps=3` as `taps=3`; other paths whole."""
    path, _, value = override.partition("=")
    return f"{path.rpartition('.')[2] if path.startswith('passes.') else path}={value}"


def _relative(point: dict[str, Any]) -> str:
    relative = point["relative"]
    return "1" if relative is None else f"{relative['estimate']:.2f} ({relative['low']:.2f} to {relative['high']:.2f})"


def _over(axis: QualityAxis, *, alone: bool) -> str:
    first = axis.paths[0]
    name = first.removeprefix("passes.").replace(".set.", ".") if first.startswith("passes.") else first
    numbers = alone and first.startswith("passes.") and all(_is_number(value) for value in axis.values)
    values = "" if numbers else "=" + "|".join(axis.values)
    return f"{name}{values}"


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).replace("-", "", 1).isdecimal()


def _extremes(subject: Subject) -> Iterator[str]:
    report = subject.stressed
    tried = [case for case in report.cases if case.state != "not_applicable"]
    yield "## Extremes"
    yield (
        f"`rg stress {subject.name}`, frames of {report.size[0]} x {report.size[1]}: finite, bounded, no light made "
        "from nothing, invariants, error within what the reference allows."
    )
    rows = ["| Extreme | | Outcome |", "|---|---|---|"]
    rows += [f"| `{case.name}` | {case.help} | {_outcome(case)} |" for case in tried]
    yield "\n".join(rows)
    others = [case for case in report.cases if case.state == "not_applicable"]
    if others:
        reasons = dict.fromkeys(case.text for case in others)
        yield f"{len(others)} common extremes do not apply to this graph: {'; '.join(reasons)}."


def _outcome(case: CaseOutcome) -> str:
    if case.state == "refused":
        return f"refused, {case.code}"
    if case.state != "ran":
        return f"**{case.state.replace('_', ' ')}** {case.code}"
    failures = [f"**fails** {entry.name}: {failure.text}" for entry in case.passes for failure in _failing(entry)]
    if failures:
        return "; ".join(dict.fromkeys(failures))
    if all(entry.status == "not_run" for entry in case.passes):
        return "nothing to do: " + "; ".join(dict.fromkeys(entry.reason for entry in case.passes))
    skipped = dict.fromkeys(
        f"{check} not checked: {_first(why)}" for e in case.passes for check, why in e.skipped.items()
    )
    return "; ".join(("passes", *skipped))


def _failing(entry: PassOutcome) -> Sequence[Any]:
    return entry.failures if entry.status == "fail" else ()


def _first(text: str) -> str:
    return text.partition("\n")[0].replace("|", "\\|")
