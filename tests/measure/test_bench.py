"""`rg bench` end to end on a graph of one pass: the record, its design, interruption, and workers that fail."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure import bench_process
from rendergraph.measure.bench import Bench, bench_sides
from rendergraph.measure.bench_job import BenchJob, Side
from rendergraph.measure.bench_worker import plain
from rendergraph.report.bench_table import bench_tables
from rendergraph.report.read_records import read_pair, read_record

pytestmark = pytest.mark.gpu

SHADER = """#version 450
uniform int u_steps;
out vec4 c;
void main() { float x = gl_FragCoord.x; for (int i = 0; i < u_steps; ++i) x = fract(x * 1.7); c = vec4(x); }
"""
GRAPH = """rendergraph: 1
frame: {size: [96, 54]}
passes:
  p: {node: fullscreen, write: {c: image}, set: {shader: p.frag, uniforms: {u_steps: 50}}}
outputs: {image: {file: image.png}}
"""


@pytest.fixture
def graph(tmp_path: Path) -> str:
    (tmp_path / "p.frag").write_text(SHADER)
    (tmp_path / "g.yaml").write_text(GRAPH)
    return str(tmp_path / "g.yaml")


def test_two_sides(graph: str, tmp_path: Path) -> None:
    heavy = ("passes.p.set.uniforms.u_steps=4000",)
    job = BenchJob(bench_sides([graph], a=(), b=heavy), processes=2, blocks=2, frames=3, bound=True)
    seen: list[tuple[int, int]] = []
    bench = Bench(job)
    bench.run(lambda stage, done, total: seen.append((done, total)))
    record = bench.record()
    assert record["complete"]
    assert [(b["process"], b["order"]) for b in record["blocks"]] == [(0, "AB"), (0, "BA"), (1, "BA"), (1, "AB")]
    for block in record["blocks"]:
        for side in "AB":
            assert len(block[side]["frame_ms"]) == len(block[side]["passes"]["p"]) == 3
            assert block[side]["subpasses"] == {"p.draw": block[side]["passes"]["p"]}
            assert min(block[side]["frame_ms"]) > 0
    assert record["sides"]["B"]["set"] == list(heavy)
    for side in "AB":
        facts = record["sides"][side]
        assert facts["size"] == [96, 54]
        assert facts["passes"][0]["counters"]["draws"] == 1
        assert facts["steady_state"] == {"objects_created": 0, "programs_compiled": 0, "bytes_uploaded": 0}
        assert len(facts["once_ms"]) == 2
        assert facts["resources"]["order"] == ["p.draw"]
        warm_up = record["warm_up"][side]
        assert [w["process"] for w in warm_up] == [0, 1]
        assert all(len(w["frame_ms"]) == w["frames"] >= 9 for w in warm_up)
    done, total = seen[-1]
    assert done == total, "the bar ends where it said it would"
    assert [d for d, _ in seen] == sorted(d for d, _ in seen)
    # eighty times the steps is slower beyond doubt, and nothing but pixels
    middle = {s: sorted(v for b in record["blocks"] for v in b[s]["passes"]["p"])[6] for s in "AB"}
    assert middle["B"] > 3 * middle["A"]
    bound = record["bound"]["B"]
    assert bound["class"] == "gpu"
    assert bound["evidence"]["half_resolution"] < 0.75
    assert bound["evidence"]["no_readback"] is None
    assert set(bound["runs"]) == {"base", "half_resolution", "nothing_rasterised", "no_draws"}
    list(bench_tables(record))
    (tmp_path / "b.json").write_text(json.dumps(record))
    a, b = read_pair(str(tmp_path / "b.json"))
    assert a.times is not None
    assert b.times is not None
    assert list(b.times.steps) == ["p.draw"]
    assert b.times.bound is not None
    assert b.times.bound.bound_by == "gpu"
    assert record["driver_warnings"] == []


def test_what_the_driver_warned_of_is_told_once_for_all_processes(graph: str) -> None:
    bench = Bench(BenchJob(bench_sides([graph])))
    heard = diagnose("RG507", None, where=" in p", what="", detail="undefined", scope="p", resource="")
    for process in range(3):
        bench._take({"event": "warnings", "data": [plain(heard)]}, process, False)
    assert bench.findings() == [heard]
    assert bench.record()["driver_warnings"] == [{"text": "undefined", "subpass": "p", "resource": ""}]


def test_one_side_is_a_stored_baseline(graph: str, tmp_path: Path) -> None:
    bench = Bench(BenchJob(bench_sides([graph]), processes=1, blocks=1, frames=1, size=(8, 8)))
    bench.run()
    record = bench.record()
    assert record["blocks"][0]["order"] == "A"
    assert set(record["blocks"][0]) == {"process", "order", "A"}
    (tmp_path / "b.json").write_text(json.dumps(record))
    assert read_record(str(tmp_path / "b.json")).times is not None
    list(bench_tables(record))


def test_too_few_warm_up_frames_are_told(graph: str) -> None:
    bench = Bench(BenchJob(bench_sides([graph]), processes=1, blocks=1, frames=1, size=(8, 8), most_warm_up=3))
    bench.run()
    assert [d.code for d in bench.findings()] == ["RG582"]
    assert bench.record()["warm_up"]["A"][0]["steady_from"] is None
    assert bench.record()["warm_up"]["A"][0]["frames"] == 3


def test_sides() -> None:
    assert bench_sides(["g"], ("x=1",)) == {"A": Side("g", ("x=1",))}
    assert bench_sides(["g"], ("x=1",), ("y=1",)) == {"A": Side("g", ("x=1", "y=1")), "B": Side("g", ("x=1",))}
    assert bench_sides(["g", "h"], b=("y=2",)) == {"A": Side("g"), "B": Side("h", ("y=2",))}
    with pytest.raises(RenderGraphError) as error:
        bench_sides(["a", "b", "c"])
    assert error.value.diagnostics[0].code == "RG581"
    assert error.value.exit_code == 2


def test_a_job_survives_the_journey() -> None:
    job = BenchJob(bench_sides(["g", "h"], ("x=1",)), 2, 3, 4, (5, 6), "cornell", True, 1, 9, True)
    assert BenchJob.from_json(json.loads(json.dumps(job.to_json()))) == job


def test_a_mistake_in_a_graph_is_told_before_anything_runs(graph: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_process, "run_worker", None)
    with pytest.raises(RenderGraphError) as error:
        Bench(BenchJob(bench_sides([graph], b=("passes.q.set.x=1",))))
    assert error.value.diagnostics[0].code == "RG131"


def test_a_worker_s_mistake_comes_with_its_place(graph: str, tmp_path: Path) -> None:
    (tmp_path / "p.frag").write_text("#version 450\nout vec4 c;\nvoid main() { c = vec5(1); }\n")
    bench = Bench(BenchJob(bench_sides([graph]), processes=1))
    with pytest.raises(RenderGraphError) as error:
        bench.run()
    (found,) = error.value.diagnostics[:1]
    assert found.code == "RG515"
    assert found.position is not None
    assert found.position.line == 3
    assert error.value.exit_code == 1
    assert not bench.record()["complete"]


def test_a_worker_that_dies_is_told(graph: str, monkeypatch: pytest.MonkeyPatch) -> None:
    real = subprocess.Popen

    def dying(command: list[str], **options: Any) -> Any:
        return real([sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"], **options)

    monkeypatch.setattr(bench_process.subprocess, "Popen", dying)
    with pytest.raises(RenderGraphError) as error:
        Bench(BenchJob(bench_sides([graph]), processes=1)).run()
    assert error.value.diagnostics[0].code == "RG580"
    assert "signal 9" in error.value.diagnostics[0].data["reason"]


def test_ctrl_c_keeps_what_is_complete(graph: str, tmp_path: Path) -> None:
    """A real interrupt of a real run: the file is whole JSON, and no worker is left behind."""
    out = tmp_path / "out" / "b.json"
    arguments = ["bench", graph, "-o", str(out), "--processes", "100", "--blocks", "2", "--frames", "2"]
    script = "import sys; from rendergraph.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", script, *arguments], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        deadline = time.monotonic() + 60
        seen: set[str] = set()
        while len(seen) < 2 and time.monotonic() < deadline:  # the second worker: the first one's blocks are complete
            seen.update(_worker_blocks(process.pid))
            time.sleep(0.05)
        os.kill(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=30)
    finally:
        if process.poll() is None:
            process.kill()
    assert process.returncode == 130
    assert "Traceback" not in errors
    record = json.loads(out.read_text())
    assert not record["complete"]
    assert record["blocks"]
    assert all(len(block["A"]["frame_ms"]) == 2 for block in record["blocks"])
    assert [p.name for p in out.parent.iterdir()] == ["b.json"]
    read_record(str(out))
    assert not _worker_blocks(process.pid)


def _worker_blocks(parent: int) -> list[str]:
    """Children of a process, by the kernel's own list."""
    try:
        return Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    except OSError:
        return []
