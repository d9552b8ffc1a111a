"""The garbage collector pauses while documents and plans are built, and is left as it was found."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from pathlib import Path
from threading import Barrier, Thread
from typing import Any

import pytest

from rendergraph.document import load as load_module
from rendergraph.document.collector import collector_paused
from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan import compile as compile_module
from rendergraph.plan import expand as expand_module
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand

GRAPH = """\
rendergraph: 1
frame: {size: [4, 4]}
passes:
  p: {node: fullscreen, write: {o: image}, set: {shader: fill.frag}}
outputs: {image: {file: a.png}}
"""


@pytest.fixture(autouse=True)
def collector_restored() -> Iterator[None]:
    was_on = gc.isenabled()
    gc.enable()
    yield
    (gc.enable if was_on else gc.disable)()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "fill.frag").write_text("void main() {}\n")
    (tmp_path / "graph.yaml").write_text(GRAPH)
    return tmp_path / "graph.yaml"


def test_off_inside_and_on_after() -> None:
    with collector_paused():
        assert not gc.isenabled()
        with collector_paused():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()


def test_who_switched_it_off_finds_it_off() -> None:
    gc.disable()
    with collector_paused():
        assert not gc.isenabled()
    assert not gc.isenabled()


def test_on_again_after_an_error() -> None:
    with pytest.raises(KeyError), collector_paused():
        raise KeyError
    assert gc.isenabled()


def test_on_again_when_two_threads_are_through() -> None:
    meet = Barrier(2)

    def work() -> None:
        for _ in range(50):
            meet.wait()
            with collector_paused():
                pass

    threads = [Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert gc.isenabled()


@pytest.mark.parametrize(
    ("module", "inside"),
    [(load_module, "read_yaml"), (expand_module, "undeclared_outputs"), (compile_module, "verify")],
)
def test_loading_and_planning_pause_it(module: Any, inside: str, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []
    original = getattr(module, inside)

    def spy(*args: Any) -> Any:
        seen.append(gc.isenabled())
        return original(*args)

    monkeypatch.setattr(module, inside, spy)
    document = load_document(path)
    assert gc.isenabled()
    graph, _ = expand(document)
    assert gc.isenabled()
    compile_plan(graph)
    assert gc.isenabled()
    assert seen == [False]


def test_a_refused_file_leaves_it_on(path: Path) -> None:
    path.write_text(GRAPH.replace("fullscreen", "no_such_node"))
    with pytest.raises(RenderGraphError):
        load_document(path)
    assert gc.isenabled()
