"""A graph file from text to verified plan, against the time PyYAML's C loader takes for the same file.

    python benchmarks/document_speed.py

A chain of full-screen passes with side inputs. The smallest of several repeats, interleaved; the last column is what
the project promises: planning, expansion included, in at most twice the loader's time at 1,000 passes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from rendergraph.document.load import load_document
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand

SHADER = "#version 450\nout vec4 o_color;\nvoid main() { o_color = vec4(0.0); }\n"


def graph(passes: int) -> str:
    """The file's text."""
    lines = ["rendergraph: 1", "frame: {size: [64, 64]}", "resources:"]
    lines += [f"  t{i}:\n    format: rgba8" for i in range(passes)]
    lines.append("passes:")
    for i in range(passes):
        lines += [f"  p{i}:", "    node: fullscreen"]
        if i:
            lines += ["    read:", f"      u_before: t{i - 1}"]
        if i > 3 and i % 3 == 0:
            lines.append(f"      u_side: t{i - 3}")
        lines += ["    write:", f"      o_color: t{i}", "    set:", "      shader: fill.frag"]
    return "\n".join([*lines, "outputs:", f"  t{passes - 1}:", "    file: last.png"])


def main() -> None:
    """Measure and print."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "fill.frag").write_text(SHADER)
        for passes in (100, 1000, 10000):
            path = Path(folder) / f"chain_{passes}.yaml"
            path.write_text(graph(passes))
            best: dict[str, float] = {}

            def timed(name: str, work: Callable[[], Any], best: dict[str, float] = best) -> Any:
                start = time.perf_counter()
                result = work()
                best[name] = min(best.get(name, 1e9), 1000 * (time.perf_counter() - start))
                return result

            for _ in range(5 if passes < 5000 else 2):
                timed("yaml", lambda path=path: yaml.load(path.read_text(), Loader=yaml.CSafeLoader))
                document = timed("load", lambda path=path: load_document(path))
                expanded, _ = timed("expand", lambda document=document: expand(document))
                timed("compile", lambda expanded=expanded: compile_plan(expanded))
            ratio = (best["expand"] + best["compile"]) / best["yaml"]
            figures = "  ".join(f"{name} {value:8.1f} ms" for name, value in best.items())
            print(f"{passes:6} passes  {figures}  planning / yaml {ratio:.2f}")


if __name__ == "__main__":
    main()
