"""The short cuts of the packer place every block where the plain algorithms would."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.plan import packing
from rendergraph.plan.packing import Block, pack

bounded = settings(max_examples=150, deadline=None, derandomize=True)


@st.composite
def block_lists(draw: st.DrawFn, together: bool = False) -> list[Block]:
    """Blocks in a frame of 12 steps; ``together``: all alive at step 6."""
    found = []
    for _ in range(draw(st.integers(1, 14))):
        first = draw(st.integers(0, 6 if together else 11))
        last = draw(st.integers(max(first, 6) if together else first, 11))
        found.append(Block(256 * draw(st.integers(0, 4)), first, last))
    return found


def load(blocks: list[Block]) -> int:
    """Most bytes alive at once."""
    return max(sum(b.bytes for b in blocks if b.first <= at <= b.last) for at in range(12))


def first_fit(blocks: list[Block]) -> list[int]:
    """By first use, each at the lowest offset that leaves it clear of all that live with it."""
    offsets: dict[int, int] = {}
    for i in sorted(range(len(blocks)), key=lambda i: (blocks[i].first, -blocks[i].bytes, i)):
        mine = blocks[i]
        alive = [(offsets[k], offsets[k] + blocks[k].bytes) for k in offsets if blocks[k].last >= mine.first]
        alive = [(low, high) for low, high in alive if low < high]
        tries = sorted({0, *(high for _, high in alive)})
        offsets[i] = next(o for o in tries if all(o + mine.bytes <= low or high <= o for low, high in alive))
    return [offsets[i] for i in range(len(blocks))]


@bounded
@given(block_lists())
def test_the_sweep_is_first_fit(blocks: list[Block]) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(packing, "MAX_PAIRS", -1)
        offsets, size = pack(blocks, load(blocks))
    solid = [i for i, block in enumerate(blocks) if block.bytes]
    expected = first_fit(blocks)
    assert [offsets[i] for i in solid] == [expected[i] for i in solid]
    assert size == max((offsets[i] + blocks[i].bytes for i in solid), default=0)


@bounded
@given(block_lists(together=True))
def test_blocks_of_one_moment_are_stacked_as_the_search_would(blocks: list[Block]) -> None:
    by_start = sorted(range(len(blocks)), key=lambda i: (blocks[i].first, -blocks[i].bytes, i))
    by_size = sorted(by_start, key=lambda i: (-blocks[i].bytes, blocks[i].first))
    searched = packing._place(blocks, by_size, packing._neighbours(blocks, by_start), best_fit=False)
    assert pack(blocks, load(blocks)) == searched
    assert searched[1] == sum(block.bytes for block in blocks)


@bounded
@given(block_lists())
def test_no_two_blocks_meet(blocks: list[Block]) -> None:
    for pairs in (-1, packing.MAX_PAIRS):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(packing, "MAX_PAIRS", pairs)
            offsets, size = pack(blocks, load(blocks))
        assert load(blocks) <= size
        for i, a in enumerate(blocks):
            for k, b in enumerate(blocks[:i]):
                if a.first <= b.last and b.first <= a.last and a.bytes and b.bytes:
                    assert offsets[i] + a.bytes <= offsets[k] or offsets[k] + b.bytes <= offsets[i]
