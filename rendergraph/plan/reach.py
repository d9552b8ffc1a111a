"""Which writers each pass is bound to run before, kept true while more bounds are found."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

Followers = Sequence[Mapping[int, str]]  # pass -> passes that must come later, each with the resource that says so


class Reach:
    """Per pass, the set of ``writers`` that must come after it, as bits of an integer.

    ``passes`` is a legal order of all passes.
    """

    def __init__(self, followers: Followers, passes: Sequence[int], writers: Iterable[int]) -> None:
        self._bit = bit = {p: 1 << i for i, p in enumerate(sorted(writers))}
        self._later = later = [0] * len(followers)
        for p in reversed(passes):
            for follower in followers[p]:
                later[p] |= later[follower] | bit.get(follower, 0)
        self._before: list[list[int]] = []  # pass -> passes that must come earlier: made when it is first needed
        self._done: set[int] = set()  # no longer asked for, nor is anything before them

    def __call__(self, earlier: int, writer: int) -> bool:
        """Whether a pass is bound to run before a writer."""
        return self._later[earlier] & self._bit[writer] > 0

    def chain(self, writers: Iterable[int]) -> list[int] | None:
        """Writers in their order, if every two of them have one."""
        found = list(writers)
        together = sum(self._bit[w] for w in found)
        found.sort(key=lambda w: -(self._later[w] & together).bit_count())
        return found if all(self(a, b) for a, b in pairwise(found)) else None

    def place(self, reader: int, chain: Sequence[int]) -> int:
        """How many of the writers of a chain a reader is not bound to run before."""
        return bisect_left(chain, True, key=lambda writer: self(reader, writer))

    def add(self, followers: Followers, edges: Iterable[tuple[int, int]], asked: Collection[int]) -> set[int]:
        """Take in ``edges`` (already in ``followers``); the passes whose sets grew by it.

        Only passes in ``asked`` will be asked for again. What lies before none of them is given up: else a long
        ladder of contests, each decided by the one before, would carry every rung back to the first.
        """
        if not self._before:
            self._before = [[] for _ in followers]
            for p, after in enumerate(followers):
                for later in after:
                    self._before[later].append(p)
        else:
            for a, b in edges:
                self._before[b].append(a)
        grown: set[int] = set()
        stack = list(edges)
        while stack:
            a, b = stack.pop()
            found = self._later[a] | self._later[b] | self._bit.get(b, 0)
            if found != self._later[a]:
                self._later[a] = found
                grown.add(a)
                stack += [(earlier, a) for earlier in self._before[a] if not self._given_up(earlier, asked)]
        return grown

    def in_circle(self, passes: Iterable[int]) -> bool:
        """Whether one of some passes is bound to run before itself; seen only of writers."""
        return any(self._later[p] & self._bit.get(p, 0) for p in passes)

    def _given_up(self, p: int, asked: Collection[int]) -> bool:
        if p in self._done:
            return True
        if p in asked or not all(earlier in self._done for earlier in self._before[p]):
            return False
        self._done.add(p)
        return True
