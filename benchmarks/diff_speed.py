"""Time of `rg diff` on two timing records of 10,000 samples and 20 passes: reading, comparing, printing.

    python benchmarks/diff_speed.py [--samples N] [--passes N]

The promise is below one second for the whole command, Python's start included; modules are compiled beforehand, as
they are where a package was installed.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

RUN = "import sys; from rendergraph.cli import main; main(sys.argv[1:])"


def record(seed: int, samples: int, passes: int) -> dict[str, Any]:
    """A timing record as `rg render` writes it: each pass one sub-pass, with three series of samples each."""
    draw = random.Random(seed)

    def series(middle: float) -> dict[str, Any]:
        values = [round(draw.lognormvariate(0.0, 0.05) * middle, 6) for _ in range(samples)]
        return {"median": middle, "min": min(values), "max": max(values), "samples": values}

    def measured(middle: float) -> dict[str, Any]:
        return {key: series(middle) for key in ("ms", "submit_ms", "process_ms")}

    names = [f"pass_{i}" for i in range(passes)]
    return {
        "schema": "rendergraph.timing/1",
        "clock": {"name": "finish_wall"},
        "device": {"renderer": "renderer", "version": "4.5", "cpu": "cpu", "threads": 2},
        "size": [1280, 720],
        "frame_ms": series(10.0),
        "passes": [
            {"name": name, "node": "fullscreen", **measured(0.5), "subpasses": [{"name": name, **measured(0.5)}]}
            for name in names
        ],
    }


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--passes", type=int, default=20)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        cached = {**os.environ, "PYTHONPYCACHEPREFIX": str(Path(folder, "cache"))}
        cached.pop("PYTHONDONTWRITEBYTECODE", None)
        paths = [Path(folder, f"{name}.json") for name in "ab"]
        for seed, path in enumerate(paths):
            path.write_text(json.dumps(record(seed, asked.samples, asked.passes)))
        size = paths[0].stat().st_size / 2**20
        print(f"{asked.samples} samples, {asked.passes} passes, {size:.1f} MiB a record")
        for label, command in (
            ("import typer alone", ["-c", "import typer"]),
            ("rg diff a b", ["-c", RUN, "diff", *map(str, paths)]),
        ):
            best = float("inf")
            for _ in range(5):
                start = time.perf_counter()
                subprocess.run([sys.executable, *command], stdout=subprocess.DEVNULL, check=True, env=cached)
                best = min(best, time.perf_counter() - start)
            print(f"{label:<20} {best:6.3f} s")


if __name__ == "__main__":
    main()
