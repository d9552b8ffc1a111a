"""What a judged graph has wrong, as diagnostics: measures above their tolerance, broken invariants, budgets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.measure.truth.accuracy import PassAccuracy
from rendergraph.measure.truth.judgement import Judgement, exceeds
from rendergraph.measure.truth.knobs import accuracy_hint
from rendergraph.node.reference import Quantity


def accuracy_findings(document: Document, passes: Sequence[PassAccuracy]) -> list[Diagnostic]:
    """RG741 for each measure whose truth is not sure enough, RG712 where it is known nowhere (a note), RG742 for each
    above its tolerance, RG747 for each invariant that is broken, RG710 and RG711 above the budget, and notes (RG708)
    for budgets that nothing was compared with.
    """
    found = []
    for entry in passes:
        place = document.position("passes", entry.name)
        for sentence in entry.broken:
            found.append(diagnose("RG747", place, name=entry.name, node=entry.node, what=sentence))
        for judged in entry.judgements:
            found += _judged(document, judged)
    return [*found, *check_error_budget(document, passes), *check_flip_budget(document, passes)]


def _judged(document: Document, judged: Judgement) -> Iterator[Diagnostic]:
    name = judged.pass_name
    place = document.position("passes", name)
    if judged.verdict == "cannot_judge":
        if judged.reason == "all_masked":
            yield diagnose("RG712", place, name=name, measure=judged.measure)
            return
        values = {"error": judged.standard_error, "tolerance": judged.tolerance}
        yield diagnose("RG741", place, name=name, measure=judged.measure, **values)
    elif judged.verdict == "above":
        yield diagnose(
            "RG742",
            place,
            name=name,
            node=judged.node,
            measure=judged.measure,
            metric=judged.metric,
            value=_shown(judged.value, judged.unit),
            tolerance=_shown(judged.tolerance, judged.unit),
            worst=_worst(judged),
            hint=accuracy_hint(name, judged.node, document.params[name]),
        )


def _shown(value: float | None, unit: str) -> str:
    return f"{value:.6g} {unit}".rstrip() if value is not None else "none"


def _worst(judged: Judgement) -> str:
    if judged.z_test is not None and judged.reason == "z_test":
        test = judged.z_test
        return f": chance explains {100 * test.accepted:.2f} % of its values, {100 * test.required:g} % must be"
    texel = judged.worst_texel
    if texel is None:
        return ""
    values = [", ".join(f"{v:.6g}" for v in values) for values in (texel.judged, texel.true)]
    inputs = "".join(f"; {port} {', '.join(f'{v:.6g}' for v in values)}" for port, values in texel.inputs.items())
    return f"; worst at ({texel.x}, {texel.y}): {values[0]} in place of {values[1]}{inputs}"


def check_error_budget(document: Document, passes: Sequence[PassAccuracy]) -> Iterator[Diagnostic]:
    """RG710 for each measure above its pass's ``budget.error``, RG708 for passes that were not judged."""
    by_name: Mapping[str, PassAccuracy] = {entry.name: entry for entry in passes}
    for name, limit in document.model.budget.error.items():
        place = document.position("budget", "error", name)
        entry = by_name.get(name)
        if entry is None or not entry.judgements:
            reason = entry.reason if entry is not None else "the pass was not judged"
            hint = "judge it too: --reference without --reference-pass" if entry is None else "remove its budget"
            yield diagnose("RG708", place, what=f"the error of '{name}'", reason=reason, hint=hint)
            continue
        for judged in entry.judgements:
            if judged.verdict != "cannot_judge" and exceeds(judged.metric, judged.value, limit):
                values: dict[str, Any] = {"found": _shown(judged.value, judged.unit), "limit": limit}
                hint = accuracy_hint(name, judged.node, document.params[name])
                yield diagnose(
                    "RG710", place, name=name, measure=judged.measure, metric=judged.metric, hint=hint, **values
                )


def check_flip_budget(document: Document, passes: Sequence[PassAccuracy]) -> Iterator[Diagnostic]:
    """RG711 for each output image whose FLIP is above ``budget.flip``, RG708 where no output has one."""
    limit = document.model.budget.flip
    if limit is None:
        return
    place = document.position("budget", "flip")
    checked = False
    for entry in passes:
        writes = document.model.passes[entry.name].write
        for judged in entry.judgements:
            output = writes.get(judged.port, "")
            error = judged.metrics.get("flip")
            if output not in document.model.outputs or judged.quantity is not Quantity.DISPLAY or error is None:
                continue
            checked = True
            if not error <= limit:
                hint = accuracy_hint(entry.name, entry.node, document.params[entry.name])
                yield diagnose("RG711", place, name=output, writer=entry.name, found=error, limit=limit, hint=hint)
    if not checked:
        reason = "no output image was compared with its truth by FLIP"
        hint = 'judge the pass that writes it, and: pip install "rendergraph[flip]"'
        yield diagnose("RG708", place, what="flip", reason=reason, hint=hint)
