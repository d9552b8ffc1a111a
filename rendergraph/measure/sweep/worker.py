"""A worker process of `rg sweep`: reads a job and then chunks from stdin, a line each; writes JSON events to stdout.

    python -m rendergraph.measure.sweep.worker

Events: ``step`` (work has advanced by a share of a setting), ``chunk``, ``error``.
"""

from __future__ import annotations

import json
import sys
from contextlib import closing
from dataclasses import asdict

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.bench_worker import Events, plain
from rendergraph.measure.sweep.job import SweepJob


def main() -> None:
    """Work until stdin ends, and report a user's mistake as an event."""
    from rendergraph.device.context import open_device
    from rendergraph.measure.sweep.bench import Settings, Workbench
    from rendergraph.measure.sweep.chunk import measure_chunk
    from rendergraph.measure.sweep.process import device_facts

    events = Events()
    request = json.loads(sys.stdin.readline())
    try:
        device = open_device(request["device"])
        with closing(Workbench(Settings(SweepJob.from_json(request["job"])), device)) as bench:
            for line in sys.stdin:
                work = json.loads(line)
                points = [(index, tuple(overrides)) for index, overrides in work["points"]]
                chunk = measure_chunk(bench, points, work["number"], lambda share: events.send("step", share=share))
                events.send("chunk", chunk=asdict(chunk), device=device_facts(device))
    except RenderGraphError as error:
        events.send("error", exit_code=error.exit_code, diagnostics=[plain(d) for d in error.diagnostics])
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()
