"""The terminal table of `rg stress`: extremes down, passes across, one symbol each."""

from __future__ import annotations

from typing import Final

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from rendergraph.measure.stress.outcome import BROKEN, CaseOutcome, PassOutcome
from rendergraph.measure.stress.stress import StressReport

#: Symbol, style and meaning.
_SYMBOLS: Final = {
    "pass": ("·", "green", "passes"),
    "partly": ("s", "green", "passes, with checks left out"),
    "fail": ("F", "bold red", "fails"),
    "inherited": ("i", "yellow", "fails on inputs that were bad already"),
    "not_run": ("-", "dim", "does not run"),
    "refused": ("R", "cyan", "refused, as declared"),
    "broken": ("E", "bold red", "error, crash or too long"),
}


def stress_table(report: StressReport) -> RenderableType:
    """The matrix, its legend, and a line of counts; the failures themselves are diagnostics."""
    passes = _columns(report)
    table = Table(title=_title(report), title_justify="left", box=None, pad_edge=False)
    table.add_column("extreme", no_wrap=True)
    for name in passes:
        table.add_column(name, justify="center", no_wrap=True)
    table.add_column("seconds", justify="right", no_wrap=True)
    table.add_column("what", no_wrap=True)
    seen = set()
    for case in report.cases:
        if case.state == "not_applicable":
            continue
        cells = {entry.name: _symbol(entry) for entry in case.passes}
        row = [cells.get(name, _whole(case)) for name in passes]
        seen |= set(row)
        what = case.help if case.state in ("ran", "refused") else case.text
        marks = [Text(*_SYMBOLS[key][:2]) for key in row]
        table.add_row(case.name, *marks, f"{case.seconds:.2f}", what)
    legend = "   ".join(f"{mark} {means}" for key, (mark, _, means) in _SYMBOLS.items() if key in seen)
    lines = [legend, *_inapplicable(report), _counts(report)]
    return Group(table, *(Text(line, style="dim") for line in lines))


def _columns(report: StressReport) -> list[str]:
    """Passes in the order of execution, as far as it is known."""
    names: dict[str, None] = {}
    for case in sorted(report.cases, key=lambda case: -len(case.passes)):
        names |= dict.fromkeys(entry.name for entry in case.passes)
    if names:
        return list(names)
    models = report.document.model.passes.items()
    return [name for name, model in models if report.target.node in ("", model.node)]


def _symbol(entry: PassOutcome) -> str:
    return "partly" if entry.status == "pass" and entry.skipped else entry.status


def _whole(case: CaseOutcome) -> str:
    if case.state in BROKEN:
        return "broken"
    return case.state if case.state in _SYMBOLS else "not_run"


def _title(report: StressReport) -> str:
    node = f"{report.target.node} on " if report.target.node else ""
    return f"{node}{report.target.file.name}, {report.size[0]}x{report.size[1]}, {report.renderer}"


def _inapplicable(report: StressReport) -> list[str]:
    """A line for each reason why extremes do not apply."""
    reasons: dict[str, list[str]] = {}
    for case in report.cases:
        if case.state == "not_applicable":
            reasons.setdefault(case.text, []).append(case.name)
    return [f"left out, as {reason}: {', '.join(names)}" for reason, names in reasons.items()]


def _counts(report: StressReport) -> str:
    states = [case.state for case in report.cases]
    ran = len(states) - states.count("not_applicable")
    return f"{ran} extremes, {len(report.failed)} failed, {states.count('refused')} refused as declared"
