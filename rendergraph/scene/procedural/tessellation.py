"""How many segments a curve gets at a level of detail."""

from __future__ import annotations


def segments(detail: float, coarse: int, fine: int) -> int:
    """Segments at ``detail`` 0..1, from ``coarse`` to ``fine``: never falls as detail rises."""
    return round(coarse + (fine - coarse) * detail)


def even_segments(detail: float, coarse: int, fine: int) -> int:
    """As ``segments``, rounded to an even number: for shapes with a ridge in the middle."""
    return 2 * segments(detail, coarse // 2, fine // 2)
