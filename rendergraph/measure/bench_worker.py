"""A worker process of `rg bench`: reads a job from stdin, writes one JSON event a line to stdout.

    python -m rendergraph.measure.bench_worker

Events: ``step`` (a unit of work is done), ``facts``, ``warm_up`` and ``steady`` of a side, ``block``,
``bound`` of a side, ``warnings`` of the driver, ``error``.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, TextIO

from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.measure.bench_job import BenchJob

if TYPE_CHECKING:
    from rendergraph.device.context import Device


class Events:
    """Writes events. What drivers print to stdout goes to stderr instead."""

    def __init__(self) -> None:
        self._stream: TextIO = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)

    def send(self, event: str, **data: Any) -> None:
        """One event, at once."""
        self._stream.write(json.dumps({"event": event, **data}) + "\n")
        self._stream.flush()


def work(job: BenchJob, process: int, events: Events) -> None:
    """One process's share: every side prepared and warmed up, then its blocks, or the perturbed runs."""
    from rendergraph.device.clock import choose_clock
    from rendergraph.device.context import open_device
    from rendergraph.measure.bench_side import BenchSide
    from rendergraph.measure.perturb import perturb_side

    device = open_device(job.device)
    clock = choose_clock(device)
    sides = {}
    for name, side in job.sides.items():
        sides[name] = BenchSide(device, clock, side, job)
        events.send("facts", side=name, data=sides[name].facts())
        events.send("warm_up", side=name, data=sides[name].warm_up(job.most_warm_up))
        events.send("step")
    if job.bound:
        for name, prepared in sides.items():
            data = perturb_side(prepared, job, lambda: events.send("step"))
            events.send("bound", side=name, data=data)
        _tell_warnings(device, events)
        return
    for block in range(job.blocks):
        order = job.order(process, block)
        measured = {}
        for name in order:
            measured[name] = sides[name].block(job.frames)
            events.send("step")
        events.send("block", data={"process": process, "order": order, **dict(sorted(measured.items()))})
    for name, prepared in sides.items():
        events.send("steady", side=name, data=prepared.steady_state())
    _tell_warnings(device, events)


def _tell_warnings(device: Device, events: Events) -> None:
    events.send("warnings", data=[plain(found) for found in device.debug.take_warnings()])


def main() -> None:
    """Read the job, work, and report a user's mistake as an event."""
    events = Events()
    request = json.loads(sys.stdin.read())
    try:
        work(BenchJob.from_json(request["job"]), request["process"], events)
    except RenderGraphError as error:
        events.send("error", exit_code=error.exit_code, diagnostics=[plain(d) for d in error.diagnostics])
        sys.exit(error.exit_code)


def plain(diagnostic: Diagnostic) -> dict[str, Any]:
    """A diagnostic as JSON-ready data, its values as text."""
    data = asdict(diagnostic)
    data["data"] = {key: str(value) for key, value in diagnostic.data.items()}
    return data


if __name__ == "__main__":
    main()
