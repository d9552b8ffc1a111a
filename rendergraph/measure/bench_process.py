"""Starts a worker process of `rg bench`, and hands on its events."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import rendergraph
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.measure.bench_job import BenchJob
from rendergraph.plan.graph import Position

_TOLD = 400  # characters of a dead worker's last words


def run_worker(job: BenchJob, process: int, *, bound: bool) -> Iterator[dict[str, Any]]:
    """Events of one fresh process, as they come; see :mod:`rendergraph.measure.bench_worker`. The process ends with
    the iteration, however that ends.

    :raises RenderGraphError: the worker's own; RG580 when it died without one.
    """
    request = {"job": replace(job, bound=bound).to_json(), "process": process}
    root = str(Path(rendergraph.__file__).resolve().parent.parent)
    paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    with tempfile.TemporaryFile() as words:
        # A session of its own: Ctrl-C in the terminal reaches this process alone, which ends the worker.
        worker = subprocess.Popen(
            [sys.executable, "-P", "-m", "rendergraph.measure.bench_worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=words,
            text=True,
            encoding="utf-8",
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        )
        try:
            assert worker.stdin is not None
            assert worker.stdout is not None
            try:
                worker.stdin.write(json.dumps(request))
                worker.stdin.close()
            except BrokenPipeError:
                pass  # it died at once; what it left to say follows
            for line in worker.stdout:
                event = json.loads(line)
                if event["event"] == "error":
                    raise RenderGraphError([diagnostic(d) for d in event["diagnostics"]], event["exit_code"])
                yield event
            code = worker.wait()
            if code != 0:
                words.seek(0)
                last = words.read().decode("utf-8", "replace").strip()[-_TOLD:]
                raise RenderGraphError([diagnose("RG580", process=process + 1, reason=_end(code, last))], exit_code=3)
        finally:
            if worker.poll() is None:
                worker.kill()
            worker.wait()
            for stream in (worker.stdin, worker.stdout):
                if stream is not None and not stream.closed:
                    stream.close()


def _end(code: int, last: str) -> str:
    how = f"it was ended by signal {-code}" if code < 0 else f"it ended with code {code}"
    return f"{how}: {last}" if last else how


def diagnostic(data: dict[str, Any]) -> Diagnostic:
    """A diagnostic as :func:`rendergraph.measure.bench_worker.plain` sent it."""
    position = Position(**data["position"]) if data["position"] else None
    return Diagnostic(data["code"], data["severity"], data["text"], data["help"], position, data["data"])
