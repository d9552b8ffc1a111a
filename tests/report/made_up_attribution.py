"""An attribution's record made up by hand."""

from __future__ import annotations

from typing import Any


def contribution(name: str, how: str, by: str, left: float, ms: float) -> dict[str, Any]:
    return {
        "name": name,
        "node": name,
        "how": how,
        "by": [by],
        "removed": -0.01,
        "left": left,
        "share": left / 0.3,
        "ms": ms,
        "ms_share": ms / 4.0,
        "bytes": 1024,
        "error_per_ms": left / ms,
    }


def made_up_attribution() -> dict[str, Any]:
    return {
        "schema": "rendergraph.attribution/1",
        "rendergraph": "0.1.0",
        "title": "",
        "size": [64, 36],
        "graph": "graph.yaml",
        "set": ["passes.meter.set.stride=8"],
        "device": {"renderer": "made up", "version": "4.5", "driver": "1"},
        "output": "image",
        "quantity": "display",
        "metric": "flip",
        "frame": 0,
        "error": 0.25,
        "frame_ms": 4.0,
        "passes": [
            contribution("antialias", "truth", "coverage", 0.2, 1.0),
            contribution("shadows", "setting", "passes.shadows.set.cascades=4", 0.1, 3.0),
            contribution("tonemap", "truth", "display", 0.0, 0.5),
            contribution("meter", "setting", "passes.meter.set.stride=1", 0.0, 1.0),
        ],
        "others": [{"name": name, "reason": "no truth can stand in for it"} for name in ("light", "glass", "sky")],
    }
