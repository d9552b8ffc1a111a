"""Memory of every shipped graph under five rules, as the table of docs/lifetimes.md.

    python -m benchmarks.lifetimes > docs/lifetimes.md

Exact: what `rg plan` says, at each graph's own size and for its own scene. No OpenGL is needed.
"""

from __future__ import annotations

from rendergraph.document.load import load_document
from rendergraph.document.source_file import shipped_graphs
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document

HEAD = """# Memory of the shipped graphs

Bytes of transient resources in MiB, at each graph's own size, for its own scene. `unshared`: each has its own memory;
`exact pool`: shared between equal descriptions; `view pool`: shared within view classes, which is what a run uses;
`placed`: the best packing that a heap API would reach; `load`: the lower bound, the most that is live at once. Outputs
and histories are never shared and not counted. Written by `python -m benchmarks.lifetimes`.

| graph | sub-passes | resources | barriers | unshared | exact pool | view pool | placed | load | used / load |
|---|---|---|---|---|---|---|---|---|---|"""


def main() -> None:
    """Plan each graph and print its row."""
    print(HEAD)
    for name in sorted(shipped_graphs()):
        plan = plan_document(load_document(name), PlanOptions()).plan
        t = plan.totals
        sizes = " | ".join(f"{b / 2**20:.2f}" for b in (t.unshared, t.exact_pool, t.view_pool, t.placed, t.load))
        ratio = f"{t.used / t.load:.2f}" if t.load else "-"
        print(
            f"| {name} | {len(plan.order)} | {len(plan.lifetimes)} | {len(plan.barriers)} | {sizes} | {ratio} |",
        )


if __name__ == "__main__":
    main()
