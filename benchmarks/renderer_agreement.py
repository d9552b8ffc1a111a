"""Do two renderers agree? Renders every shipped graph, keeps images and times, and compares two such records.

    python -m benchmarks.renderer_agreement save here.npz
    python -m benchmarks.renderer_agreement compare here.npz there.npz

`save` also times the demo graph at 1280x720 and keeps its timing record. `compare` prints a Markdown table and exits
with 1 when an image is missing on one side or is outside the tolerance below, which docs/renderers.md explains.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

from rendergraph.document.load import load_document
from rendergraph.node.discovery import node_folder
from rendergraph.report.timing import timing_record
from rendergraph.run.render import RenderOptions, render_document

SIZE = (320, 180)

#: The tolerance, in steps of 1/255 of a pixel's worst colour channel: of every 8-bit image the mean, and the share of
#: pixels that may be further off than ``FAR_STEPS`` (silhouettes, cut-out leaves, mip levels chosen by the driver).
MEAN_STEPS, FAR_STEPS, FAR_PERCENT = 2.0, 8, 2.0
#: Images that nothing mip-mapped goes into, by the beginning of their names: no pixel further off than this.
UNTEXTURED = ("compute.", "fullscreen.", "fxaa.", "tonemap.")
UNTEXTURED_STEPS = 2


def save(path: Path) -> None:
    """Render everything on this machine's renderer."""
    images: dict[str, npt.NDArray[np.generic]] = {}
    facts: dict[str, str] = {}
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


def compare(first: Path, second: Path) -> list[str]:
    """Print how far apart the 8-bit images are, in steps of 1/255. Returns what breaks the tolerance, a line each."""
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
        names = sorted({*a.files, *b.files} - {"record"})
        failures = [] if names else ["there are no images to compare"]
        for name in names:
            if name not in a.files or name not in b.files:
                failures.append(f"{name} is in one record only")
            elif a[name].shape != b[name].shape or a[name].dtype != b[name].dtype:
                failures.append(f"{name} is {a[name].dtype}{a[name].shape} here, {b[name].dtype}{b[name].shape} there")
            elif a[name].dtype == np.uint8:
                failures += _differences(name, a[name], b[name])
    return failures


def _differences(name: str, a: npt.NDArray[np.uint8], b: npt.NDArray[np.uint8]) -> list[str]:
    """Print one row, of the worst colour channel of each pixel; what breaks the tolerance."""
    difference = np.abs(a.astype(np.int16) - b.astype(np.int16))[..., :3].max(axis=-1)
    far = [100 * float((difference > steps).mean()) for steps in (2, FAR_STEPS)]
    print(f"| {name} | {difference.max()} | {difference.mean():.2f} | {far[0]:.2f} % | {far[1]:.2f} % |")
    failures = []
    if difference.mean() > MEAN_STEPS:
        failures.append(f"{name}: mean difference {difference.mean():.2f} steps, allowed are {MEAN_STEPS:g}")
    if far[1] > FAR_PERCENT:
        failures.append(f"{name}: {far[1]:.2f} % of pixels off by more than {FAR_STEPS}, allowed are {FAR_PERCENT:g} %")
    if name.startswith(UNTEXTURED) and difference.max() > UNTEXTURED_STEPS:
        failures.append(f"{name}: off by {difference.max()} steps, allowed without textures are {UNTEXTURED_STEPS}")
    return failures


def main() -> None:
    """Read the command line."""
    match sys.argv[1:]:
        case ["save", path]:
            save(Path(path))
        case ["compare", first, second]:
            failures = compare(Path(first), Path(second))
            for failure in failures:
                print(failure, file=sys.stderr)
            sys.exit(1 if failures else 0)
        case _:
            raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
