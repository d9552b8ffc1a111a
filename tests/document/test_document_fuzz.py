"""Whatever the bytes are, loading them ends in a document or in a ``RenderGraphError``, and its text can be shown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sample_graph import GRAPH

from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.document.render_text import diagnostic_json, format_diagnostics

SHIPPED_LIKE = """\
rendergraph: 1
title: Fuzz
frame: {size: [64, 32], count: 2, seed: 1, depth: reversed}
scene:
  source: atrium
  camera: {position: [4, 1.7, 0], target: [0, 1.5, 0], fov: 60, near: 0.05}
  lights: {sun: {direction: [-0.3, -1, -0.2]}, list: [{position: [0, 1, 0]}, {position: [0, 1, 0], inner: 5}]}
resources:
  first: {format: rgba8, scale: 0.5}
  last: {previous: first}
passes:
  blur: &b {node: blur, read: {color: first}, write: {color: image}, set: {radius: 2, offset: [1, 2]}}
  again: {<<: *b, keep: true, after: [blur]}
barriers: [{resource: first, after: blur, before: again, kind: texture_fetch}]
outputs: {image: {file: image.png}}
budget: {frame_ms: 16}
"""
FUZZ = settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)

_fragments = st.sampled_from(
    [*"{}[]|>#'\"\t", ": ", "\n", "- ", "&b ", "*b", "<<: ", "? ", "!x ", "---\n", "  ", "010", "1e400", "yes", "~",
     "null", ".nan", "1e-3", "\ufeff", "\x00", "\x85", "\u2028", "é", "🙂", "%YAML 1.1\n"]
)  # fmt: skip
_scalars = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["blur", "image"])
)
_values = st.recursive(
    _scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6) | _scalars, inner, max_size=3),
    max_leaves=6,
)


def survives(path: Path, data: bytes, *overrides: str) -> bool:
    """Whether it loads; if not, the diagnostics are shown and their places checked."""
    path.write_bytes(data)
    failure: RenderGraphError | None = None
    try:
        load_document(path, overrides)
    except RenderGraphError as error:
        failure = error
    if failure is None:
        return True
    assert failure.diagnostics
    assert failure.exit_code in (1, 2)
    assert format_diagnostics(failure.diagnostics)
    lines = sum(data.count(end) for end in (b"\n", b"\r", b"\xc2\x85", b"\xe2\x80")) + 2
    for found in failure.diagnostics:
        assert diagnostic_json(found)["line"]
        assert found.position is not None
        assert 1 <= found.position.line <= lines
        assert found.position.column >= 1
    return False


@pytest.fixture
def path(tmp_path: Path, made_nodes: None) -> Path:
    return tmp_path / "graph.yaml"


def test_unchanged_it_loads(path: Path) -> None:
    assert survives(path, SHIPPED_LIKE.encode())


@FUZZ
@given(st.binary(max_size=200))
def test_random_bytes(path: Path, data: bytes) -> None:
    survives(path, data)


@FUZZ
@given(st.lists(_fragments | st.text(max_size=5), max_size=30))
def test_random_text(path: Path, parts: list[str]) -> None:
    survives(path, "".join(parts).encode("utf-8", "surrogatepass"))


@FUZZ
@given(st.data())
def test_mutated_text(path: Path, data: st.DataObject) -> None:
    text = SHIPPED_LIKE
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 12)))
        text = text[:start] + data.draw(_fragments | st.text(max_size=4)) + text[end:]
    survives(path, text.encode("utf-8", "replace"))


def _spots(value: Any, loc: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [loc, *(spot for key, item in inner for spot in _spots(item, (*loc, key)))]


@FUZZ
@given(st.data())
def test_mutated_values(path: Path, data: st.DataObject) -> None:
    document = yaml.safe_load(SHIPPED_LIKE)
    for _ in range(data.draw(st.integers(1, 3))):
        spots = _spots(document)[1:]
        if not spots:
            break
        *parents, last = data.draw(st.sampled_from(spots))
        target = document
        for part in parents:
            target = target[part]
        action = data.draw(st.sampled_from(["replace", "delete", "rename"]))
        if action == "replace":
            target[last] = data.draw(_values)
        elif action == "delete":
            del target[last]
        elif isinstance(target, dict):
            target[data.draw(_scalars)] = target.pop(last)
    survives(path, yaml.safe_dump(document, allow_unicode=True).encode())


@FUZZ
@given(
    st.lists(
        st.sampled_from(["frame", "size", "passes", "blur", "set", "radius", "0", "", "outputs", "é", "="]), max_size=5
    ),
    st.text(max_size=12),
)
def test_random_overrides(path: Path, words: list[str], value: str) -> None:
    survives(path, GRAPH.encode(), f"{'.'.join(words)}={value}")
