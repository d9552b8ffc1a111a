"""What specialising on the scene saves every shipped graph, as the tables of docs/specialisation.md.

    python -m benchmarks.vs_full [--processes 3] [--blocks 6] [--size 640x360] [--keep DIR] > docs/specialisation.md

Each graph is benched against itself under --full, interleaved, in fresh processes. Times are told as shares of the full
time, since milliseconds belong to one machine; bytes and counts are exact. Progress goes to stderr. Benches kept in a
folder are not run again.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import zlib
from pathlib import Path

from rendergraph.document.load import load_document
from rendergraph.document.source_file import shipped_graphs
from rendergraph.measure.bench import Bench
from rendergraph.measure.bench_job import BenchJob
from rendergraph.measure.vs_full import VsFull, vs_full, vs_full_sides

INTRODUCTION = Path(__file__).with_name("specialisation.md")

#: Of every scene: what a full frame takes leaves no time for many.
QUICK = ("scene.detail=0.2",)

#: A graph and overrides under which its scene requires less, with a word on what.
CASES = (
    ("deferred_shading", "as shipped", ()),
    ("deferred_shading", "no sun", ("scene.lights={from_scene: false, ambient: {}}",)),
    ("deferred_shading", "cornell box", ("scene.source=cornell",)),
    ("deferred_shading", "spheres", ("scene.source=spheres",)),
    ("forward_shading", "cornell box", ("scene.source=cornell",)),
    ("gbuffer", "spheres", ("scene.source=spheres",)),
    ("shadow_map", "as shipped", ()),
    ("sky", "as shipped", ()),
    ("exposure", "as shipped", ()),
    ("deferred_lighting", "as shipped", ()),
    ("gbuffer", "as shipped", ()),
    ("forward_shading", "as shipped", ()),
)


def measure(graph: str, overrides: tuple[str, ...], options: argparse.Namespace, folder: Path) -> VsFull:
    """One bench, or the one kept."""
    path = folder / f"{zlib.crc32(repr((graph, overrides)).encode()):08x}.json"
    if path.exists():
        return vs_full(path)
    width, height = (int(v) for v in options.size.split("x"))
    sides = vs_full_sides(graph, (*QUICK, *overrides))
    bench = Bench(BenchJob(sides, options.processes, options.blocks, options.frames, (width, height), most_warm_up=20))
    bench.run()
    path.write_text(json.dumps(bench.record()))
    return vs_full(path)


def row(graph: str, scene: str, found: VsFull) -> str:
    """One line of the table."""
    amounts = {entry.name: entry for entry in found.amounts}
    frame = found.frame
    time = "" if frame.saved is None else f"{100 * frame.saved:.1f} %"
    sure = "" if frame.low is None or frame.high is None else f"{100 * frame.low:.1f} .. {100 * frame.high:.1f} %"
    shares = [
        f"{100 * (amounts[name].saved or 0.0):.1f} %" for name in ("transient_bytes", "bytes_written", "bytes_read")
    ]
    passes = f"{amounts['passes'].specialised} of {amounts['passes'].full}"
    steps = f"{amounts['subpasses'].specialised} of {amounts['subpasses'].full}"
    cells = [graph, scene, time, sure, frame.verdict, *shares, passes, steps, str(len(found.decisions))]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Measure every case and print the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--processes", type=int, default=3)
    parser.add_argument("--blocks", type=int, default=6)
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--keep", type=Path, metavar="DIR")
    options = parser.parse_args()
    known = set(shipped_graphs())
    text = INTRODUCTION.read_text(encoding="utf-8")
    rows, details = [], []
    with tempfile.TemporaryDirectory() as folder:
        kept = options.keep or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        for graph, scene, overrides in CASES:
            assert graph in known
            load_document(graph, overrides)
            print(f"{graph}, {scene}", file=sys.stderr, flush=True)
            found = measure(graph, overrides, options, kept)
            rows.append(row(graph, scene, found))
            if overrides:
                details += [f"\n{graph}, {scene}:\n", *(f"- {d['why']}" for d in found.decisions)]
    design = f"{options.processes} processes x {options.blocks} blocks x {options.frames} frames at {options.size}"
    print(text.replace("@ROWS@", "\n".join(rows)).replace("@DESIGN@", design).replace("@WHY@", "\n".join(details)))


if __name__ == "__main__":
    main()
