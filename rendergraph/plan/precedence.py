"""Which pass touches a resource before which, whatever the order of the file.

Writers of a resource are totally ordered. The *definer* is the one whose first access keeps nothing from before; the
*modifiers*, which add to what is there, come after it. Two modifiers or two definers need an order of their own: by
``after:`` or by other data that flows from one to the other. A reader sees the content after the last writer, unless
it is already bound to run before one of them.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.plan.graph import Decision
from rendergraph.plan.index import LOADS, WRITES, Index
from rendergraph.plan.reach import Reach

Touch = tuple[int, int]  # sub-pass, LOADS | WRITES


@dataclass(slots=True)
class Precedence:
    """``sequence``: per cell, its touches in the order they must keep (readers between the same two writers are free).
    ``passes``: all passes in one legal order.
    """

    sequence: list[list[Touch]]
    passes: list[int]
    errors: list[Diagnostic] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)


@dataclass(slots=True)
class _Contest:
    """A cell with several writer passes."""

    cell: int
    groups: dict[int, list[Touch]]
    writers: list[int]


def find_precedence(index: Index) -> Precedence:
    """Order the passes that share a cell. Raises ``RenderGraphError`` for a cycle; collects all other errors."""
    followers: list[dict[int, str]] = [{} for _ in index.passes]  # pass -> pass that must come later: because of what
    number = {found.name: i for i, found in enumerate(index.passes)}
    for later, found in enumerate(index.passes):
        for name in found.after:
            if name in number:
                followers[number[name]].setdefault(later, "")
    sequence: list[list[Touch]] = []
    contests: list[_Contest] = []
    pass_of = index.pass_of
    for cell, touches in enumerate(index.touches):
        groups: dict[int, list[Touch]] = {}
        writers: list[int] = []
        for touch in touches:
            owner = pass_of[touch[0]]
            if owner in groups:
                groups[owner].append(touch)
            else:
                groups[owner] = [touch]
            if touch[1] & WRITES and (not writers or writers[-1] != owner):
                writers.append(owner)
        first = _sole_definer(groups, writers)
        if first is not None:
            because = index.resources[index.resource_of[cell]].name
            for other in groups:
                if other != first:
                    followers[first].setdefault(other, because)
        if len(writers) > 1:
            contests.append(_Contest(cell, groups, writers))
            sequence.append([])
        elif first is not None and first != pass_of[touches[0][0]]:
            sequence.append([*groups.pop(first), *(touch for group in groups.values() for touch in group)])
        else:
            sequence.append(touches)
    result = Precedence(sequence, [])
    _settle(index, followers, contests, result)
    result.passes = _topological(index, followers)
    return result


def _sole_definer(groups: dict[int, list[Touch]], writers: list[int]) -> int | None:
    """The one writer that must come first, if that much is clear."""
    if len(writers) == 1:
        return writers[0]
    definers = [w for w in writers if not groups[w][0][1] & LOADS]
    return definers[0] if len(definers) == 1 else None


def _settle(index: Index, followers: list[dict[int, str]], contests: list[_Contest], result: Precedence) -> None:
    """Order the writers of contested cells, round by round: an order found in one may decide another."""
    if not contests:
        return
    reach = Reach(followers, _topological(index, followers), {w for c in contests for w in c.writers})
    told: set[tuple[str, str]] = set()
    undecided = dict(enumerate(contests))
    by_writer: dict[int, list[int]] = {}
    for number, contest in enumerate(contests):
        for writer in contest.writers:
            by_writer.setdefault(writer, []).append(number)
    asked = Counter(p for contest in contests for p in contest.groups)
    due: Iterable[int] = range(len(contests))
    while due:
        edges: list[tuple[int, int, str]] = []
        for number in due:
            contest = contests[number]
            chain = reach.chain(contest.writers)
            if chain is not None:
                edges += _thread(index, contest, chain, reach, result, told)
                del undecided[number]
                for p in contest.groups:
                    asked[p] -= 1
                    if not asked[p]:
                        del asked[p]
        for earlier, later, resource in edges:
            followers[earlier].setdefault(later, resource)
        if not undecided:
            return
        grown = reach.add(followers, [(a, b) for a, b, _ in edges], asked)
        if reach.in_circle(grown):
            break
        due = sorted({number for p in grown for number in by_writer.get(p, ()) if number in undecided})
    place = {p: i for i, p in enumerate(_topological(index, followers))}
    _report(index, [*undecided.values()], place, reach, result.errors)


def _thread(
    index: Index,
    contest: _Contest,
    chain: list[int],
    reach: Reach,
    result: Precedence,
    told: set[tuple[str, str]],
) -> list[tuple[int, int, str]]:
    """Place the readers between the ordered writers and write down the cell's sequence; the edges this gives."""
    resource = index.resources[index.resource_of[contest.cell]].name
    readers: list[list[int]] = [[] for _ in range(len(chain) + 1)]  # readers[i] see the content of chain[i - 1]
    writers = set(chain)
    for reader in contest.groups:
        if reader not in writers:
            place = reach.place(reader, chain)
            readers[place].append(reader)
            if place < len(chain) and (key := (resource, index.passes[reader].name)) not in told:
                told.add(key)
                evidence = {"resource": resource, "before": index.passes[chain[place]].name}
                result.decisions.append(Decision("order", "reads_before_later_writer", key[1], evidence))
    if (resource, "") not in told:
        told.add((resource, ""))
        names = [index.passes[w].name for w in chain]
        result.decisions.append(Decision("order", "writers_in_order", resource, {"writers": names}))
    order = list(readers[0])
    edges: list[tuple[int, int, str]] = []
    for i, writer in enumerate(chain):
        edges += [(reader, writer, resource) for reader in readers[i]]
        edges += [(writer, later, resource) for later in (*readers[i + 1], *chain[i + 1 : i + 2])]
        order += [writer, *readers[i + 1]]
    result.sequence[contest.cell] = [touch for p in order for touch in contest.groups[p]]
    return edges


