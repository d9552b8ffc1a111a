"""Which settings a sweep measures."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.points import MOST_POINTS, all_points, hypercube


def axis(name: str, count: int) -> Axis:
    return Axis(name, f"passes.p.set.{name}", tuple(str(k) for k in range(count)))


def test_the_cross_product_has_the_last_axis_fastest() -> None:
    points = all_points([axis("a", 2), axis("b", 3)])
    assert [p.choice for p in points] == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]
    assert [p.index for p in points] == list(range(6))
    assert points[4].overrides([axis("a", 2), axis("b", 3)]) == ("passes.p.set.a=1", "passes.p.set.b=1")


def test_a_million_points_are_refused_with_the_count() -> None:
    with pytest.raises(RenderGraphError) as refused:
        all_points([axis("a", 1000), axis("b", 1000)])
    (told,) = refused.value.diagnostics
    assert told.code == "RG753"
    assert told.data["count"] == 1_000_000
    assert "--samples" in told.help
    assert len(all_points([axis("a", 40), axis("b", 50)])) == MOST_POINTS == 2000
    with pytest.raises(RenderGraphError):
        all_points([axis("a", 3), axis("b", 667)])


def test_a_hypercube_that_is_too_large_is_refused_too() -> None:
    with pytest.raises(RenderGraphError) as refused:
        hypercube([axis("a", 4)], MOST_POINTS + 1)
    assert refused.value.diagnostics[0].code == "RG753"


@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    sizes=st.lists(st.integers(2, 6), min_size=2, max_size=6), times=st.integers(1, 5), seed=st.integers(0, 2**32 - 1)
)
def test_a_hypercube_shows_each_value_equally_often(sizes: list[int], times: int, seed: int) -> None:
    axes = [axis(f"k{at}", size) for at, size in enumerate(sizes)]
    count = 60 * times  # divides by every size
    points = hypercube(axes, count, seed)
    assert points == hypercube(axes, count, seed), "the same seed, the same settings"
    assert len({p.choice for p in points}) == len(points), "what coincides is measured once"
    for at, size in enumerate(sizes):
        shown = Counter(p.choice[at] for p in points)
        assert set(shown) == set(range(size))
        assert max(shown.values()) <= count // size
        if len(points) == count:
            assert set(shown.values()) == {count // size}


@settings(deadline=None, derandomize=True, max_examples=60)
@given(count=st.integers(1, 60), size=st.integers(60, 90), seed=st.integers(0, 1000))
def test_strata_of_a_hypercube_are_balanced(count: int, size: int, seed: int) -> None:
    """With more values than samples no value is used twice on any axis: one in each stratum."""
    axes = [axis("a", size), axis("b", size)]
    points = hypercube(axes, count, seed)
    assert len(points) == count
    for at in range(2):
        assert max(Counter(p.choice[at] for p in points).values()) == 1


def test_seeds_differ() -> None:
    axes = [axis("a", 50), axis("b", 50)]
    assert hypercube(axes, 20, 1) != hypercube(axes, 20, 2)
