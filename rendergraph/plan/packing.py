"""Placing ranges in one heap: who lives at the same time must not overlap, and the heap should be small.

This is offline dynamic storage allocation, NP-hard. Placing big ones first nearly always meets the lower bound (most
bytes live at once); a few orders and a bounded local search do the rest. TFLite's and RPS's packers are of this kind.
"""

from __future__ import annotations

import heapq
import random
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

#: Bound on the search, in comparisons of two ranges. Small heaps get hundreds of trials, huge ones a single one.
EFFORT = 20_000
#: Above this many pairs that live together, neighbours are not listed and ranges are placed as they come.
MAX_PAIRS = 400_000
#: The end of the gap above everything.
_ENDLESS = 1 << 63

Span = tuple[int, int]  # start and end, in bytes


@dataclass(frozen=True, slots=True)
class Block:
    """Bytes needed from ``first`` to ``last``, both inclusive."""

    bytes: int
    first: int
    last: int


def pack(blocks: Sequence[Block], bound: int) -> tuple[list[int], int]:
    """An offset for each block, and the size of the heap. ``bound`` is a lower bound at which to stop searching.

    Deterministic. Sizes must be multiples of the alignment wanted; offsets then are too.
    """
    if not blocks:
        return [], 0
    by_start = sorted(range(len(blocks)), key=lambda i: (blocks[i].first, -blocks[i].bytes, i))
    by_size = sorted(by_start, key=lambda i: (-blocks[i].bytes, blocks[i].first))
    if _count_pairs(blocks, by_start) > MAX_PAIRS:
        return _sweep(blocks, by_start)
    if sum(block.bytes for block in blocks) <= bound:  # all are alive at one time
        return _stack(blocks, by_size)
    neighbours = _neighbours(blocks, by_start)
    cost = len(blocks) + sum(map(len, neighbours))
    trials = max(1, EFFORT // cost)
    orders = [
        by_size,
        by_start,
        sorted(by_start, key=lambda i: -blocks[i].bytes * (1 + blocks[i].last - blocks[i].first)),
        sorted(by_start, key=lambda i: (blocks[i].first - blocks[i].last, -blocks[i].bytes)),
    ]
    best: tuple[int, list[int], list[int], bool] | None = None
    for trial in range(min(trials, 2 * len(orders))):
        order, best_fit = orders[trial // 2], trial % 2 == 1
        offsets, size = _place(blocks, order, neighbours, best_fit)
        if best is None or size < best[0]:
            best = size, offsets, order, best_fit
        if size <= bound:
            return offsets, size
    assert best is not None
    return _climb(blocks, neighbours, best, bound, trials - 2 * len(orders))


def _climb(
    blocks: Sequence[Block],
    neighbours: list[list[int]],
    start: tuple[int, list[int], list[int], bool],
    bound: int,
    trials: int,
) -> tuple[list[int], int]:
    """Swap two blocks of the placing order at a time; keep what is no worse."""
    size, offsets, order, best_fit = start
    chance = random.Random(len(blocks))
    for _ in range(trials):
        if size <= bound:
            break
        a, b = chance.randrange(len(order)), chance.randrange(len(order))
        candidate = order.copy()
        candidate[a], candidate[b] = candidate[b], candidate[a]
        found, found_size = _place(blocks, candidate, neighbours, best_fit)
        if found_size <= size:
            size, offsets, order = found_size, found, candidate
    return offsets, size


def _count_pairs(blocks: Sequence[Block], by_start: list[int]) -> int:
    """How many pairs of blocks are alive at the same time."""
    ends = sorted(block.last for block in blocks)
    return sum(before - bisect_left(ends, blocks[i].first) for before, i in enumerate(by_start))


def _neighbours(blocks: Sequence[Block], by_start: list[int]) -> list[list[int]]:
    """Per block, those alive at the same time."""
    found: list[list[int]] = [[] for _ in blocks]
    active: list[int] = []
    soonest = -1  # when the first of the active ones ends
    for i in by_start:
        start = blocks[i].first
        if soonest < start:
            active = [a for a in active if blocks[a].last >= start]
            soonest = min((blocks[a].last for a in active), default=_ENDLESS)
        for a in active:
            found[a].append(i)
        found[i].extend(active)
        active.append(i)
        soonest = min(soonest, blocks[i].last)
    return found


def _place(
    blocks: Sequence[Block], order: list[int], neighbours: list[list[int]], best_fit: bool
) -> tuple[list[int], int]:
    """Put each block into the lowest gap (or the tightest) that its placed neighbours leave."""
    offsets = [0] * len(blocks)
    placed: list[Span | None] = [None] * len(blocks)
    size = 0
    for i in order:
        need = blocks[i].bytes
        taken = sorted(filter(None, map(placed.__getitem__, neighbours[i])))
        end = 0
        chosen, slack = -1, 0
        for low, high in taken:
            gap = low - end
            if gap >= need and (chosen < 0 or gap < slack):
                chosen, slack = end, gap
                if not best_fit:
                    break
            if high > end:
                end = high
        offsets[i] = start = chosen if chosen >= 0 else end
        placed[i] = start, start + need
        size = max(size, start + need)
    return offsets, size


def _stack(blocks: Sequence[Block], order: list[int]) -> tuple[list[int], int]:
    """One after another: what placing comes to where all overlap."""
    offsets = [0] * len(blocks)
    end = 0
    for i in order:
        if blocks[i].bytes:
            offsets[i] = end
            end += blocks[i].bytes
    return offsets, end


def _sweep(blocks: Sequence[Block], by_start: list[int]) -> tuple[list[int], int]:
    """First fit in order of first use. Only the gaps between live ranges are searched, and the ranges that end are
    found by a heap: with thousands alive at once, walking them all for each block would be quadratic.
    """
    offsets = [0] * len(blocks)
    size = 0
    gaps: list[Span] = [(0, _ENDLESS)]
    leaving: list[tuple[int, int]] = []  # (last use, block)
    for i in by_start:
        need = blocks[i].bytes
        while leaving and leaving[0][0] < blocks[i].first:
            gone = heapq.heappop(leaving)[1]
            _free(gaps, offsets[gone], offsets[gone] + blocks[gone].bytes)
        if not need:
            continue
        at = next(k for k, (low, high) in enumerate(gaps) if high - low >= need)
        low, high = gaps[at]
        gaps[at : at + 1] = [(low + need, high)] if low + need < high else []
        offsets[i] = low
        size = max(size, low + need)
        heapq.heappush(leaving, (blocks[i].last, i))
    return offsets, size


def _free(gaps: list[Span], low: int, high: int) -> None:
    """Add a gap, joined with those it touches."""
    at = bisect_left(gaps, (low, high))
    first, last = at, at
    if at and gaps[at - 1][1] == low:
        first, low = at - 1, gaps[at - 1][0]
    if at < len(gaps) and gaps[at][0] == high:
        last, high = at + 1, gaps[at][1]
    gaps[first:last] = [(low, high)]
