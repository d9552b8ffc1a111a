"""A worker process of `rg stress`: reads a job from stdin, writes one JSON event a line to stdout.

    python -m rendergraph.measure.stress.worker

Events: ``device``, then ``begin`` and ``outcome`` of each extreme; ``error`` ends it.
"""

from __future__ import annotations

import sys

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.bench_worker import Events, plain
from rendergraph.measure.stress.process import StressJob


def work(job: StressJob, events: Events) -> None:
    """Try every extreme named."""
    from rendergraph.device.context import open_device
    from rendergraph.measure.stress.cases import cases_of
    from rendergraph.measure.stress.target import load_target
    from rendergraph.measure.stress.try_case import Bench
    from rendergraph.measure.truth.cache import open_cache

    cases = cases_of(job.target, load_target(job.target, job.overrides), job.names)
    device = open_device(job.device)
    events.send("device", renderer=device.info.renderer, driver=device.info.driver)
    bench = Bench(job.target, job.overrides, job.size, device, open_cache())
    for case in cases:
        events.send("begin", name=case.name)
        events.send("outcome", outcome=bench.attempt(case).to_json())


def main() -> None:
    """Read the job, work, and report a user's mistake as an event."""
    events = Events()
    job = StressJob.from_json(sys.stdin.read())
    try:
        work(job, events)
    except RenderGraphError as error:
        events.send("error", exit_code=error.exit_code, diagnostics=[plain(d) for d in error.diagnostics])
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()
