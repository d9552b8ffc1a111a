"""A graph file from text to verified plan, against the time PyYAML's C loader takes for the same file.

    python benchmarks/document_speed.py [--sizes 100 1000 10000] [--rounds 3]

Two graphs: ``chain``, full-screen passes with side inputs, each read by the next; and ``broadcast``, one texture that
every pass reads, and a last pass that reads what all of them wrote. The smallest of several repeats, interleaved; once
as a user runs it and once with Python's cyclic garbage collector off throughout, which tells what of the growth is the
collector's. What the project promises: planning, expansion included, in at most twice the loader's time at 1,000
passes, and at 10,000 at most 1.5 times as much a pass.
"""

from __future__ import annotations

import argparse
import gc
import time
from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from rendergraph.document.load import load_document
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene

SHADER = "#version 450\nout vec4 o_color;\nvoid main() { o_color = vec4(0.0); }\n"


def graph(passes: int) -> str:
    """The chain's text."""
    reads: list[list[str]] = [[]]
    for i in range(1, passes):
        reads.append([f"u_before: t{i - 1}"] + ([f"u_side: t{i - 3}"] if i > 3 and i % 3 == 0 else []))
    return _text(reads)


def broadcast(passes: int) -> str:
    """The text of a graph whose first texture all passes read and whose last pass reads all textures."""
    reads = [[], *(["u_source: t0"] for _ in range(passes - 2)), [f"u_{i}: t{i}" for i in range(passes - 1)]]
    return _text(reads)


def _text(reads: Iterable[list[str]]) -> str:
    """Passes that each read some textures and write one of their own; the last one's is the output."""
    resources, passes, count = [], [], 0
    for i, connected in enumerate(reads):
        resources.append(f"  t{i}:\n    format: rgba8")
        read = ["    read:", *(f"      {line}" for line in connected)] if connected else []
        write = ["    write:", f"      o_color: t{i}", "    set:", "      shader: fill.frag"]
        passes += [f"  p{i}:", "    node: fullscreen", *read, *write]
        count = i
    head = ["rendergraph: 1", "frame: {size: [64, 64]}", "resources:", *resources, "passes:"]
    return "\n".join([*head, *passes, "outputs:", f"  t{count}:", "    file: last.png"])


def measure(path: Path, best: dict[str, float]) -> None:
    """Lower ``best``, milliseconds by phase. ``planning`` is expansion and compilation as the commands run them."""

    def timed(name: str, work: Callable[[], Any]) -> Any:
        start = time.perf_counter()
        result = work()
        best[name] = min(best.get(name, 1e9), 1000 * (time.perf_counter() - start))
        return result

    gc.collect()
    timed("yaml", lambda: yaml.load(path.read_text(), Loader=yaml.CSafeLoader))
    document = timed("load", lambda: load_document(path))
    expanded, _ = timed("expand", lambda: expand(document))
    timed("compile", lambda: compile_plan(expanded))
    timed("planning", lambda: plan_without_scene(document, PlanOptions()))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10000])
    parser.add_argument("--rounds", type=int, default=3, help="of all sizes, so that each meets quiet moments")
    asked = parser.parse_args()
    names = ("yaml", "load", "expand", "compile", "planning")
    cases = [(graph, "chain"), (broadcast, "broadcast")]
    best: dict[tuple[str, bool, int], dict[str, float]] = defaultdict(dict)
    with TemporaryDirectory() as folder:
        (Path(folder) / "fill.frag").write_text(SHADER)
        for _ in range(asked.rounds):
            for (text, name), passes, collector in product(cases, asked.sizes, (True, False)):
                path = Path(folder) / f"{name}_{passes}.yaml"
                path.write_text(text(passes))
                if not collector:
                    gc.disable()
                for _ in range(min(20, 1 + 5000 // passes)):
                    measure(path, best[name, collector, passes])
                gc.enable()
    for (_, name), collector in product(cases, (True, False)):
        print(f"\n{name}, collector {'on' if collector else 'off'}: milliseconds")
        print(f"{'passes':>7}" + "".join(f"{column:>10}" for column in names) + "   us/pass  planning/yaml")
        for passes in asked.sizes:
            found = best[name, collector, passes]
            row = "".join(f"{found[column]:10.1f}" for column in names)
            each = 1000 * found["planning"] / passes
            print(f"{passes:7}{row}{each:10.1f}{found['planning'] / found['yaml']:15.2f}")


if __name__ == "__main__":
    main()
