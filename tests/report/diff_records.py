"""Small records for the tests of `rg diff`, and plans of a shipped graph under overrides."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.resources import resources_record


def samples(middle: float, count: int = 60, seed: int = 1, noise: float = 0.01) -> list[float]:
    """Quiet frame times about ``middle`` ms."""
    return [round(v, 6) for v in (middle * np.exp(noise * np.random.default_rng(seed).normal(size=count))).tolist()]


def timing(
    passes: Mapping[str, Sequence[float]] | None = None, frame: Sequence[float] | None = None, **changes: Any
) -> dict[str, Any]:
    """A timing record; ``changes`` replace top-level keys."""
    passes = {"light": samples(2.0), "sky": samples(1.0)} if passes is None else passes
    return {
        "schema": "rendergraph.timing/1",
        "title": "made up",
        "clock": {"name": "finish_wall"},
        "device": {
            "renderer": "llvmpipe",
            "version": "4.5 Mesa 22.3.6",
            "driver": "Mesa 22.3.6",
            "cpu": "c",
            "threads": 2,
        },
        "size": [64, 36],
        "frame_ms": {"samples": samples(3.0) if frame is None else list(frame)},
        "passes": [
            {
                "name": name,
                "node": f"{name}_node",
                "ms": {"samples": list(values)},
                "counters": {"draws": 3, "groups": None},
            }
            for name, values in passes.items()
        ],
        "steady_state": {"objects_created": 0, "programs_compiled": 0, "bytes_uploaded": 0},
        **changes,
    }


def resources(*overrides: str, **options: Any) -> dict[str, Any]:
    """The resources record of the shipped demo graph under overrides, planned without a GPU."""
    plan, _ = plan_without_scene(load_document("deferred_shading", overrides), PlanOptions(**options))
    made: dict[str, Any] = json.loads(json.dumps(resources_record(plan, "demo")))
    return made


def bench(slowdown: float = 1.0, *, sides: str = "AB", processes: int = 10, blocks: int = 3) -> dict[str, Any]:
    """A bench file: two passes, of which ``light`` is slower on side B: the second half of its two sub-passes."""
    rng = np.random.default_rng(5)

    def side(factor: float) -> dict[str, Any]:
        times = {"light": 2.0 * factor, "sky": 1.0}
        drawn = {n: (v * np.exp(0.01 * rng.normal(size=5))).round(6).tolist() for n, v in times.items()}
        steps = {
            "light.cull": np.exp(0.01 * rng.normal(size=5)).round(6).tolist(),
            "light.shade": ((2 * factor - 1) * np.exp(0.01 * rng.normal(size=5))).round(6).tolist(),
            "sky.draw": drawn["sky"],
        }
        frame = np.sum(list(drawn.values()), axis=0).round(6).tolist()
        return {"frame_ms": frame, "passes": drawn, "subpasses": steps}

    facts = timing()
    for entry in facts["passes"]:
        del entry["ms"]
        names = {"light": ("cull", "shade"), "sky": ("draw",)}[entry["name"]]
        entry["subpasses"] = [{"name": f"{entry['name']}.{name}", "counters": {"draws": 1}} for name in names]
    del facts["schema"], facts["frame_ms"]
    return {
        "schema": "rendergraph.bench/1",
        "graphs": ["a.yaml", "b.yaml"][: len(sides)],
        "sides": dict.fromkeys(sides, facts),
        "blocks": [
            {"process": p, "order": sides, **{name: side(slowdown if name == "B" else 1.0) for name in sides}}
            for p in range(processes)
            for _ in range(blocks)
        ],
    }


def write(path: Path, record: Mapping[str, Any]) -> str:
    """Write a record, with whatever numbers JSON forbids; its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(record))
    return str(path)
