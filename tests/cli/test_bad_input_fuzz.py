"""Shipped graphs with something changed: the command line answers with an exit code, never a traceback."""

import random
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rendergraph.document.source_file import graph_folder, shipped_graphs
from tests.cli.conftest import Rg

VALUES: list[Any] = [
    None, True, 0, 1, -1, 2**31, 1e308, 0.5, float("nan"), float("inf"), "", "a", "image", "depth", "d32f", "r8ui",
    "../x", "x.png", "\0", "é" * 70, [], [0, 0], [1, 1, 1], [[]], {}, {"a": 1}, {"format": "r8"},
]  # fmt: skip


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of every value inside ``value``."""
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [at, *(found for key, item in inside for found in places(item, (*at, key)))]


def mutate(document: Any, rng: random.Random) -> None:
    """Replace, remove, rename, copy or add one value anywhere."""
    path = rng.choice([p for p in places(document) if p])
    holder = document
    for key in path[:-1]:
        holder = holder[key]
    key, kind = path[-1], rng.choice(["replace", "replace", "remove", "rename", "copy", "add"])
    if kind == "replace":
        holder[key] = rng.choice(VALUES)
    elif kind == "remove":
        del holder[key]
    elif kind == "rename" and isinstance(holder, dict):
        holder[rng.choice(["x", "format", "color", "hdr", "node", "previous", "a b", ""])] = holder.pop(key)
    elif kind == "copy" and isinstance(holder, dict):
        holder[rng.choice(["copy", "image", "hdr"])] = holder[key]
    elif isinstance(holder[key], dict):
        holder[key][rng.choice(["like", "keep", "after", "bytes", "zz"])] = rng.choice(VALUES)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the shipped graphs' folder, shaders and all."""
    path = tmp_path_factory.mktemp("fuzz") / "graphs"
    shutil.copytree(graph_folder(), path)
    return path


@settings(
    max_examples=100, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(name=st.sampled_from(shipped_graphs()), seed=st.integers(0, 2**32), count=st.integers(1, 4))
def test_mutated_graphs(rg: Rg, folder: Path, name: str, seed: int, count: int) -> None:
    document = yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
    if isinstance(document.get("scene"), dict):
        document["scene"] = {"source": "spheres", "detail": 0.0}
    rng = random.Random(seed)
    for _ in range(count):
        mutate(document, rng)
    graph = folder / "mutant.yaml"
    graph.write_text(yaml.safe_dump(document, allow_unicode=True, sort_keys=False), encoding="utf-8")
    validated = rg("validate", str(graph))
    planned = rg("plan", str(graph), "--size", "32x18")
    for outcome in (validated, planned):
        assert outcome.code in (0, 1, 2)
        assert (outcome.code == 0) or ("RG" in outcome.err and "help:" in outcome.err)
    if planned.code == 0:
        assert validated.code == 0  # planning for one scene never accepts what validation refuses


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=st.sampled_from(shipped_graphs()), seed=st.integers(0, 2**32))
def test_mutated_text(rg: Rg, folder: Path, name: str, seed: int) -> None:
    rng = random.Random(seed)
    data = bytearray((folder / f"{name}.yaml").read_bytes())
    for _ in range(rng.randint(1, 5)):
        at = rng.randrange(len(data))
        data[at : at + rng.randint(0, 3)] = rng.choice(
            [b"", b":", b"{", b"]", b"\n", b"\t", b"'", b"\xff", b"*a", b"- "]
        )
    (folder / "mutant.yaml").write_bytes(data)
    outcome = rg("validate", str(folder / "mutant.yaml"))
    assert outcome.code in (0, 1, 2)
    assert outcome.code == 0 or "help:" in outcome.err
