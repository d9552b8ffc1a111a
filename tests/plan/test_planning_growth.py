"""Planning twice the passes takes about twice the work, whatever the graph's shape: counted, not timed.

The work is the number of bytecodes run, which sees every loop of Python's, also those inside comprehensions.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.document.model_errors import MAX_MISTAKES
from rendergraph.plan import compile as compile_module
from rendergraph.plan import findings as findings_module
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.plan import Plan

PASSES = 200
LIMIT = 2.15  # the sorts and heaps have a logarithm in them

Entry = tuple[str, str, str, str]  # name, what is read, what is written, anything else
FILL = "node: fullscreen, set: {shader: fill.frag}"
ADD = "node: fullscreen, set: {shader: fill.frag, keep: [o]}"


def chain(n: int) -> list[Entry]:
    """Each pass reads the one before."""
    return [(f"p{i}", f"a: t{i - 1}" if i else "", f"o: t{i}", FILL) for i in range(n)]


def broadcast(n: int) -> list[Entry]:
    """All read the first; the last reads all."""
    middle = [(f"p{i}", "a: t0", f"o: t{i}", FILL) for i in range(1, n - 1)]
    return [("p0", "", "o: t0", FILL), *middle, ("last", _all("t", n - 1), "o: image", FILL)]


def broadcast_after_chain(n: int) -> list[Entry]:
    """Half come and go before the other half begin, which all wait for the end."""
    half = n // 2
    late = [(f"q{i}", f"a: t{half - 1}", f"o: u{i}", FILL) for i in range(half)]
    return [*chain(half), *late, ("last", _all("u", half), "o: image", FILL)]


def buffers(n: int) -> list[Entry]:
    """Buffers of many sizes, all alive at the end."""
    node = "node: compute, set: {shader: work.comp, groups: [1, 1, 1]}"
    return [*((f"p{i}", "", f"o: b{i}", node) for i in range(n - 1)), ("last", _all("b", n - 1), "o: image", FILL)]


def sum_and_look(n: int) -> list[Entry]:
    """Passes that add to one target take turns with passes that look at it."""
    entries: list[Entry] = [("add0", "", "o: sum", FILL)]
    for i in range(n // 2):
        if i:
            entries.append((f"add{i}", "", "o: sum", f"{ADD}, after: [look{i - 1}]"))
        before = f", b: t{i - 1}" if i else ""
        entries.append((f"look{i}", f"a: sum{before}", f"o: t{i}", f"{FILL}, after: [add{i}]"))
    return entries


def unread_sum(n: int) -> list[Entry]:
    """All add to what nobody reads."""
    adding = [(f"p{i}", "", "o: sum", f"{ADD}, after: [p{i - 1}]") for i in range(1, n)]
    return [("p0", "", "o: sum", FILL), *adding, ("last", "", "o: image", FILL)]


def reused_scratch(n: int) -> list[Entry]:
    """One target made anew and read by turns; nothing needs the second half."""
    entries: list[Entry] = []
    for i in range(n // 2):
        entries.append((f"make{i}", "", "o: scratch", FILL + (f", after: [use{i - 1}]" if i else "")))
        before = f", b: t{i - 1}" if i and i != n // 4 else ""
        entries.append((f"use{i}", f"a: scratch{before}", f"o: t{i}", f"{FILL}, after: [make{i}]"))
    return [*entries, ("last", f"a: t{n // 4 - 1}", "o: image", FILL)]


def ladder(n: int) -> list[Entry]:
    """The order of two writers follows from the order of two others, and so on up."""
    add = "node: fullscreen, set: {shader: fill.frag, keep: [o, p]}"
    made = [(f"make{i}", "", f"o: t{i}", FILL) for i in range(n // 2 + 1)]
    rungs = [(f"r{i}", f"a: t{i - 1}" if i else "", f"o: t{i}, p: t{i + 1}", add) for i in range(n // 2)]
    return [*made, *rungs, ("last", f"a: t{n // 2}", "o: image", FILL)]


SHAPES: list[Callable[[int], list[Entry]]] = [
    chain,
    broadcast,
    broadcast_after_chain,
    buffers,
    sum_and_look,
    unread_sum,
    reused_scratch,
    ladder,
]


def _all(prefix: str, count: int) -> str:
    return ", ".join(f"r{i}: {prefix}{i}" for i in range(count))


def _desc(name: str) -> str:
    return f"bytes: {256 * (1 + int(name[1:]) % 17)}" if name[0] == "b" else "format: rgba8"


def planner(folder: Path, entries: list[Entry]) -> Callable[[], Plan]:
    """Loads a graph; what is returned plans it."""
    names = sorted({pair.split(": ")[1] for _, _, write, _ in entries for pair in write.split(", ")})
    lines = ["rendergraph: 1", "frame: {size: [16, 16]}", "resources:"]
    lines += [f"  {name}: {{{_desc(name)}}}" for name in names]
    lines.append("passes:")
    lines += [f"  {name}: {{read: {{{read}}}, write: {{{write}}}, {rest}}}" for name, read, write, rest in entries]
    lines.append(f"outputs: {{{'image' if 'image' in names else entries[-1][2].split(': ')[1]}: {{file: out.png}}}}")
    (folder / "graph.yaml").write_text("\n".join(lines))
    for shader in ("fill.frag", "work.comp"):
        (folder / shader).write_text("void main() {}\n")
    document = load_document(folder / "graph.yaml")
    return lambda: compile_plan(expand(document)[0])[0]


def bytecodes(work: Callable[[], object]) -> int:
    """Bytecodes run, in all Python functions that ``work`` calls."""
    count = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal count
        frame.f_trace_lines, frame.f_trace_opcodes = False, True
        count += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        work()
    finally:
        sys.settrace(before)
    return count


def growth(folder: Path, shape: Callable[[int], list[Entry]]) -> float:
    """How much more work twice the passes are."""
    planner(folder, shape(20))()  # nodes are imported, caches filled
    small, large = (bytecodes(planner(folder, shape(n))) for n in (PASSES, 2 * PASSES))
    return large / small


@pytest.mark.parametrize("shape", SHAPES)
def test_twice_the_passes_are_twice_the_work(shape: Callable[[int], list[Entry]], tmp_path: Path) -> None:
    assert growth(tmp_path, shape) < LIMIT


def test_a_look_at_all_pairs_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def all_pairs(plan: Plan) -> tuple[str, ...]:
        return tuple(a.name for a in plan.order if not any(b.name == a.name for b in plan.order))

    monkeypatch.setattr(compile_module, "verify", all_pairs)
    assert growth(tmp_path, chain) > LIMIT


def test_a_name_that_all_misspell_is_looked_for_only_so_often(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looked = []
    monkeypatch.setattr(findings_module, "did_you_mean", lambda word, choices: looked.append(word) or "this one")
    passes = MAX_MISTAKES + 50
    entries = [(name, read.replace("a: t0", "a: tt"), write, rest) for name, read, write, rest in broadcast(passes)]
    with pytest.raises(RenderGraphError) as found:
        planner(tmp_path, entries)()
    assert [d.code for d in found.value.diagnostics].count("RG212") == passes - 2
    assert looked == ["tt"] * MAX_MISTAKES
