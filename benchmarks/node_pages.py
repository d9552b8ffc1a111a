"""The page of every node under docs/nodes: what and when, ports, knobs, and what a real run measured of it.

    python -m benchmarks.node_pages [NODE...]

Between the markers stands what was measured; the rest is made from the node's declarations and its README, and a test
holds it against them.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any, Final

from rendergraph.conformance.readme import what
from rendergraph.node.catalogue import describe_node
from rendergraph.node.discovery import find_node, node_folder

ROOT: Final = Path(__file__).resolve().parent.parent
PAGES: Final = ROOT / "docs" / "nodes"
MARKS: Final = ("<!-- measured -->", "<!-- end of what was measured -->")


def shipped() -> list[str]:
    """The nodes of this project, whatever else is installed."""
    return sorted(path.parent.name for path in node_folder().glob("*/__init__.py"))


def page(name: str, measured: str) -> str:
    """The whole page around what was measured."""
    text = (find_node(name).folder / "README.md").read_text(encoding="utf-8")
    described = describe_node(name)
    parts = [
        f"# {name}",
        what(text),
        when(text),
        f"Cost, hazards and sources: [nodes/{name}/README.md](../../nodes/{name}/README.md). "
        f"A graph of it: [graphs/{name}.yaml](../../graphs/{name}.yaml).",
        "## Ports",
        _ports(described),
        "## Parameters",
        _parameters(described),
        f"{MARKS[0]}\n\n{measured.strip()}\n\n{MARKS[1]}",
    ]
    return "\n\n".join(parts) + "\n"


def index() -> str:
    """The list of all pages."""
    rows = [f"| [{name}]({name}.md) | {describe_node(name)['summary']} |" for name in shipped()]
    head = "# Nodes\n\nMade by `python -m benchmarks.node_pages`. How to read the tables: "
    link = "[choosing_accuracy.md](../choosing_accuracy.md).\n\n"
    return head + link + "| Node | |\n|---|---|\n" + "\n".join(rows) + "\n"


def when(text: str) -> str:
    """The paragraph of a README that says when to pick the node and when not."""
    found = next(part for part in re.split(r"\n\s*\n", text) if "**Pick it**" in part)
    return found.strip()


def measured_part(text: str) -> str:
    """What stands between the markers of a page."""
    return text.partition(MARKS[0])[2].partition(MARKS[1])[0].strip()


def _ports(described: dict[str, Any]) -> str:
    if described["open_ports"]:
        return "Any names: those that your shader uses."
    rows = ["| Port | | Takes | Holds |", "|---|---|---|---|"]
    for direction, verb in (("inputs", "reads"), ("outputs", "writes")):
        for name, port in described[direction].items():
            takes = ", ".join(f"`{format}`" for format in port["formats"][:6]) or "a buffer"
            more = f" and {len(port['formats']) - 6} more" if len(port["formats"]) > 6 else ""
            way = ("modifies" if port["modify"] else verb) + (", optional" if port["optional"] else "")
            rows.append(f"| `{name}` | {way} | {takes}{more} | {port['help']} |")
    return "\n".join(rows)


def _parameters(described: dict[str, Any]) -> str:
    if not described["parameters"]:
        return "None."
    rows = ["| Parameter | Default | Range | Unit | Cheap to accurate | |", "|---|---|---|---|---|---|"]
    for name, entry in described["parameters"].items():
        default = "required" if entry["required"] else f"`{entry['default']}`"
        accurate = entry["accurate"]
        order = {"up": "larger", "down": "smaller", None: ""}.get(accurate if isinstance(accurate, str) else None)
        if isinstance(accurate, list):
            order = ", ".join(f"`{value}`" for value in accurate)
        cells = (f"`{name}`", default, _range(entry), entry["unit"], order or "", entry["help"].replace("|", "\\|"))
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _range(entry: dict[str, Any]) -> str:
    if entry["choices"]:
        return ", ".join(f"`{choice}`" for choice in entry["choices"])
    signs = {"minimum": "from", "exclusiveMinimum": "above", "maximum": "to", "exclusiveMaximum": "below"}
    return " ".join(f"{sign} {entry[key]:g}" for key, sign in signs.items() if key in entry)


def main() -> None:
    """Measure and write the pages."""
    from benchmarks.node_measured import measured

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nodes", nargs="*", metavar="NODE")
    parser.add_argument("--keep-measured", action="store_true", help="renew only what is not measured")
    options = parser.parse_args()
    PAGES.mkdir(parents=True, exist_ok=True)
    (PAGES / "README.md").write_text(index(), encoding="utf-8")
    for name in options.nodes or shipped():
        file = PAGES / f"{name}.md"
        found = measured_part(file.read_text(encoding="utf-8")) if options.keep_measured else measured(name, PAGES)
        file.write_text(page(name, found), encoding="utf-8")
        print(f"wrote {file.relative_to(ROOT)}", flush=True)


if __name__ == "__main__":
    main()
