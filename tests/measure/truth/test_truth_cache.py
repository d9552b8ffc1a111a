"""Truths on disk: kept by content, whole or not at all, for many processes, within a limit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rendergraph.document.scene_models import SceneModel
from rendergraph.measure.truth import cache_folder as folder_module
from rendergraph.measure.truth.cache import TruthCache, open_cache
from rendergraph.measure.truth.cache_folder import cache_folder, evict, folder_bytes
from rendergraph.measure.truth.fingerprint import fingerprint
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun, Truth
from rendergraph.plan.graph import Frame
from rendergraph.scene.load import load_scene
from rendergraph.scene.scene import Camera
from tests.measure.truth.made_up_runs import Judge, image, run
from tests.measure.truth.slope_node import SLOPE, SLOPE_REFERENCE

TRUTH = Truth(image(0.5), image(0.25), np.eye(4, 6, dtype=bool), image(0.01), 0.125)


class Asked:
    """A cache in a folder, a node whose reference is a file, and how often truths were computed."""

    def __init__(self, folder: Path, node: Any) -> None:
        self.folder = folder
        self.node = node
        self.count = 0

    def __call__(self, seen: PassRun, judge: Judge | None = None) -> Mapping[str, Truth]:
        def compute(inner: PassRun) -> Mapping[str, Truth]:
            self.count += 1
            return judge(inner) if judge is not None else {"it": TRUTH}

        return TruthCache(self.folder).recall(self.node, seen, compute)[0].truths

    def computes(self, seen: PassRun, judge: Judge | None = None) -> bool:
        before = self.count
        self(seen, judge)
        return self.count > before


@pytest.fixture
def ask(install: Any, tmp_path: Path) -> Asked:
    install("slope", {"__init__.py": SLOPE, "reference.py": SLOPE_REFERENCE})
    return Asked(tmp_path / "cache", find_node("slope"))


def test_what_comes_back_is_what_was_stored(ask: Asked) -> None:
    first, second = ask(run({"out": image()})), ask(run({"out": image()}))
    assert ask.count == 1
    for found in (first["it"], second["it"]):
        assert found.tolerance == 0.125
        for part in ("value", "judged", "mask", "standard_error"):
            np.testing.assert_array_equal(getattr(found, part), getattr(TRUTH, part))
            assert getattr(found, part).dtype == getattr(TRUTH, part).dtype
    plain = ask(run({"out": image()}, gain=2.0), lambda run: {"it": Truth(image())})
    again = ask(run({"out": image()}, gain=2.0))
    for found in (plain["it"], again["it"]):
        assert (found.judged, found.mask, found.tolerance) == (None, None, None)
    assert ask.count == 2


SCENE = load_scene(SceneModel(source="cornell"), Path(), frame_seed=0).scene


def _brighter() -> Any:
    other = replace(SCENE, positions=SCENE.positions.copy())
    other.positions[0, 0] += 1e-3
    return other


BASE: dict[str, Any] = {"inputs": {"x": image(1.0)}, "before": {"out": image()}, "scene": SCENE, "index": 3}


@pytest.mark.parametrize(
    "change",
    [
        {"inputs": {"x": image(1.0 + 1e-15)}},
        {"inputs": {"y": image(1.0)}},
        {"inputs": {"x": image(1.0, (6, 4, 1))}},
        {"inputs": {"x": image(1.0).astype(np.float32)}},
        {"before": {"out": image(1.0)}},
        {"gain": 2.0},
        {"frame": Frame(6, 4, seed=1)},
        {"index": 4},
        {"scene": None},
        {"scene": _brighter()},
        {"camera": Camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))},
        {"format": "rgba16f"},
    ],
    ids=lambda change: "-".join(change),
)
def test_whatever_the_truth_may_depend_on_makes_it_another(ask: Asked, change: dict[str, Any]) -> None:
    assert ask.computes(run({"out": image()}, **BASE))
    assert not ask.computes(run({"out": image()}, **BASE))
    assert ask.computes(run({"out": image()}, **BASE | change))


def test_the_references_own_source_and_its_imports_count(install: Any, ask: Asked) -> None:
    assert ask.computes(run({"out": image()}))
    install("slope", {"slope.frag": "another shader"})
    assert not ask.computes(run({"out": image()}))
    install("slope", {"tables.py": "X = 1"})
    assert ask.computes(run({"out": image()}))
    install("slope", {"tables.py": "X = 2"})
    assert ask.computes(run({"out": image()}))


def test_a_file_that_a_parameter_names_counts(ask: Asked, tmp_path: Path) -> None:
    from rendergraph.node.params import Params

    class Named(Params):
        shader: str = "a.frag"

    (tmp_path / "a.frag").write_text("one")
    seen = replace(run({"out": image()}), params=Named(), folder=tmp_path)
    assert ask.computes(seen)
    assert not ask.computes(seen)
    (tmp_path / "a.frag").write_text("two")
    assert ask.computes(seen)
    (tmp_path / "a_reference.py").write_text("its truth")
    assert ask.computes(seen)


# ---- what a reference asks for by itself


def test_outputs_count_only_where_the_truth_looks_at_them(ask: Asked) -> None:
    def blind(run: PassRun) -> dict[str, Truth]:
        return {"it": Truth(image())}

    def looks(run: PassRun) -> dict[str, Truth]:
        return {"it": Truth(run.outputs["out"] + 1)}

    assert ask.computes(run({"out": image(), "other": image()}), blind)
    assert not ask.computes(run({"out": image(1.0), "other": image()}), blind)
    assert ask.computes(run({"out": image(), "other": image()}, gain=2.0), looks)
    assert not ask.computes(run({"out": image(), "other": image(9.0)}, gain=2.0), looks)
    assert ask.computes(run({"out": image(1.0), "other": image()}, gain=2.0), looks)
    found = ask(run({"out": image(1.0), "other": image()}, gain=2.0), looks)
    assert found["it"].value.max() == 2.0


def test_a_supersampled_input_counts_by_what_it_shows(ask: Asked) -> None:
    shows = {"value": 1.0}

    def supersampled(port: str, factor: int) -> Any:
        return image(shows["value"] * factor)

    def judge(run: PassRun) -> dict[str, Truth]:
        assert run.supersampled is not None
        return {"it": Truth(run.supersampled("x", 4))}

    seen = run({"out": image()}, supersampled=supersampled)
    assert ask.computes(seen, judge)
    assert not ask.computes(seen, judge)
    shows["value"] = 2.0
    assert ask.computes(seen, judge)


def test_a_known_origin_spares_rendering_the_supersampled_input(ask: Asked) -> None:
    class Rooted:
        rendered = 0

        def __init__(self, content: str) -> None:
            self.content = content

        def __call__(self, port: str, factor: int) -> Any:
            Rooted.rendered += 1
            return image()

    def judge(run: PassRun) -> dict[str, Truth]:
        assert run.supersampled is not None
        return {"it": Truth(run.supersampled("x", 4))}

    for content, expected in (("a", True), ("a", False), ("b", True)):
        assert ask.computes(run({"out": image()}, supersampled=Rooted(content)), judge) is expected
    assert Rooted.rendered == 2


# ---- damage


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[: len(data) // 2],
        lambda data: data[:-1],
        lambda data: b"",
        lambda data: b"not a zip",
        lambda data: data[:300] + bytes([data[300] ^ 1]) + data[301:],
        lambda data: data.replace(b'"measures"', b'"measured"'),
    ],
    ids=["half", "cut", "empty", "foreign", "a bit", "layout"],
)
def test_a_damaged_entry_is_computed_again_and_mended(ask: Asked, damage: Callable[[bytes], bytes]) -> None:
    seen = run({"out": image()})
    ask(seen)
    (path,) = ask.folder.glob("*.npz")
    whole = path.read_bytes()
    assert damage(whole) != whole
    path.write_bytes(damage(whole))
    np.testing.assert_array_equal(ask(seen)["it"].value, TRUTH.value)
    assert ask.count == 2
    assert not ask.computes(seen)


def test_nothing_of_a_pickle_is_run(ask: Asked) -> None:
    seen = run({"out": image()})
    ask(seen)
    (path,) = ask.folder.glob("*.npz")
    np.savez(path, about=np.array([{"a": 1}], dtype=object))
    assert ask.computes(seen)


# ---- other processes

WORKER = """
import sys, time
from pathlib import Path
import numpy as np
from rendergraph.measure.truth import cache
from rendergraph.node.contract import Node
from rendergraph.node.reference import Truth
sys.path.insert(0, {packages!r})
from judged_slope import Slope
from tests.measure.truth.made_up_runs import image, run

