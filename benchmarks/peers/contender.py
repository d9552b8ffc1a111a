"""One renderer in a process of its own, asked for frames through a pipe."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from environment import HERE
from shot import Shot


@dataclass
class Contender:
    """A worker and what it measured: nanoseconds a frame, by kind (see ``serve.py``)."""

    name: str
    features: str
    worker: subprocess.Popen[str]
    log: Path
    about: dict[str, Any] = field(default_factory=dict)
    samples: dict[str, list[int]] = field(default_factory=dict)

    @staticmethod
    def start(
        name: str, features: str, python: Path | str, arguments: list[str], variables: dict[str, str], log: Path
    ) -> Contender:
        """Start the worker ``arguments[0]`` of this folder; what it prints goes to ``log``."""
        with log.open("w") as file:
            worker = subprocess.Popen(
                [str(python), str(HERE / arguments[0]), *arguments[1:]],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                env=variables,
                text=True,
                bufsize=1,
            )
        return Contender(name, features, worker, log)

    def load(self, shot: Shot) -> None:
        """Load the scene."""
        self.about = self._ask(shot.to_json())

    def frame(self, *, keep: bool) -> None:
        """Draw one frame; keep its times, unless it is for warming up."""
        times = self._ask(json.dumps({"do": "frame"}))
        if keep:
            for kind, ns in times.items():
                self.samples.setdefault(kind, []).append(ns)

    def save(self, file: Path) -> None:
        """Draw one frame more and save it."""
        self._ask(json.dumps({"do": "save", "file": str(file)}))

    def close(self) -> None:
        """End the worker."""
        if self.worker.stdin is not None:
            self.worker.stdin.close()
        try:
            self.worker.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.worker.kill()

    def _ask(self, line: str) -> dict[str, Any]:
        assert self.worker.stdin is not None
        assert self.worker.stdout is not None
        try:
            print(line, file=self.worker.stdin, flush=True)
            reply = self.worker.stdout.readline()
        except BrokenPipeError:
            reply = ""
        if not reply:
            tail = "\n".join(self.log.read_text(errors="replace").splitlines()[-15:])
            raise SystemExit(f"{self.name} ({self.features}) ended early:\n{tail}")
        answer: dict[str, Any] = json.loads(reply)
        return answer
