"""The worker processes of a sweep: each with a context of its own, handed chunk after chunk."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import rendergraph
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.measure.sweep.bench import Overrides
from rendergraph.measure.sweep.chunk import Step
from rendergraph.measure.sweep.job import SweepJob
from rendergraph.measure.sweep.store import ChunkResult, chunk_of_json
from rendergraph.plan.graph import Position

if TYPE_CHECKING:
    from rendergraph.device.context import Device

_TOLD = 400  # characters of a dead worker's last words


def device_facts(device: Device) -> dict[str, Any]:
    """Who measures, as far as times depend on it."""
    return {"renderer": device.info.renderer, "driver": device.info.driver, "threads": os.cpu_count() or 0}


def run_workers(
    job: SweepJob,
    chunks: Sequence[tuple[int, tuple[tuple[int, Overrides], ...]]],
    jobs: int,
    devices: Sequence[int],
    step: Step,
) -> Iterator[tuple[dict[str, Any], ChunkResult]]:
    """Every chunk as it is done, with the device it ran on. The processes end with the iteration, however that ends.

    Those that share a device share its time too: their chunks are marked as contended.

    :raises RenderGraphError: a worker's own; RG761 for one that ended without a word.
    """
    count = min(jobs, len(chunks))
    places = [devices[index % len(devices)] if devices else None for index in range(count)]
    events: queue.Queue[tuple[int, dict[str, Any]]] = queue.Queue()
    waiting = list(chunks)
    workers = []
    try:
        for index, place in enumerate(places):
            workers.append(_Worker(index, job, place, events))
            workers[index].give(waiting.pop(0))
        busy = count
        while busy:
            index, event = events.get()
            if event["event"] == "error":
                raise RenderGraphError([_diagnostic(d) for d in event["diagnostics"]], event["exit_code"])
            if event["event"] == "end":
                reason = workers[index].last_words()
                raise RenderGraphError([diagnose("RG761", reason=reason)], exit_code=3)
            if event["event"] == "step":
                step(event["share"])
                continue
            contended = places.count(places[index]) > 1
            yield event["device"], replace(chunk_of_json(event["chunk"]), contended=contended)
            if waiting:
                workers[index].give(waiting.pop(0))
            else:
                busy -= 1
    finally:
        for worker in workers:
            worker.close()


class _Worker:
    """One process, and the thread that listens to it."""

    def __init__(self, index: int, job: SweepJob, device: int | None, events: queue.Queue[Any]) -> None:
        root = str(Path(rendergraph.__file__).resolve().parent.parent)
        paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
        self._words: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115  # closed with the process
        # A session of its own: Ctrl-C in the terminal reaches this process alone, which ends the worker.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "rendergraph.measure.sweep.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._words,
            text=True,
            encoding="utf-8",
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        )
        self._send({"job": job.to_json(), "device": device})
        self._listener = threading.Thread(target=self._listen, args=(index, events), daemon=True)
        self._listener.start()

    def give(self, chunk: tuple[int, tuple[tuple[int, Overrides], ...]]) -> None:
        """Hand it work."""
        self._send({"number": chunk[0], "points": chunk[1]})

    def _send(self, data: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # it died; its end is an event
            self._process.stdin.write(json.dumps(data) + "\n")
            self._process.stdin.flush()

    def _listen(self, index: int, events: queue.Queue[Any]) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            events.put((index, json.loads(line)))
        events.put((index, {"event": "end"}))

    def last_words(self) -> str:
        """How it ended, and what it said."""
        code = self._process.wait()
        self._words.seek(0)
        last = self._words.read().decode("utf-8", "replace").strip()[-_TOLD:]
        how = f"by signal {-code}" if code < 0 else f"with code {code}"
        return f"{how}: {last}" if last else how

    def close(self) -> None:
        """End it."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._listener.join()
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdout.close()
        with suppress(BrokenPipeError):
            self._process.stdin.close()
        self._words.close()


def _diagnostic(data: dict[str, Any]) -> Diagnostic:
    position = Position(**data["position"]) if data["position"] else None
    return Diagnostic(data["code"], data["severity"], data["text"], data["help"], position, data["data"])
