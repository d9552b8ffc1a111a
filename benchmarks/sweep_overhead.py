"""What a sweep takes beyond the frames that it must render: planning, judging, statistics, writing.

    python benchmarks/sweep_overhead.py [GRAPH]

The frames are those of the settings and of the control: warmed up, timed and judged. What each setting needs once,
compiled programs and uploads, is told apart; the rest is overhead.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from rendergraph.device.context import open_device
from rendergraph.measure.sweep import chunk, errors
from rendergraph.measure.sweep.outcome import sweep_outcome
from rendergraph.measure.sweep.run import Sweep, new_job
from rendergraph.report.sweep import sweep_record
from rendergraph.report.sweep_files import write_sweep
from rendergraph.run.runner import Runner

OVER = {
    "deferred_shading": "shadows.cascades=1:3:3,antialias.search_steps=4|12",
    "fxaa": "antialias.search_steps=1:16:4",
}


def main(graph: str) -> None:
    """Sweep, and print where the time went."""
    spent = {"frames": 0.0, "compile and upload": 0.0, "references": 0.0}

    def timed(owner: Any, name: str, label: str) -> None:
        original = getattr(owner, name)

        def wrapped(*arguments: Any, **options: Any) -> Any:
            start = time.perf_counter()
            try:
                return original(*arguments, **options)
            finally:
                spent[label] += time.perf_counter() - start

        setattr(owner, name, wrapped)

    timed(chunk.Prepared, "frame", "frames")
    timed(errors, "watch_frame", "frames")
    timed(errors, "judge_pass", "references")
    timed(Runner, "prepare", "compile and upload")
    open_device().finish()  # opening it is no part of a sweep
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        sweep = Sweep(new_job(graph, size=(320, 180)), over=[OVER[graph]], error="" if graph == "fxaa" else "shadows")
        sweep.run(Path(folder))
        write_sweep(Path(folder), sweep_record(sweep, sweep_outcome(sweep)), html=True, png=True)
        whole = time.perf_counter() - start
    rest = whole - sum(spent.values())
    for label, seconds in {**spent, "overhead": rest, "whole": whole}.items():
        print(f"{label:20} {seconds:8.3f} s")
    print(f"overhead is {100 * rest / spent['frames']:.1f} % of the frames rendered, {len(sweep.points)} settings")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "deferred_shading")
