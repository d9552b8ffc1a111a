"""Do two renderers agree? Renders every shipped graph, keeps images and times, and compares two such records.

    python -m benchmarks.renderer_agreement save here.npz
    python -m benchmarks.renderer_agreement compare here.npz there.npz

`save` also times the demo graph at 1280x720 and keeps its timing record. The table that `compare` prints is Markdown.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from rendergraph.document.load import load_document
from rendergraph.node.discovery import node_folder
from rendergraph.report.timing import timing_record
from rendergraph.run.render import RenderOptions, render_document

SIZE = (320, 180)


def save(path: Path) -> None:
    """Render everything on this machine's renderer."""
    images: dict[str, np.ndarray] = {}
    facts = {}
    for graph in sorted((node_folder().parent / "graphs").glob("*.yaml")):
        result = render_document(load_document(graph), RenderOptions(size=SIZE, samples=0))
        for name, pixels in result.images.items():
            images[f"{graph.stem}.{name}"] = pixels
        facts = {"renderer": result.device.renderer, "version": result.device.version}
        print(graph.stem, "rendered", flush=True)
    timed = render_document(load_document("deferred_shading"), RenderOptions(size=(1280, 720), samples=20))
    record = timing_record(timed, "deferred_shading")
    images["demo"] = timed.images["image"]
    np.savez_compressed(path, record=json.dumps({"device": facts, "timing": record}), **images)


def compare(first: Path, second: Path) -> None:
    """Print how far apart the 8-bit images are, in steps of 1/255."""
    with np.load(first) as a, np.load(second) as b:
        for file in (a, b):
            record = json.loads(str(file["record"]))
            timing = record["timing"]
            proof = {key: value for key, value in timing["clock"]["proof"].items() if key.endswith("_ns")}
            print(
                f"- {record['device']['renderer']}, {record['device']['version']}: clock `{timing['clock']['name']}`, "
                f"demo frame {timing['frame_ms']['median']:.1f} ms, proof {proof}"
            )
        print(
            "\n| image | largest difference | mean | pixels off by more than 2 | more than 8 |\n|---|---|---|---|---|"
        )
        for name in sorted(set(a.files) & set(b.files) - {"record"}):
            if a[name].dtype != np.uint8:
                continue
            difference = np.abs(a[name].astype(np.int16) - b[name].astype(np.int16))[..., :3].max(axis=-1)
            far = [100 * (difference > steps).mean() for steps in (2, 8)]
            print(f"| {name} | {difference.max()} | {difference.mean():.2f} | {far[0]:.2f} % | {far[1]:.2f} % |")


def main() -> None:
    """Read the command line."""
    match sys.argv[1:]:
        case ["save", path]:
            save(Path(path))
        case ["compare", first, second]:
            compare(Path(first), Path(second))
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
