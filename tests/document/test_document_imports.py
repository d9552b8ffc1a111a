"""Validating a graph must not pay for numpy or OpenGL."""

from __future__ import annotations

import subprocess
import sys

from rendergraph.document.source_file import shipped_graphs

PROGRAM = """
import sys
from rendergraph.document.load import load_document
for name in sys.argv[1:]:
    load_document(name)
heavy = {"numpy", "moderngl", "glcontext", "PIL", "jinja2", "rich", "typer"} & set(sys.modules)
sys.exit(f"imported {heavy}" if heavy else 0)
"""


def test_loading_every_shipped_graph_imports_nothing_heavy() -> None:
    graphs = shipped_graphs()
    assert graphs
    done = subprocess.run([sys.executable, "-c", PROGRAM, *graphs], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