def _report(
    index: Index, contests: list[_Contest], place: dict[int, int], reach: Reach, errors: list[Diagnostic]
) -> None:
    """One error for each pair of writers of a resource that nothing orders."""
    told: set[tuple[int, int, int]] = set()
    for contest in contests:
        chain = sorted(contest.writers, key=place.__getitem__)
        resource = index.resource_of[contest.cell]
        for pair in pairwise(chain):
            a, b = sorted(pair)
            if reach(*pair) or (resource, a, b) in told:
                continue
            told.add((resource, a, b))
            one, two = index.passes[a], index.passes[b]
            data = {"resource": index.resources[resource].name, "first": one.name, "second": two.name}
            errors.append(diagnose("RG230", two.position, **data, place=one.position or "generated"))


def _topological(index: Index, followers: list[dict[int, str]]) -> list[int]:
    """All passes in a legal order. Raises ``RenderGraphError`` (RG233) with a shortest cycle when there is none."""
    waiting = [0] * len(followers)
    for after in followers:
        for p in after:
            waiting[p] += 1
    ready = deque(p for p, count in enumerate(waiting) if not count)
    order: list[int] = []
    while ready:
        p = ready.popleft()
        order.append(p)
        for later in followers[p]:
            waiting[later] -= 1
            if not waiting[later]:
                ready.append(later)
    if len(order) < len(followers):
        stuck = {p for p, count in enumerate(waiting) if count}
        cycle = _cycle(followers, stuck)
        steps = []
        for a, b in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
            why = followers[a][b]
            steps.append(f"{index.passes[a].name} -> {index.passes[b].name} ({f'by {why}' if why else 'by after:'})")
        names = [index.passes[p].name for p in cycle]
        places = ", ".join(f"{index.passes[p].name} at {index.passes[p].position or 'no place'}" for p in cycle)
        first = index.passes[cycle[0]]
        path = " -> ".join([*names, names[0]])
        raise RenderGraphError([
            diagnose("RG233", first.position, path=path, steps="; ".join(steps), places=places, passes=names)
        ])  # fmt: skip
    return order


def _cycle(followers: list[dict[int, str]], stuck: set[int]) -> list[int]:
    """A shortest cycle through a pass that lies on one, beginning with the first name."""
    before = {b: a for a in sorted(stuck, reverse=True) for b in followers[a] if b in stuck}
    p = min(stuck)
    seen: set[int] = set()
    while p not in seen:  # walking back from a stuck pass always ends in a cycle
        seen.add(p)
        p = before[p]
    parent = {p: p}
    queue = deque([p])
    while queue:
        a = queue.popleft()
        if p in followers[a]:
            path = [a]
            while a != p:
                a = parent[a]
                path.append(a)
            path.reverse()
            start = path.index(min(path))
            return path[start:] + path[:start]
        for b in sorted(followers[a]):
            if b in stuck and b not in parent:
                parent[b] = a
                queue.append(b)
    raise AssertionError("a pass of a cycle does not reach itself")
