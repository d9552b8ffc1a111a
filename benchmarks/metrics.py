"""Milliseconds of each image metric, smallest of several runs.

python benchmarks/metrics.py [--size 1280x720] [--repeats 5] [--masked]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from rendergraph.measure.metrics import METRICS, compare, compare_images, error_map, error_picture
from rendergraph.node.reference import Quantity

CHANNELS = {Quantity.DEPTH: 1, Quantity.SHARE: 1, Quantity.IDENTITY: 1, Quantity.SCALAR: 1}


def milliseconds(task: Callable[[], object], repeats: int) -> float:
    """Least time of ``repeats`` runs."""
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        task()
        best = min(best, time.perf_counter() - start)
    return 1e3 * best


def main() -> None:
    """Print a line a metric."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--masked", action="store_true", help="a tenth of the texels is masked")
    asked = parser.parse_args()
    width, height = map(int, asked.size.split("x"))
    draw = np.random.default_rng(1)
    mask = draw.random((height, width)) > 0.1 if asked.masked else None
    print(f"{width}x{height}, {'a tenth masked' if asked.masked else 'no mask'}, smallest of {asked.repeats}")
    for quantity, metrics in METRICS.items():
        channels = CHANNELS.get(quantity, 3)
        truth = draw.random((height, width, channels))
        judged = np.clip(truth + draw.normal(0.0, 0.05, truth.shape), 0.0, 1.0)
        for metric in metrics:
            ms = milliseconds(lambda m=metric: compare(quantity, judged, truth, mask, [m]), asked.repeats)  # type: ignore[misc]  # noqa: B023
            print(f"{quantity:<10} x{channels}  {metric:<14} {ms:8.1f} ms", flush=True)
        ms = milliseconds(lambda: compare(quantity, judged, truth, mask), asked.repeats)  # noqa: B023
        print(f"{quantity:<10} x{channels}  {'all of them':<14} {ms:8.1f} ms", flush=True)
    shown = error_map(Quantity.SCALAR, judged, truth, mask)
    print(f"error_picture                {milliseconds(lambda: error_picture(shown), asked.repeats):8.1f} ms")
    pair = [image.astype(np.uint8) for image in 255 * np.repeat([judged, truth], 4, axis=-1)]
    print(f"compare_images rgba8         {milliseconds(lambda: compare_images(*pair), asked.repeats):8.1f} ms")


if __name__ == "__main__":
    main()
