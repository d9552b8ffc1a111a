"""``accuracy.json``: how far each pass is from its truth, beside what it takes.

``docs/accuracy.schema.json`` is its JSON Schema.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np

import rendergraph
from rendergraph.document.whole_files import whole_file
from rendergraph.measure.truth.accuracy import PassAccuracy
from rendergraph.measure.truth.judgement import Judgement, WorstTexel
from rendergraph.plan.graph import Frame

SCHEMA = "rendergraph.accuracy/1"


def accuracy_record(
    passes: Sequence[PassAccuracy], frame: Frame, timing: Mapping[str, Any], resources: Mapping[str, Any]
) -> dict[str, Any]:
    """The record as JSON-ready data, with the times and bytes of the run's timing and resources records."""
    device = timing["device"]
    times = {entry["name"]: entry["ms"]["median"] for entry in timing["passes"]}
    held: Counter[str] = Counter()
    for resource in resources["resources"]:
        held[resource["first"].partition(".")[0]] += resource["bytes"]
    verdicts = Counter(found.verdict for entry in passes for found in entry.judgements)
    return {
        "schema": SCHEMA,
        "rendergraph": rendergraph.__version__,
        "title": timing["title"],
        "size": [frame.width, frame.height],
        "device": {key: device[key] for key in ("renderer", "version", "driver")},
        "frame": frame.count - 1,
        "seed": frame.seed,
        "verdicts": {verdict: verdicts[verdict] for verdict in ("within", "above", "cannot_judge")},
        "passes": [_pass(entry, times.get(entry.name), held[entry.name]) for entry in passes],
    }


def _pass(entry: PassAccuracy, ms: float | None, held: int) -> dict[str, Any]:
    judged = entry.judgements
    return {
        "name": entry.name,
        "node": entry.node,
        "ms": ms,
        "bytes": held,
        "method": judged[0].method if judged else "",
        "source": judged[0].source if judged else "",
        "reason": entry.reason,
        "reference_ms": round(1e3 * judged[0].seconds, 3) if judged else 0.0,
        "cached": judged[0].cached if judged else False,
        "broken": list(entry.broken),
        "measures": [_measure(found) for found in judged],
    }


def _measure(found: Judgement) -> dict[str, Any]:
    test = found.z_test
    return {
        "name": found.measure,
        "port": found.port,
        "help": found.help,
        "quantity": found.quantity.value,
        "ideal": found.ideal,
        "metrics": {name: number(value) for name, value in found.metrics.items()},
        "metric": found.metric,
        "unit": found.unit,
        "value": number(found.value),
        "tolerance": found.tolerance,
        "verdict": found.verdict,
        "reason": found.reason,
        "masked": found.masked,
        "standard_error": number(found.standard_error),
        "worst_texel": _worst(found.worst_texel) if found.worst_texel else None,
        "z_test": None
        if test is None
        else {
            "frames": test.frames,
            "accepted": test.accepted,
            "required": test.required,
            "alpha_texel": test.alpha_texel,
            "largest": number(test.largest),
        },
    }


def _worst(texel: WorstTexel) -> dict[str, Any]:
    return {
        "x": texel.x,
        "y": texel.y,
        "error": number(texel.error),
        "judged": [number(value) for value in texel.judged],
        "true": [number(value) for value in texel.true],
        "inputs": {port: [number(value) for value in values] for port, values in texel.inputs.items()},
    }


def write_variances(folder: Path, passes: Sequence[PassAccuracy]) -> list[Path]:
    """Write what each random pass was tested by, ``accuracy/PASS.MEASURE.npz``: float64[h, w, c] arrays ``mean`` (over
    frames, of what was judged), ``truth`` and ``variance`` (of one frame), and ``frames``; the files.
    """
    files = []
    for found in (found for entry in passes for found in entry.judgements):
        pictures, test = found.pictures, found.z_test
        if pictures is not None and pictures.variance is not None and test is not None:
            files.append(folder / "accuracy" / f"{found.pass_name}.{found.measure}.npz")
            with whole_file(files[-1]) as temporary:
                np.savez_compressed(
                    temporary,
                    mean=pictures.judged,
                    truth=pictures.truth,
                    variance=pictures.variance,
                    frames=np.array(test.frames),
                )
    return files


def number(value: float | None) -> float | str | None:
    """A float as JSON takes it: ``"inf"``, ``"-inf"`` and ``"nan"`` by name."""
    if value is None or abs(value) < float("inf"):
        return value
    return "nan" if isnan(value) else ("inf" if value > 0 else "-inf")
