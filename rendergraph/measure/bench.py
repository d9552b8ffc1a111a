"""`rg bench`: measures one graph, or two side by side, in several fresh processes, and keeps every sample."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

import rendergraph
from rendergraph.document.load import load_document
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.measure.bench_job import BenchJob, Side
from rendergraph.measure.bench_process import diagnostic, run_worker
from rendergraph.measure.perturb_rounds import ROUNDS
from rendergraph.measure.steady import BAND, ERRORS, HOLD, WINDOW
from rendergraph.report.counters import driver_warnings

SCHEMA: Final = "rendergraph.bench/1"
Progress = Callable[[str, int, int], None]


class Bench:
    """A bench under way. :meth:`record` holds what is complete at any time, also after :meth:`run` was interrupted."""

    def __init__(self, job: BenchJob) -> None:
        """Read every side's graph, so that a mistake is told before anything runs.

        :raises RenderGraphError: for the mistakes of the documents.
        """
        for side in job.sides.values():
            load_document(side.graph, side.overrides)
        self.job = job
        self.blocks: list[dict[str, Any]] = []
        self._sides: dict[str, dict[str, Any]] = {}
        self._warm_up: dict[str, list[dict[str, Any]]] = {name: [] for name in job.sides}
        self._bound: dict[str, dict[str, Any]] = {}
        self._driver: list[Diagnostic] = []
        self._complete = False

    def run(self, progress: Progress = lambda stage, done, total: None) -> None:
        """Run every process in turn; one more for the perturbed runs.

        :raises RenderGraphError: what a worker reports; RG580 for a worker that ended without a word.
        """
        job, sides = self.job, len(self.job.sides)
        total = job.processes * sides * (1 + job.blocks) + (sides * (1 + ROUNDS) if job.bound else 0)
        done = 0
        for process in range(job.processes + (1 if job.bound else 0)):
            bound = process == job.processes
            stage = "perturbed runs" if bound else f"process {process + 1} of {job.processes}"
            progress(stage, done, total)
            for event in run_worker(job, process, bound=bound):
                if event["event"] == "step":
                    done += 1
                    progress(stage, done, total)
                else:
                    self._take(event, process, bound)
        self._complete = True

    def _take(self, event: dict[str, Any], process: int, bound: bool) -> None:
        kind, data = event["event"], event["data"]
        if kind == "block":
            self.blocks.append(data)
        elif kind == "warnings":  # every process hears the same
            self._driver += [found for found in map(diagnostic, data) if found not in self._driver]
        elif kind == "bound":
            self._bound[event["side"]] = data
        elif bound:
            return  # the sides of the perturbed runs are those measured before
        elif kind == "facts":
            once = data.pop("once_ms")
            side = self._sides.setdefault(event["side"], {**data, "once_ms": []})
            side["once_ms"].append(once)
        elif kind == "warm_up":
            self._warm_up[event["side"]].append({"process": process, **data})
        elif kind == "steady":
            self._sides[event["side"]]["steady_state"] = data

    def record(self) -> dict[str, Any]:
        """What was measured so far, as JSON-ready data; times in milliseconds."""
        job = self.job
        return {
            "schema": SCHEMA,
            "rendergraph": rendergraph.__version__,
            "complete": self._complete,
            "graphs": [side.graph for side in job.sides.values()],
            "design": {"processes": job.processes, "blocks": job.blocks, "frames": job.frames},
            "sides": {name: self._sides[name] for name in sorted(self._sides)},
            "warm_up": {
                "rule": {"window": WINDOW, "hold": HOLD, "band": BAND, "errors": ERRORS, "most": job.most_warm_up},
                **self._warm_up,
            },
            "blocks": self.blocks,
            "bound": self._bound,
            "driver_warnings": driver_warnings(self._driver),
        }

    def findings(self) -> list[Diagnostic]:
        """RG582 for every side that some process did not find steady within the warm-up frames allowed, and what the
        driver warned of (RG507).
        """
        unsteady = [
            diagnose("RG582", side=name, frames=self.job.most_warm_up)
            for name, runs in self._warm_up.items()
            if any(run["steady_from"] is None for run in runs)
        ]
        return [*unsteady, *self._driver]


def bench_sides(
    graphs: Sequence[str], both: tuple[str, ...] = (), a: tuple[str, ...] = (), b: tuple[str, ...] = ()
) -> dict[str, Side]:
    """The sides of a bench: two graphs, or one under two sets of overrides; ``both`` are of every side.

    :raises RenderGraphError: RG581 for more than two graphs.
    """
    if not 1 <= len(graphs) <= 2:
        hint = "name one graph, or two; for one graph under two overrides use --a and --b"
        raise RenderGraphError([diagnose("RG581", problem=f"{len(graphs)} graphs are named", hint=hint)], exit_code=2)
    sides = {"A": Side(graphs[0], both + a)}
    if len(graphs) == 2 or a or b:
        sides["B"] = Side(graphs[-1], both + b)
    return sides
