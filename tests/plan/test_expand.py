"""Expansion of graphs without mistakes: sizes, kinds, internal targets, decisions."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from toy_nodes import graph, install_toys, reasons, write

from rendergraph.document.load import load_document, shipped_graphs
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import BufferDesc, Graph, Kind, Target, TextureDesc
from rendergraph.scene.features import SceneFeatures


@pytest.fixture(autouse=True)
def _toys(monkeypatch: pytest.MonkeyPatch) -> None:
    install_toys(monkeypatch)


def desc(found: Graph, name: str) -> TextureDesc:
    value = found.resources[name].desc
    assert isinstance(value, TextureDesc)
    return value


CHAIN = """
frame: {size: [101, 50]}
resources:
  a: {format: rgba16f, scale: 0.5}
  b: {like: a, scale: 0.5, mips: 0}
  c: {like: b, format: rgba8, layers: 3}
  d: {format: rgba16f, fixed: [7, 9], mips: 2}
  e: {like: d, samples: 4}
passes:
  all: {node: draw, write: {a: a}, set: {vertex: v.vert, fragment: f.frag, vertices: 3}}
  b: {node: clear, write: {target: b}}
  c: {node: clear, write: {target: c}}
  d: {node: clear, write: {target: d}}
  e: {node: clear, write: {target: e}}
outputs: {a: {file: a.exr}}
"""


def test_sizes_follow_scale_like_and_fixed(tmp_path: Path) -> None:
    (tmp_path / "v.vert").touch()
    (tmp_path / "f.frag").touch()
    found = graph(tmp_path, CHAIN)
    # 101 x 50 halved and rounded up, then halved again; a chain of 26 texels has 5 levels
    assert desc(found, "a") == TextureDesc("rgba16f", 51, 25)
    assert desc(found, "b") == TextureDesc("rgba16f", 26, 13, mips=5)
    assert desc(found, "c") == TextureDesc("rgba8", 26, 13, layers=3, target=Target.D2_ARRAY)
    assert desc(found, "d") == TextureDesc("rgba16f", 7, 9, mips=2)
    assert desc(found, "e") == TextureDesc("rgba16f", 7, 9, samples=4)


def test_size_and_frames_replace_the_files(tmp_path: Path) -> None:
    (tmp_path / "v.vert").touch()
    (tmp_path / "f.frag").touch()
    found = graph(tmp_path, CHAIN, size=(16, 8), frames=3)
    assert (found.frame.width, found.frame.height, found.frame.count) == (16, 8, 3)
    assert desc(found, "b") == TextureDesc("rgba16f", 4, 2, mips=3)


def test_a_long_like_chain_needs_no_recursion(tmp_path: Path) -> None:
    links = {f"r{i}": {"like": f"r{i - 1}"} for i in range(3000, 0, -1)}
    document = {"resources": {**links, "r0": {"format": "rgba16f", "fixed": [3, 4]}}}
    document |= {"passes": {"p": {"node": "toy_maker", "write": {"color": "r3000"}}}}
    document |= {"outputs": {"r3000": {"file": "a.npy"}}}
    assert desc(graph(tmp_path, yaml.safe_dump(document)), "r3000") == TextureDesc("rgba16f", 3, 4)


@pytest.mark.parametrize(
    ("node", "file", "entry", "format"),
    [
        ("toy_maker", "a.png", "", "rgba16f"),  # the writing port's first
        ("toy_maker", "a.png", ", format: rgba8", "rgba8"),
        ("fullscreen", "a.png", "", "rgba8"),  # an open port: what fits the file
        ("fullscreen", "a.exr", "", "rgba16f"),
    ],
)
def test_undeclared_outputs_get_a_format(tmp_path: Path, node: str, file: str, entry: str, format: str) -> None:
    (tmp_path / "x.frag").touch()
    params = ", set: {shader: x.frag}" if node == "fullscreen" else ""
    text = (
        f"passes: {{p: {{node: {node}, write: {{color: image}}{params}}}}}\noutputs: {{image: {{file: {file}{entry}}}}}"
    )
    found = graph(tmp_path, text)
    assert desc(found, "image") == TextureDesc(format, 1280, 720)
    assert reasons(found.decisions, "image") == {"output_undeclared", "kept_for_output"}


HISTORY = """
resources:
  hdr: {format: rgba16f}
  last: {previous: hdr}
  spare: {format: rgba16f}
  spare_last: {previous: spare}
passes:
  make: {node: toy_filter, read: {color: last}, write: {color: hdr}}
  other: {node: toy_filter, read: {color: hdr}, write: {color: spare}}
  show: {node: toy_filter, read: {color: spare}, write: {color: image}}
outputs: {image: {file: a.exr}}
"""


def test_history_makes_its_source_persistent(tmp_path: Path) -> None:
    found = graph(tmp_path, HISTORY)
    kinds = {name: r.kind for name, r in found.resources.items()}
    # spare_last is connected to nothing: it is dropped, and spare stays transient
    assert kinds == {
        "hdr": Kind.PERSISTENT, "last": Kind.HISTORY, "spare": Kind.TRANSIENT, "image": Kind.PERSISTENT,
    }  # fmt: skip
    assert found.resources["last"].previous_of == "hdr"
    assert found.resources["last"].desc == found.resources["hdr"].desc
    assert "kept_for_history" in reasons(found.decisions, "hdr")


def test_history_of_a_buffer_and_of_an_undeclared_output(tmp_path: Path) -> None:
    text = """
