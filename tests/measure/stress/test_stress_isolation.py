"""A process that dies or hangs costs one extreme."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from rendergraph.measure.stress.stress import StressOptions, stress
from rendergraph.node.discovery import find_node, node_names, try_node
from rendergraph.report.stress import stress_findings

pytestmark = pytest.mark.gpu

NODE = '''
"""Crashes in a frame of one texel, and hangs in one of three."""

import os
import signal
import time

from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params


class CrasherParams(Params):
    """None."""


class Crasher(Node[CrasherParams]):
    """Clears."""

    outputs = {"color": Port("Image.", formats=("rgba8",))}

    def build(self, b):
        if b.frame.width == 1:
            os.kill(os.getpid(), signal.SIGSEGV)
        if b.frame.width == 3:
            time.sleep(600)
        b.clear("clear", b.output("color"), (0.0, 0.0, 0.0, 1.0))
'''

GRAPH = """\
rendergraph: 1
frame: {size: [4, 4]}
passes: {test: {node: crasher, write: {color: image}}}
outputs: {image: {file: image.png}}
"""


@pytest.fixture
def graph(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A graph of an installed node: a package with metadata, which a child process finds, too."""
    root = tmp_path / "site"
    (root / "crasher_package").mkdir(parents=True)
    (root / "crasher_package" / "__init__.py").write_text(NODE)
    meta = root / "crasher-1.0.dist-info"
    meta.mkdir()
    (meta / "METADATA").write_text("Metadata-Version: 2.1\nName: crasher\nVersion: 1.0\n")
    (meta / "entry_points.txt").write_text("[rendergraph.nodes]\ncrasher = crasher_package\n")
    monkeypatch.syspath_prepend(str(root))
    monkeypatch.setenv("PYTHONPATH", str(root), prepend=":")
    for cached in (node_names, find_node, try_node):
        cached.cache_clear()
    importlib.invalidate_caches()
    file = tmp_path / "graph.yaml"
    file.write_text(GRAPH)
    yield file
    for cached in (node_names, find_node, try_node):
        cached.cache_clear()


def test_a_crash_and_a_hang_are_contained(graph: Path) -> None:
    only = ("as_written", "frame_1x1", "frame_3x5", "frame_odd")
    report = stress(str(graph), StressOptions(only=only, timeout=5.0))
    assert [c.state for c in report.cases] == ["ran", "crashed", "timed_out", "ran"]
    assert "signal 11" in report.cases[1].text
    assert [d.code for d in stress_findings(report)] == ["RG772", "RG772"]
    assert report.renderer
