"""What a truth costs that is kept already: key, reading and checking, beside the reading alone.

python benchmarks/truth_cache.py [WIDTHxHEIGHT]
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.fingerprint import source_fingerprint
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun, Truth
from rendergraph.plan.graph import Frame, TextureDesc

PROMISE_MS = 50.0
ROUNDS = 15
SIZES = ((320, 180), (640, 360), (1280, 720))


def main(sizes: tuple[tuple[int, int], ...]) -> None:
    """Print the smallest of many hits for each size, and what the first in a process costs more."""
    node = find_node("tonemap")
    first = _milliseconds(lambda: source_fingerprint(f"{node.__module__}.reference"), 1)
    first += _milliseconds(lambda: source_fingerprint("rendergraph.measure.truth.cache"), 1)
    print(f"sources, once a process: {first:.1f} ms")
    for width, height in sizes:
        rng = np.random.default_rng(1)
        color = rng.random((height, width, 4))
        desc = TextureDesc("rgba16f", width, height)
        run = PassRun(
            params=node.params_type(),
            inputs={"color": color},
            outputs={"color": color},
            descs={"color": desc},
            frame=Frame(width, height),
        )

        def judge(seen: PassRun) -> Mapping[str, Truth]:
            return {"color": Truth(seen.inputs["color"][..., :3], seen.outputs["color"][..., :3])}

        with tempfile.TemporaryDirectory() as folder:
            cache = TruthCache(Path(folder))
            cache.recall(node, run, judge)
            (file,) = Path(folder).glob("*.npz")
            hit = _milliseconds(lambda c=cache, r=run: c.recall(node, r, judge), ROUNDS)  # type: ignore[misc]
            read = _milliseconds(file.read_bytes, ROUNDS)
            assert (cache.hits, cache.misses) == (ROUNDS, 1)
            size = file.stat().st_size / 2**20
        met = "met" if hit <= PROMISE_MS else "not met"
        print(
            f"{width}x{height}: hit {hit:.1f} ms (promise {PROMISE_MS:.0f}: {met}), entry {size:.1f} MiB, "
            f"reading it alone {read:.1f} ms"
        )


def _milliseconds(work: Callable[[], object], rounds: int) -> float:
    """The smallest of several wall times."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        width, _, height = sys.argv[1].partition("x")
        main(((int(width), int(height)),))
    else:
        main(SIZES)
