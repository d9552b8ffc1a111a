"""A sweep's record made up by hand: three settings by two knobs' values, one on no front, one refused."""

from __future__ import annotations

from typing import Any


def interval(estimate: float, spread: float = 0.1) -> dict[str, Any]:
    return {"estimate": estimate, "low": estimate - spread, "high": estimate + spread}


def point(values: tuple[str, str], ms: float, error: float | None, **more: Any) -> dict[str, Any]:
    return {
        "set": [f"passes.occlude.set.samples={values[0]}", f"passes.occlude.set.radius={values[1]}"],
        "own": False,
        "ms": interval(ms),
        "relative": interval(ms / 2.0),
        "rounds": [[ms], [ms]],
        "chunk": 0,
        "bytes": 1 << 20,
        "error": error,
        "standard_error": 0.0,
        "tolerance": None,
        "verdict": "measured",
        "reason": "",
        "steady": True,
        "contended": False,
        "front": True,
        **more,
    }


def made_up_sweep() -> dict[str, Any]:
    refused = {"ms": None, "relative": None, "rounds": [], "bytes": 0, "error": None, "front": False}
    return {
        "schema": "rendergraph.sweep/1",
        "rendergraph": "0.1.0",
        "title": "Occlusion <b>& more</b>",
        "size": [64, 36],
        "graph": "graph.yaml",
        "complete": True,
        "device": {"renderer": "made up", "driver": "1", "threads": 2},
        "design": {"frames": 2, "rounds": 8, "seed": 0, "confidence": 0.95, "sampled": False},
        "limits": {"budget_ms": 5.0, "max_error": None},
        "error": {
            "name": "image:rmse", "kind": "image", "pass": "", "measure": "", "output": "image",
            "quantity": "display", "metric": "rmse", "why": "several_passes", "twin": [],
        },
        "axes": [
            {
                "name": "occlude.samples", "path": "passes.occlude.set.samples", "values": ["4", "8", "16"],
                "quality": "up", "pass": "occlude", "errors": [0.4, 0.2, 0.1], "shape": "falls", "method": "slice",
                "at": ["occlude.radius=1"],
            },
            {
                "name": "occlude.radius", "path": "passes.occlude.set.radius", "values": ["1", "2"], "quality": "",
                "pass": "occlude", "errors": [], "shape": "", "method": "", "at": [],
            },
        ],
        "control": {**point(("", ""), 2.5, 0.3, own=True, front=False), "set": []},
        "control_ms": interval(2.5),
        "points": [
            point(("4", "1"), 1.0, 0.4, bytes=0),
            point(("8", "1"), 2.0, 0.2),
            point(("16", "1"), 4.0, 0.1, contended=True, standard_error=0.01),
            point(("4", "2"), 3.0, 0.5, front=False),
            {**point(("16", "2"), 0.0, None, verdict="refused", reason="RG205 <no>"), **refused},
        ],
        "chunks": [{"number": 0, "contended": False, "control": [[2.5], [2.5]]}],
        "recommended": {
            "point": 2, "set": "--set passes.occlude.set.samples=16 --set passes.occlude.set.radius=1",
            "ms": 4.0, "bytes": 1 << 20, "error": 0.1,
        },
    }  # fmt: skip
