"""The rank tests against published critical values and against counting every arrangement."""

from itertools import combinations, product

import numpy as np
import pytest

from rendergraph.measure.rank_tests import RankTest, average_ranks, mann_whitney, signed_rank
from rendergraph.measure.student import student_critical, two_sided_p

#: Critical values of U, two-sided 0.05 and 0.01 (Siegel and Castellan, "Nonparametric Statistics", table J; Mann and
#: Whitney 1947): the largest U that is significant, -1 for none.
U_TABLE = {
    (3, 3): (-1, -1),
    (4, 4): (0, -1),
    (5, 5): (2, 0),
    (5, 8): (6, 2),
    (6, 6): (5, 2),
    (7, 10): (14, 9),
    (8, 8): (13, 7),
    (8, 12): (22, 15),
    (10, 10): (23, 16),
    (10, 15): (39, 29),
    (12, 12): (37, 27),
    (15, 15): (64, 51),
    (20, 20): (127, 105),
}
#: Critical values of Wilcoxon's T, two-sided 0.05 and 0.01 (McCornack 1965; Zar, "Biostatistical Analysis", B.12).
T_TABLE = {
    5: (-1, -1),
    6: (0, -1),
    7: (2, -1),
    8: (3, 0),
    9: (5, 1),
    10: (8, 3),
    12: (13, 7),
    15: (25, 15),
    20: (52, 37),
    25: (89, 68),
    30: (137, 109),
    40: (264, 220),
    50: (434, 373),
}


def floats(*values: float) -> np.ndarray:
    """A 1-d array."""
    return np.array(values, np.float64)


@pytest.mark.parametrize("sizes", U_TABLE)
def test_mann_whitney_against_the_published_table(sizes: tuple[int, int]) -> None:
    test = mann_whitney(np.arange(sizes[0], dtype=float), np.arange(sizes[1]) + 0.5)
    assert (test.critical(0.05), test.critical(0.01)) == U_TABLE[sizes]


@pytest.mark.parametrize("count", T_TABLE)
def test_signed_rank_against_the_published_table(count: int) -> None:
    test = signed_rank(np.arange(1.0, count + 1))
    assert (test.critical(0.05), test.critical(0.01)) == T_TABLE[count]


@pytest.mark.parametrize(("m", "n"), [(1, 1), (2, 3), (3, 3), (4, 5)])
def test_the_exact_distribution_of_u_is_the_count_of_all_arrangements(m: int, n: int) -> None:
    found = np.zeros(m * n + 1)
    for chosen in combinations(range(m + n), m):
        rest = [i for i in range(m + n) if i not in chosen]
        found[sum(b > a for a, b in product(chosen, rest))] += 1
    tail = mann_whitney(np.arange(m, dtype=float), np.arange(n) + 0.5).lower_tail
    assert tail is not None
    np.testing.assert_allclose(tail, np.cumsum(found) / found.sum(), rtol=0, atol=1e-15)


@pytest.mark.parametrize("count", [1, 2, 5, 8])
def test_the_exact_distribution_of_t_is_the_count_of_all_signs(count: int) -> None:
    found = np.zeros(count * (count + 1) // 2 + 1)
    for signs in product((0, 1), repeat=count):
        found[sum(rank * sign for rank, sign in zip(range(1, count + 1), signs, strict=True))] += 1
    tail = signed_rank(np.arange(1.0, count + 1)).lower_tail
    assert tail is not None
    np.testing.assert_allclose(tail, np.cumsum(found) / found.sum(), rtol=0, atol=1e-15)


def test_u_counts_pairs_and_ties_a_half() -> None:
    # (1, 2) and (2, 3): 2 > 1, 2 = 2, 3 > 1, 3 > 2
    assert mann_whitney(floats(1, 2), floats(2, 3)).statistic == 3.5


def test_t_is_the_rank_sum_of_the_positive_differences_without_zeros() -> None:
    # sizes 1, 2, 2, 4 have ranks 1, 2.5, 2.5, 4; positive are 1 and 2
    assert signed_rank(floats(0, 1, 2, -2, -4, 0)).statistic == 3.5


def test_p_of_complete_separation() -> None:
    assert mann_whitney(np.arange(5.0), np.arange(5.0) + 9).p_value() == pytest.approx(2 / 252)
    assert signed_rank(np.arange(1.0, 7)).p_value() == pytest.approx(2 / 64)


def test_p_is_two_sided_and_symmetric() -> None:
    a, b = floats(1, 4, 5, 9, 11), floats(2, 3, 8, 12, 13, 14)
    assert mann_whitney(a, b).p_value() == pytest.approx(mann_whitney(b, a).p_value())
    assert mann_whitney(a, a).p_value() == 1.0


def test_the_approximation_is_near_the_exact_one() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        a, b = rng.normal(size=20), rng.normal(0.6, size=20)
        exact = mann_whitney(a, b)
        rough = RankTest(exact.statistic, exact.most, exact.deviation, np.inf)
        assert rough.p_value() == pytest.approx(exact.p_value(), rel=0.1, abs=2e-3)


def test_ties_narrow_the_distribution() -> None:
    # 1, 1, 2, 2 against 1, 2, 2, 2: mn/12 * (N + 1 - sum(t^3 - t) / (N (N - 1))) = 16/12 * (9 - (24 + 120) / 56)
    test = mann_whitney(floats(1, 1, 2, 2), floats(1, 2, 2, 2))
    assert test.deviation**2 == pytest.approx(16 / 12 * (9 - 144 / 56))
    assert test.lower_tail is None


def test_identical_samples_show_nothing() -> None:
    same = np.full(30, 2.0)
    assert mann_whitney(same, same).p_value() == 1.0
    assert signed_rank(np.zeros(30)).p_value() == 1.0


def test_inflation_weakens_the_evidence() -> None:
    a, b = np.arange(20.0), np.arange(20.0) + 8.5
    assert mann_whitney(a, b).p_value() < mann_whitney(a, b, 2.0, 18).p_value() < mann_whitney(a, b, 5.0, 6).p_value()


def test_average_ranks() -> None:
    assert average_ranks(floats(3, 1, 3, 2)).tolist() == [3.5, 1, 3.5, 2]


@pytest.mark.parametrize(
    ("freedom", "value"), [(4, 4.604), (5, 4.032), (7, 3.499), (10, 3.169), (20, 2.845), (60, 2.660), (np.inf, 2.576)]
)
def test_student_against_the_published_table(freedom: float, value: float) -> None:
    """Two-sided 0.01; the approximation is 1.5 % off at 4 degrees of freedom and on the safe side."""
    assert value * 0.9995 <= student_critical(0.01, freedom) <= value * 1.016
    assert two_sided_p(student_critical(0.01, freedom), freedom) == pytest.approx(0.01)


def test_student_without_freedom_shows_nothing() -> None:
    assert two_sided_p(100.0, 0.0) == 1.0
    assert student_critical(0.01, -1.0) == np.inf
