"""A setting's twin: the same graph with all that is swept at its most accurate, and truths in place of swept passes."""

from __future__ import annotations

from dataclasses import dataclass

from rendergraph.measure.sweep.accurate import accurate_settings, possible
from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.bench import Overrides, Settings, Workbench
from rendergraph.measure.truth.decode import F64
from rendergraph.measure.truth.substitute import ideal_measures, replace_outputs


@dataclass(frozen=True, slots=True)
class Twin:
    """``image`` float64[h, w, c] of the output judged; under these ``overrides``; and the passes whose truth stands in
    for what they wrote, each with its measures.
    """

    image: F64
    overrides: Overrides
    truths: dict[str, tuple[str, ...]]


def twin_of(bench: Workbench, overrides: Overrides) -> Twin:
    """The twin of a setting, made once for all settings that differ in nothing but quality.

    :raises RenderGraphError: for every error of its run and of the references.
    """
    chosen = twin_overrides(bench.settings, overrides)
    key = ("twin", chosen)
    if key not in bench.kept:
        document, planned = bench.settings.document(chosen), bench.settings.planned(chosen)
        swept = {axis.passed for axis in bench.job.axes if axis.passed}
        names = [name for name in document.model.passes if name in swept and ideal_measures(document, name)]
        replaced = replace_outputs(
            document, planned, bench.device, names, cache=bench.cache, store=bench.store(chosen)
        )  # fmt: skip
        bench.kept[key] = Twin(replaced.images[bench.job.error.output], chosen, dict(replaced.measures))
    found: Twin = bench.kept[key]
    return found


def twin_overrides(settings: Settings, overrides: Overrides) -> Overrides:
    """The setting with each quality axis at its most accurate: a knob at the end its node declares, where the graph
    takes it, anything else at its last value. Axes that claim nothing about accuracy stay as they are.
    """
    quality = {axis.path for axis in settings.job.axes if axis.quality}
    base = tuple(o for o in overrides if o.partition("=")[0] not in quality)
    plain = {a.path: a.values[-1] for a in settings.job.axes if a.quality and not _is_knob(a)}
    base = (*base, *(f"{path}={value}" for path, value in plain.items()))
    knobs = {a.path: a for a in settings.job.axes if a.quality and _is_knob(a)}
    document = settings.document(base)
    wanted = {
        path: value
        for name in dict.fromkeys(axis.passed for axis in knobs.values())
        for path, value in accurate_settings(document, name, settings.job.axes).items()
        if path in knobs
    }
    return possible(settings.document, base, wanted, settings.scene(base), settings.job.size)


def _is_knob(axis: Axis) -> bool:
    return axis.path.startswith("passes.")