resources: {state: {bytes: 64}, before: {previous: state}, last: {previous: image}}
passes:
  a: {node: copy, read: {source: before}, write: {destination: state}}
  b: {node: toy_filter, read: {color: last, table: state}, write: {color: image}}
outputs: {image: {file: a.exr}}
"""
    found = graph(tmp_path, text)
    assert found.resources["before"].desc == BufferDesc(64)
    assert found.resources["state"].kind is Kind.PERSISTENT
    assert desc(found, "last") == desc(found, "image")


INTERNAL = """
frame: {size: [64, 32]}
passes:
  a_reader: {node: toy_peek, read: {a: maker.half}, write: {color: image}}
  maker: {node: toy_inner, write: {color: made}, keep: true}
resources: {made: {format: rgba16f}}
outputs: {image: {file: a.exr}, maker.cut: {file: cut.npy}}
"""


def test_internal_targets_can_be_read_and_output(tmp_path: Path) -> None:
    found = graph(tmp_path, INTERNAL + "scene: {source: atrium}")
    assert desc(found, "maker.half") == TextureDesc("rgba16f", 32, 16)
    assert not found.resources["maker.half"].declared
    assert found.resources["maker.half"].kind is Kind.TRANSIENT
    assert found.resources["maker.cut"].kind is Kind.PERSISTENT
    assert [a.resource for a in found.passes["a_reader"].subpasses[0].accesses] == ["image", "maker.half"]


@pytest.mark.parametrize(
    ("options", "steps"),
    [
        ({}, 3),  # no scene loaded: everything is assumed
        ({"features": SceneFeatures(masked=True)}, 3),
        ({"features": SceneFeatures()}, 2),
        ({"features": SceneFeatures(), "full": True}, 3),
    ],
)
def test_specialisation(tmp_path: Path, options: dict[str, Any], steps: int) -> None:
    text = "scene: {source: atrium}\npasses: {p: {node: toy_inner, write: {color: i}}}\noutputs: {i: {file: a.exr}}"
    found = graph(tmp_path, text, **options)
    assert len(found.passes["p"].subpasses) == steps
    assert ("scene_lacks_feature" in reasons(found.decisions, "p.cut")) == (steps == 2)


def test_a_graph_without_a_scene_has_no_features(tmp_path: Path) -> None:
    text = "passes: {p: {node: toy_inner, write: {color: i}}}\noutputs: {i: {file: a.exr}}"
    found = graph(tmp_path, text)
    assert found.features is None
    assert len(found.passes["p"].subpasses) == 2


def test_barriers_are_carried_over(tmp_path: Path) -> None:
    base = "passes: {p: {node: toy_inner, write: {color: i}}}\noutputs: {i: {file: a.exr}}\n"
    assert graph(tmp_path, base).barriers is None
    found = graph(tmp_path, base + "barriers: [{resource: p.half, after: p.down, before: p, kind: texture_fetch}]")
    assert found.barriers is not None
    assert [(b.resource, b.after, b.before, b.kind) for b in found.barriers] == [
        ("p.half", "p.down", "p", "texture_fetch")
    ]
    assert graph(tmp_path, base + "barriers: []").barriers == ()


def test_a_resource_only_referred_to_by_like_is_no_warning_and_not_allocated(tmp_path: Path) -> None:
    text = """
resources: {size: {format: r8, fixed: [5, 5]}, made: {like: size, format: rgba16f}}
passes: {p: {node: toy_maker, write: {color: made}}}
outputs: {made: {file: a.exr}}
"""
    found, warnings = expand(write(tmp_path, text))
    assert warnings == ()
    assert set(found.resources) == {"made"}


def _content(found: Graph) -> Graph:
    """A graph without its places in the file."""
    resources = {name: replace(r, position=None) for name, r in found.resources.items()}
    passes = {
        name: replace(p, position=None, subpasses=tuple(replace(s, position=None) for s in p.subpasses))
        for name, p in found.passes.items()
    }
    return replace(found, resources=resources, passes=passes)


@pytest.mark.parametrize("seed", range(5))
def test_shuffled_passes_and_resources_give_the_same_graph(tmp_path: Path, seed: int) -> None:
    data = yaml.safe_load(
        HISTORY + INTERNAL.replace("passes:", "more:").replace("outputs:", "x:").split("resources")[0]
    )
    data["passes"] |= data.pop("more")
    data["passes"]["a_reader"]["write"] = {"color": "peeked"}
    data["passes"]["maker"]["write"] = {"color": "peeked2"}
    data["resources"] |= {"peeked": {"format": "rgba16f"}, "peeked2": {"format": "rgba16f"}}
    expected = graph(tmp_path, yaml.safe_dump(data, sort_keys=False))
    chance = random.Random(seed)
    for section in ("passes", "resources"):
        items = list(data[section].items())
        chance.shuffle(items)
        data[section] = dict(items)
    found = graph(tmp_path, yaml.safe_dump(data, sort_keys=False))
    assert _content(found) == _content(expected)
    assert list(found.passes) == list(expected.passes)
    assert list(found.resources) == list(expected.resources)


@pytest.mark.parametrize("name", shipped_graphs())
def test_shipped_graphs_expand_without_a_scene(name: str) -> None:
    found, _ = expand(load_document(name))
    assert found.passes


def test_an_internal_error_keeps_its_cause(tmp_path: Path) -> None:
    text = "passes: {p: {node: toy_raises, write: {color: i}}}\noutputs: {i: {file: a.exr}}"
    with pytest.raises(RenderGraphError) as caught:
        graph(tmp_path, text)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert caught.value.diagnostics[0].data["node"] == "toy_raises"
