"""Tries extremes in a child process, and starts another where one dies or hangs."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import IO, Any, Final

import rendergraph
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.measure.stress.case import Case
from rendergraph.measure.stress.outcome import CaseOutcome
from rendergraph.measure.stress.target import StressTarget
from rendergraph.plan.graph import Position

_TOLD: Final = 400  # characters of a dead worker's last words
#: Seconds until a worker must have begun: it imports, opens the device and loads the graph.
_START: Final = 120.0


@dataclass(frozen=True, slots=True)
class StressJob:
    """What a worker needs to know. ``timeout``: seconds that one extreme may take."""

    file: str
    node: str
    own: tuple[str, ...]
    overrides: tuple[str, ...]
    size: tuple[int, int]
    device: int | None
    timeout: float
    names: tuple[str, ...] = ()

    def to_json(self) -> str:
        """For the worker's stdin."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> StressJob:
        """What :meth:`to_json` gave."""
        data = json.loads(text)
        tuples = {key: tuple(data[key]) for key in ("own", "overrides", "size", "names")}
        return cls(**{**data, **tuples})

    @property
    def target(self) -> StressTarget:
        """What is tried."""
        return StressTarget(Path(self.file), self.node, self.own)


def try_in_process(
    job: StressJob, cases: Sequence[Case], progress: Callable[[str, int, int], None]
) -> Iterator[CaseOutcome | tuple[str, str]]:
    """Outcomes in the order of ``cases``, and the worker's renderer and driver; ``progress`` is called as each begins.

    :raises RenderGraphError: RG770 where a worker ends before it tries anything; what it raises itself.
    """
    left = {case.name: case for case in cases}
    while left:
        begun: Case | None = None
        started = 0.0
        death = ""
        worker = _Worker(replace(job, names=tuple(left)))
        try:
            for event in worker.events(lambda: job.timeout if begun else _START):  # noqa: B023
                if event["event"] == "begin":
                    begun, started = left[event["name"]], time.perf_counter()
                    progress(begun.name, len(cases) - len(left), len(cases))
                elif event["event"] == "device":
                    yield event["renderer"], event["driver"]
                elif event["event"] == "error":
                    raise RenderGraphError([_diagnostic(d) for d in event["diagnostics"]], event["exit_code"])
                else:
                    outcome = CaseOutcome.from_json(event["outcome"])
                    del left[outcome.name]
                    begun = None
                    yield outcome
            death = worker.end()
        except TimeoutError:
            death = ""
        finally:
            worker.close()
        if not left:
            return
        if begun is None:
            raise RenderGraphError([diagnose("RG770", reason=death or "it did not begin in time")], exit_code=3)
        del left[begun.name]
        yield _dead(begun, job, time.perf_counter() - started, death)


def _dead(case: Case, job: StressJob, seconds: float, death: str) -> CaseOutcome:
    state, text = ("crashed", death) if death else ("timed_out", f"it took more than {job.timeout:g} s")
    size = case.size or job.size
    return CaseOutcome(
        case.name, case.extreme.help, case.common, state, size, seconds, "", text  # type: ignore[arg-type]
    )  # fmt: skip


class _Worker:
    """A process of :mod:`rendergraph.measure.stress.worker`, in a session of its own: Ctrl-C reaches this one alone."""

    def __init__(self, job: StressJob) -> None:
        root = str(Path(rendergraph.__file__).resolve().parent.parent)
        paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
        self._words = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the worker)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "rendergraph.measure.stress.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._words,
            text=True,
            encoding="utf-8",
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(job.to_json())
            self._process.stdin.close()
        except BrokenPipeError:
            pass  # it died at once; what it left to say follows
        self._lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._read, args=(self._process.stdout,), daemon=True).start()

    def _read(self, stream: IO[str]) -> None:
        for line in stream:
            self._lines.put(line)
        self._lines.put(None)

    def events(self, patience: Callable[[], float]) -> Iterator[dict[str, Any]]:
        """Events until the process ends. Raises ``TimeoutError`` after ``patience()`` seconds without one."""
        while True:
            try:
                line = self._lines.get(timeout=patience())
            except queue.Empty:
                raise TimeoutError from None
            if line is None:
                return
            yield json.loads(line)

    def end(self) -> str:
        """How it ended, once its output has; empty for a proper end."""
        code = self._process.wait()
        if code == 0:
            return ""
        self._words.seek(0)
        last = self._words.read().decode("utf-8", "replace").strip()[-_TOLD:]
        how = f"the process was ended by signal {-code}" if code < 0 else f"the process ended with code {code}"
        return f"{how}: {last}" if last else how

    def close(self) -> None:
        """End it if it still runs."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._words.close()


def _diagnostic(data: dict[str, Any]) -> Diagnostic:
    position = Position(**data["position"]) if data["position"] else None
    return Diagnostic(data["code"], data["severity"], data["text"], data["help"], position, data["data"])
