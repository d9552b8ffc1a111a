"""Time to plan graphs of 100, 1,000 and 10,000 passes, against the time PyYAML's C loader takes for the same file.

    python benchmarks/plan_speed.py [--phases]

The graph is a long frame of effect chains: depth and normals feed screen-space passes, compute passes build lists that
later passes consume, every tenth pass adds to a shared target, every fiftieth reads history. Both are timed in one run,
and the smallest of several repeats is shown. This is the planner alone, from the expanded graph to the verified plan;
document_speed.py measures what the project promises, which includes expansion (at most 2 for 1,000 passes).
"""

from __future__ import annotations

import argparse
import cProfile
import gc
import pstats
import time
from collections.abc import Callable
from typing import Any

import yaml

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    Dispatch,
    Frame,
    Fullscreen,
    Graph,
    Kind,
    Pass,
    Position,
    Resource,
    SubPass,
    TextureDesc,
    Usage,
)

FORMATS = ("rgba16f", "rgba8", "r8", "r32f", "rg16f", "r11g11b10f")


def document(count: int) -> dict[str, Any]:
    """The graph file as plain data: about what a person would write for each pass."""
    resources: dict[str, Any] = {"depth": {"format": "d32f"}, "hdr": {"format": "rgba16f"}}
    passes: dict[str, Any] = {"gbuffer": {"node": "gbuffer", "write": {"depth": "depth", "color": "hdr"}}}
    last_add = "gbuffer"
    for i in range(count - 2):
        name = f"effect_{i:05}"
        previous = f"target_{i - 1:05}" if i else "hdr"
        wide = f"target_{i - 7:05}" if i >= 7 else "depth"
        resources[f"target_{i:05}"] = {"format": FORMATS[i % len(FORMATS)], "scale": (1.0, 0.5, 0.25)[i % 3]}
        node: dict[str, Any] = {"node": "blur", "read": {"color": previous, "guide": wide, "depth": "depth"}}
        node["write"] = {"color": f"target_{i:05}"}
        node["set"] = {"radius": 1.5 + i % 5, "preset": "high", "steps": 8 + i % 3}
        if i % 5 == 0:
            resources[f"list_{i:05}"] = {"bytes": 4096 * (1 + i % 7)}
            node["write"]["list"] = f"list_{i:05}"
        if i % 5 == 3:
            node["read"]["list"] = f"list_{i - 3:05}"
        if i % 10 == 9:
            node["write"]["sum"] = "hdr"
            node["after"] = [last_add]
            last_add = name
        if i % 50 == 49:
            resources[f"last_{i:05}"] = {"previous": f"target_{i - 3:05}"}
            node["read"]["history"] = f"last_{i:05}"
        passes[name] = node
    passes["tonemap"] = {"node": "tonemap", "read": {"color": "hdr", "bloom": f"target_{count - 3:05}"}}
    passes["tonemap"]["write"] = {"color": "image"}
    return {
        "rendergraph": 1,
        "frame": {"size": [1280, 720]},
        "resources": resources,
        "passes": passes,
        "outputs": {"image": {"file": "frame.png"}},
    }


def expanded(found: dict[str, Any]) -> Graph:
    """The graph that the file expands to: list writers become a compute step and a draw, others one draw."""
    history = {n: r["previous"] for n, r in found["resources"].items() if "previous" in r}
    resources: dict[str, Resource] = {"image": Resource("image", TextureDesc("rgba8", 1280, 720), Kind.PERSISTENT)}
    descs: dict[str, TextureDesc | BufferDesc] = {}
    for name, r in found["resources"].items():
        if "bytes" in r:
            descs[name] = BufferDesc(r["bytes"])
        elif "format" in r:
            scale = r.get("scale", 1.0)
            descs[name] = TextureDesc(r["format"], int(1280 * scale), int(720 * scale))
    for name, r in found["resources"].items():
        kept = name in history.values()
        kind = Kind.HISTORY if name in history else Kind.PERSISTENT if kept else Kind.TRANSIENT
        resources[name] = Resource(name, descs[r.get("previous", name)], kind, r.get("previous"))
    passes: dict[str, Pass] = {}
    for line, (name, p) in enumerate(found["passes"].items()):
        at = Position("graph.yaml", 10 + 8 * line, 3)
        draw: list[Access] = []
        steps: list[SubPass] = []
        for port, resource in p.get("read", {}).items():
            if port == "list":
                draw.append(Access(resource, Usage.STORAGE_READ, port))
            else:
                draw.append(Access(resource, Usage.SAMPLED, port))
        for port, resource in p["write"].items():
            if port == "list":
                depth = Access("depth", Usage.SAMPLED, "depth")
                store = Access(resource, Usage.STORAGE_WRITE, port, load=False)
                steps.append(SubPass(f"{name}.cull", name, (depth, store), Dispatch(8), position=at))
                draw.append(Access(resource, Usage.STORAGE_READ, port))
            elif port == "depth":
                draw.append(Access(resource, Usage.DEPTH, load=False))
            else:
                draw.append(Access(resource, Usage.COLOR, load=port == "sum"))
        steps.append(SubPass(f"{name}.draw", name, tuple(draw), Fullscreen(), position=at))
        passes[name] = Pass(name, p["node"], tuple(steps), tuple(p.get("after", ())), position=at)
    return Graph(Frame(1280, 720), resources, passes, ("image",))


def best(run: Callable[[], object], repeats: int) -> float:
    """Smallest wall-clock time of some repeats, in seconds."""
    times = []
    for _ in range(repeats):
        gc.collect()
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--phases", action="store_true", help="profile the 1,000-pass graph by function")
    asked = parser.parse_args()
    print(f"{'passes':>7} {'file KiB':>9} {'yaml ms':>9} {'plan ms':>9} {'ratio':>6} {'us/pass':>8}")
    for count in (100, 1000, 10_000):
        found = document(count)
        text = yaml.dump(found, sort_keys=False, default_flow_style=None)
        graph = expanded(found)
        repeats = 3 if count == 10_000 else 7
        parse = best(lambda text=text: yaml.load(text, Loader=yaml.CSafeLoader), repeats)  # type: ignore[misc]
        plan = best(lambda graph=graph: compile_plan(graph), repeats)  # type: ignore[misc]
        row = f"{count:>7} {len(text) / 1024:>9.0f} {parse * 1e3:>9.1f} {plan * 1e3:>9.1f} {plan / parse:>6.2f}"
        print(f"{row} {plan / count * 1e6:>8.1f}")
        if asked.phases and count == 1000:
            profile = cProfile.Profile()
            profile.runcall(compile_plan, graph)
            pstats.Stats(profile).sort_stats("cumulative").print_stats(30)


if __name__ == "__main__":
    main()
