"""Where in the cyclic frame to issue one kind of barrier, so that each hazard has one between its two ends."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping


def place(hazards: Mapping[int, int], length: int) -> list[int]:
    """A set of positions from which none can be taken away.

    ``hazards`` maps the position of a later access to the latest earlier one it must be kept from, counted from the
    start of the later one's frame: negative for an access in a frame before. A barrier at ``p`` is issued before the
    sub-pass at ``p``; it serves a hazard ``(earlier, later)`` when ``earlier < p <= later``, in any of the frames.
    Each is set as late as the first hazard that still needs one allows, then those that the next frame's round proves
    redundant are dropped.
    """
    order = sorted(hazards)
    points: list[int] = []
    for later in order:
        if not points or points[-1] <= hazards[later]:
            points.append(later)
    at = 0
    while at < len(points) and len(points) > 1:
        if _redundant(points, at, order, hazards, length):
            del points[at]
        else:
            at += 1
    return points


def _redundant(points: list[int], at: int, order: list[int], hazards: Mapping[int, int], length: int) -> bool:
    """Whether everything that the barrier ``points[at]`` serves last is served by the one before it too."""
    before = points[at - 1] if at > 0 else points[-1] - length
    end = points[at + 1] if at + 1 < len(points) else length
    served = order[bisect_left(order, points[at]) : bisect_left(order, end)]
    if not all(hazards[later] < before for later in served):
        return False
    if end < length:
        return True
    wrapped = order[: bisect_left(order, points[0])]  # those of the next frame that no barrier of it comes before
    return all(hazards[later] + length < before for later in wrapped)
