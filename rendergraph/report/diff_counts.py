"""What two timing records hold exactly: draws, dispatches, bytes touched, passes, and what a frame is bound by."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from rendergraph.report.diff_exact import Direction, ExactChange, amount
from rendergraph.report.diff_names import Matching
from rendergraph.report.read_records import Times


def compare_counts(a: Times, b: Times, names: Matching) -> Iterator[ExactChange]:
    """Draws, dispatches, bytes touched and the like a pass, and what a steady frame must not create."""
    for name, entry in a.passes.items():
        other = b.passes.get(names.after_name(name))
        if other is not None:
            if entry.node != other.node:
                what = f"pass {names.after_name(name)} is a {other.node} now, before a {entry.node}"
                yield ExactChange("pass", names.after_name(name), Direction.CHANGED, entry.node, other.node, what)
            yield from _compare_counters(names.after_name(name), entry.counters, other.counters)
    for name, after in common_steps(a, b, names).items():
        # Not judged: work may move inside a pass, and the pass's own counts say whether there is more of it.
        before, now = a.steps[name].counters, b.steps[after].counters
        yield from _compare_counters(after, before, now, Direction.CHANGED)
    if names.only_before or names.only_after:
        yield from _compare_counters("whole frame", _summed(a), _summed(b))
    for name in a.steady.keys() & b.steady.keys():
        if a.steady[name] != b.steady[name]:
            text = f"{_words(name)} after the first frame"
            yield amount("steady_state", name, a.steady[name], b.steady[name], text)


def compare_passes(names: Matching) -> Iterator[ExactChange]:
    """Passes on one side only, and those that were renamed."""
    for before, after in names.renamed.items():
        text = f"pass {before} is now {after} (the same node in the same place): compared as one"
        yield ExactChange("pass", after, Direction.CHANGED, before, after, text)
    for name in names.only_before:
        yield ExactChange("pass", name, Direction.CHANGED, name, None, f"pass {name} ran only before")
    for name in names.only_after:
        yield ExactChange("pass", name, Direction.CHANGED, None, name, f"pass {name} runs only after")


def compare_bounds(a: Times, b: Times) -> Iterator[ExactChange]:
    """What the frame is bound by, where both records tell; another bound is neither better nor worse."""
    if a.bound and b.bound and a.bound.bound_by != b.bound.bound_by:
        (before, sure_before), (after, sure_after) = (
            (bound.bound_by, f"{100 * bound.agreement:.0f} % of rounds agree") for bound in (a.bound, b.bound)
        )
        text = f"the frame is bound by {after} now ({sure_after}), before by {before} ({sure_before})"
        yield ExactChange("bound", "whole frame", Direction.CHANGED, before, after, text)


def common_steps(a: Times, b: Times, names: Matching) -> dict[str, str]:
    """Sub-passes that both sides have, names before to names after, of passes with several on either side: a single
    one is its pass.
    """
    several = _divided(names.after_name(name) for name in a.steps) | _divided(b.steps)
    pairs = {name: names.after_name(name) for name in a.steps}
    return {name: after for name, after in pairs.items() if after in b.steps and after.partition(".")[0] in several}


def _divided(steps: Iterable[str]) -> set[str]:
    """Passes that several of the sub-passes belong to."""
    counts = Counter(name.partition(".")[0] for name in steps)
    return {parent for parent, count in counts.items() if count > 1}


def _compare_counters(
    subject: str, a: Mapping[str, int], b: Mapping[str, int], direction: Direction | None = None
) -> Iterator[ExactChange]:
    for name in [n for n in a if n in b]:
        if a[name] != b[name]:
            yield amount("counter", f"{subject}.{name}", a[name], b[name], f"{subject}: {_words(name)}", direction)


def _summed(times: Times) -> dict[str, int]:
    totals: dict[str, int] = {}
    for entry in times.passes.values():
        for name, value in entry.counters.items():
            totals[name] = totals.get(name, 0) + value
    return totals


def _words(name: str) -> str:
    return name.replace("_", " ")