large = np.random.default_rng(5).random((300, 400, 3))

def judge(run):
    print("computing", flush=True)
    time.sleep({pause})
    return {{"it": Truth(large)}}

if {slow}:
    savez = np.savez
    def slowly(file, **arrays):
        savez(file, **arrays)
        Path(file).open("r+b").truncate(100_000)
        print("half written", flush=True)
        time.sleep(60)
    cache.np.savez = slowly
made, hit = cache.TruthCache(Path({folder!r})).recall(Slope, run({{"out": image()}}), judge)
print("sum", repr(float(made.truths["it"].value.sum())), flush=True)
"""


def start(folder: Path, packages: Path, *, pause: float = 0.0, slow: bool = False) -> subprocess.Popen[str]:
    text = WORKER.format(folder=str(folder), packages=str(packages), pause=pause, slow=slow)
    root = str(Path(__file__).resolve().parents[3])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(text)], stdout=subprocess.PIPE, text=True, env=environment, cwd=root
    )


def test_processes_that_compute_the_same_at_once_both_succeed(ask: Asked, tmp_path: Path) -> None:
    workers = [start(ask.folder, tmp_path / "packages", pause=1.0) for _ in range(2)]
    said = [worker.communicate(timeout=60)[0].split() for worker in workers]
    assert [worker.returncode for worker in workers] == [0, 0]
    assert said[0][-1] == said[1][-1]
    assert "computing" in said[0]
    assert len(list(ask.folder.glob("*.npz"))) == 1
    assert list(ask.folder.glob(".*")) == []
    third = start(ask.folder, tmp_path / "packages").communicate(timeout=60)[0].split()
    assert "computing" not in third
    assert third[-1] == said[0][-1]


def test_a_process_killed_while_it_writes_leaves_nothing_that_is_read(ask: Asked, tmp_path: Path) -> None:
    worker = start(ask.folder, tmp_path / "packages", slow=True)
    assert worker.stdout is not None
    for line in worker.stdout:
        if "half written" in line:
            break
    worker.send_signal(signal.SIGKILL)
    worker.wait(timeout=30)
    worker.stdout.close()
    (left,) = ask.folder.glob(".*.npz")
    assert list(ask.folder.glob("[!.]*.npz")) == []
    said = start(ask.folder, tmp_path / "packages").communicate(timeout=60)[0].split()
    assert "computing" in said
    os.utime(left, (0, 0))  # long ago
    evict(ask.folder, 1 << 30)
    assert not left.exists()


# ---- the folder


def test_the_least_recently_used_are_given_up_first(ask: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = [run({"out": image()}, gain=float(gain)) for gain in range(1, 5)]
    for index, one in enumerate(seen[:3]):
        ask(one)
        for path in ask.folder.glob("*.npz"):
            os.utime(path, (path.stat().st_atime, path.stat().st_mtime - 10 * (3 - index)))
    assert not ask.computes(seen[0])  # used: now it is the youngest
    size = folder_bytes(ask.folder) // 3

    cache = TruthCache(ask.folder, limit=3 * size + size // 2)
    cache.recall(ask.node, seen[3], lambda run: {"it": TRUTH})
    assert folder_bytes(ask.folder) <= cache.limit
    assert not ask.computes(seen[0])
    assert not ask.computes(seen[2])
    assert ask.computes(seen[1])


def test_what_is_larger_than_the_limit_is_not_kept(ask: Asked) -> None:
    cache = TruthCache(ask.folder, limit=1000)
    cache.recall(ask.node, run({"out": image()}), lambda run: {"it": Truth(image(0.0, (100, 100, 3)))})
    assert folder_bytes(ask.folder) == 0


def test_a_folder_that_cannot_be_written_is_no_error(ask: Asked, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    ask.folder = tmp_path / "file" / "cache"
    assert ask.computes(run({"out": image()}))
    assert ask.computes(run({"out": image()}))


def test_content_that_cannot_be_hashed_is_computed_each_time(ask: Asked) -> None:
    seen = run({"out": image()}, scene=object())
    assert ask.computes(seen)
    assert ask.computes(seen)


def test_where_the_cache_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("RENDERGRAPH_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path / "truth"
    monkeypatch.delenv("RENDERGRAPH_CACHE")
    platformdirs = pytest.importorskip("platformdirs")
    monkeypatch.setattr(platformdirs, "user_cache_path", lambda name: tmp_path / name)
    found = open_cache()
    assert found is not None
    assert found.folder == tmp_path / "rendergraph" / "truth"
    monkeypatch.setitem(sys.modules, "platformdirs", None)
    assert cache_folder() is None
    assert open_cache() is None
    assert folder_module.folder_bytes(tmp_path / "none") == 0


# ---- the fingerprint


def test_equal_content_has_one_fingerprint_and_other_content_another() -> None:
    values: list[Any] = [
        1, 1.0, True, None, "1", b"1", [1], (1, 2), {"a": 1}, {"a": 2}, {"b": 1}, [[1], 2], [1, [2]], ["ab", "c"],
        ["a", "bc"], np.arange(4), np.arange(4.0), np.arange(4).reshape(2, 2), np.zeros(0), np.float32(1.0),
        Frame(1, 2), Frame(2, 1), {1, 2}, float("nan"), Path("a"), [np.zeros(2), np.ones(2)], [np.ones(2), np.zeros(2)],
    ]  # fmt: skip
    prints = [fingerprint(value) for value in values]
    assert len(set(prints)) == len(values)
    assert prints == [fingerprint(value) for value in values]
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})
    strided = np.arange(16).reshape(4, 4)[::2, ::2]
    assert fingerprint(strided) == fingerprint(strided.copy())
    for unknown in (object(), np.array([object()])):
        with pytest.raises(TypeError):
            fingerprint(unknown)


def test_a_hit_is_quick_because_it_computes_nothing(ask: Asked) -> None:
    """By structure: benchmarks/truth_cache.py takes the time."""
    seen = run({"out": image(0.0, (90, 160, 4))}, inputs={"x": image(0.0, (90, 160, 4))})

    def slow(run: PassRun) -> dict[str, Truth]:
        time.sleep(0.3)
        return {"it": Truth(run.inputs["x"])}

    cache = TruthCache(ask.folder)
    made, hit = cache.recall(ask.node, seen, slow)
    again, second = cache.recall(ask.node, seen, slow)
    assert (hit, second, cache.hits, cache.misses) == (False, True, 1, 1)
    assert again.seconds == pytest.approx(made.seconds)
    assert made.seconds >= 0.3


def test_a_measure_is_judged_the_same_from_the_cache(ask: Asked) -> None:
    height = np.random.default_rng(2).random((8, 9, 1))
    normals = image(0.3, (8, 9, 4))
    node = ask.node
    seen = run({"normal": normals}, inputs={"height": height})
    seen = replace(seen, params=node.params_type())
    cache = TruthCache(ask.folder)
    (first,), (second,) = (judge_pass("p", node, seen, cache) for _ in range(2))
    assert (first.cached, second.cached) == (False, True)
    assert replace(first, cached=True) == second
