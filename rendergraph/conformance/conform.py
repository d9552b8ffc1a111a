"""Holds nodes against every demand: the library behind `rg conform` and the pytest plugin."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import entry_points

from rendergraph.conformance.demand import Demand, Note, Shortfall, Verdict
from rendergraph.conformance.demands import DEMANDS
from rendergraph.conformance.subject import Subject
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.discovery import ENTRY_POINTS, node_names

Progress = Callable[[str, int, int], None]

_ENVIRONMENT = 3


@dataclass(frozen=True, slots=True)
class ConformReport:
    """Every verdict, node after node. ``renderer`` and ``driver`` are empty where nothing was run."""

    nodes: tuple[str, ...]
    verdicts: tuple[Verdict, ...]
    renderer: str = ""
    driver: str = ""

    @property
    def missed(self) -> tuple[Verdict, ...]:
        """What is not met."""
        return tuple(verdict for verdict in self.verdicts if verdict.status == "missed")


def conform(
    nodes: Sequence[str] = (),
    demands: Sequence[str] = (),
    *,
    device: int | None = None,
    isolate: bool = True,
    progress: Progress = lambda stage, done, total: None,
) -> ConformReport:
    """Hold the nodes named (none: all that are found) against the demands named (none: all).

    :raises RenderGraphError: RG794 for an unknown node, RG795 for an unknown demand; exit code 3 without OpenGL.
    """
    names = tuple(dict.fromkeys(resolve(name) for name in nodes)) or node_names()
    chosen = [_demand(name) for name in demands] or list(DEMANDS.values())
    verdicts: list[Verdict] = []
    facts = ("", "")
    for name in names:
        subject = Subject(name, device=device, isolate=isolate)
        for demand in chosen:
            progress(f"{name}: {demand.name}", len(verdicts), len(names) * len(chosen))
            verdicts.append(hold(subject, demand))
        if "device" in vars(subject):
            facts = subject.device.info.renderer, subject.device.info.driver
    return ConformReport(names, tuple(verdicts), *facts)


def resolve(name: str) -> str:
    """A node's name, from its name or the module that its package's entry point names (``mypackage.mynode``).

    :raises RenderGraphError: RG794 where no installed package declares it.
    """
    if name in node_names():
        return name
    for entry in entry_points_of_nodes():
        if entry[1] == name:
            return entry[0]
    raise RenderGraphError([diagnose("RG794", name=name, hint=did_you_mean(name, node_names()))], exit_code=2)


def entry_points_of_nodes() -> list[tuple[str, str]]:
    """Name and module of every node that an installed package declares."""
    return [(entry.name, entry.module) for entry in entry_points(group=ENTRY_POINTS)]


def _demand(name: str) -> Demand:
    if name not in DEMANDS:
        raise RenderGraphError([diagnose("RG795", name=name, hint=did_you_mean(name, DEMANDS))], exit_code=2)
    return DEMANDS[name]


def hold(subject: Subject, demand: Demand) -> Verdict:
    """One demand on one node. Whatever the node's own code raises is a shortfall.

    :raises RenderGraphError: with exit code 3, where there is no OpenGL to try it on.
    """
    start = time.perf_counter()

    def verdict(status: str, found: Sequence[Shortfall | Note] = (), reason: str = "") -> Verdict:
        return Verdict(
            subject.name,
            demand.name,
            demand.code,
            status,  # type: ignore[arg-type]
            tuple(dict.fromkeys(one for one in found if isinstance(one, Shortfall))),
            tuple(one.text for one in found if isinstance(one, Note)),
            reason,
            time.perf_counter() - start,
        )

    try:
        exempt = subject.node.exempt
    except Exception as error:  # somebody's package, which may fail in any way
        text = f"the node cannot be imported: {type(error).__name__}: {error}"
        return verdict("missed", [Shortfall("not_imported", text)])
    unknown = [Shortfall("unknown_exemption", f"exempt names '{name}'") for name in exempt if name not in DEMANDS]
    if unknown and demand.name == "graph":
        return verdict("missed", unknown)
    if demand.name in exempt:
        reason = exempt[demand.name].strip()
        if len(reason.split()) < 2:
            return verdict("missed", [Shortfall("exempt_without_reason", "the exemption gives no reason")])
        return verdict("exempt", reason=reason)
    try:
        if demand.needs_graph and subject.graph_problem:
            return verdict("not_tried", reason=f"it has no graph to be tried on: {subject.graph_problem}")
        found = list(_guarded(subject, demand))
    except RenderGraphError as error:
        if error.exit_code == _ENVIRONMENT:
            raise
        found = [Shortfall("error", f"{d.code} {d.text}") for d in error.diagnostics]
    except Exception as error:  # somebody's node, which may fail in any way
        found = [Shortfall("crashed", f"{type(error).__name__}: {error}")]
    missed = any(isinstance(one, Shortfall) for one in found)
    return verdict("missed" if missed else "met", found)


def _guarded(subject: Subject, demand: Demand) -> Iterator[Shortfall | Note]:
    """The check, and driver errors that it left."""
    yield from demand.check(subject)
    if "device" in vars(subject):
        for text in subject.device.debug.take_errors():
            yield Shortfall("driver_error", str(text))


def findings(report: ConformReport) -> list[Diagnostic]:
    """A diagnostic for each shortfall."""
    return [
        diagnose(verdict.code, None, node=verdict.node, text=one.text, reason=one.reason)
        for verdict in report.missed
        for one in verdict.shortfalls
    ]
