"""Placing ranges in one heap: who lives at the same time must not overlap, and the heap should be small.

This is offline dynamic storage allocation, NP-hard. Placing big ones first nearly always meets the lower bound (most
bytes live at once); a few orders and a bounded local search do the rest. TFLite's and RPS's packers are of this kind.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

#: Bound on the search, in comparisons of two ranges. Small heaps get hundreds of trials, huge ones a single one.
EFFORT = 20_000
#: Above this many pairs that live together, neighbours are not listed and ranges are placed as they come.
MAX_PAIRS = 400_000


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
    neighbours = _neighbours(blocks, by_start)
    if neighbours is None:
        return _sweep(blocks, by_start)
    cost = len(blocks) + sum(map(len, neighbours))
    trials = max(1, EFFORT // cost)
    orders = [
        sorted(by_start, key=lambda i: (-blocks[i].bytes, blocks[i].first)),
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


def _neighbours(blocks: Sequence[Block], by_start: list[int]) -> list[list[int]] | None:
    """Per block, those alive at the same time; ``None`` when they are too many to list."""
    found: list[list[int]] = [[] for _ in blocks]
    active: list[int] = []
    pairs = 0
    for i in by_start:
        start = blocks[i].first
        active = [a for a in active if blocks[a].last >= start]
        pairs += len(active)
        if pairs > MAX_PAIRS:
            return None
        for a in active:
            found[a].append(i)
        found[i].extend(active)
        active.append(i)
    return found


def _place(
    blocks: Sequence[Block], order: list[int], neighbours: list[list[int]], best_fit: bool
) -> tuple[list[int], int]:
    """Put each block into the lowest gap (or the tightest) that its placed neighbours leave."""
    offsets = [-1] * len(blocks)
    size = 0
    for i in order:
        need = blocks[i].bytes
        taken = sorted([(offsets[n], offsets[n] + blocks[n].bytes) for n in neighbours[i] if offsets[n] >= 0])
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
        offsets[i] = chosen if chosen >= 0 else end
        size = max(size, offsets[i] + need)
    return offsets, size


def _sweep(blocks: Sequence[Block], by_start: list[int]) -> tuple[list[int], int]:
    """First fit in order of first use, with the live ranges kept sorted by offset."""
    offsets = [0] * len(blocks)
    size = 0
    live: list[tuple[int, int, int]] = []  # offset, end, last use
    for i in by_start:
        live = [entry for entry in live if entry[2] >= blocks[i].first]
        end, at = 0, len(live)
        for k, (low, high, _) in enumerate(live):
            if low - end >= blocks[i].bytes:
                at = k
                break
            end = high
        offsets[i] = end
        live.insert(at, (end, end + blocks[i].bytes, blocks[i].last))
        size = max(size, end + blocks[i].bytes)
    return offsets, size
