"""Shares of common causes: figures that others print, and the definitions of the factors read backwards."""

from fractions import Fraction
from itertools import product
from math import comb

import numpy as np
import pytest

from robophm.blocks.common_cause import (
    MOST_PARTS,
    Shares,
    alpha_factor,
    beta_factor,
    multiple_greek_letter,
    shared_causes,
)
from robophm.blocks.diagram import KOutOfN, Parallel, Series
from robophm.blocks.reliability import Structure
from robophm.core.errors import StructureError

PRINTED = 5.0005e-5  # half of the last digit


@pytest.mark.parametrize(
    ("shares", "printed"),
    [
        (multiple_greek_letter([0.1, 0.3], 3), [0.09, 0.0035, 0.003]),
        (alpha_factor([0.95, 0.04, 0.01], 3), [0.095, 0.002, 0.001]),
        (alpha_factor([0.95, 0.04, 0.01], 3, staggered=False), [0.0896, 0.0038, 0.0028]),
    ],
    ids=["mgl", "alpha staggered", "alpha non-staggered"],
)
def test_a_probability_of_a_tenth_is_shared_as_repyability_prints(shares, printed):
    """Doctests of RePyability 0.15 (MIT): MGL and AlphaFactor."""
    assert [0.1 * share for share in shares] == pytest.approx(printed, abs=PRINTED)


def test_a_pair_with_a_beta_factor_is_as_reliable_as_repyability_prints():
    """Doctest of RePyability 0.15 (MIT), CCFGroup: 0.982 of a parallel pair that fails with 0.1 each, 0.99 if alone."""
    alone, both = (0.1 * share for share in beta_factor(0.1, 2))
    pair = Structure(Parallel(Series("a", "both"), Series("b", "both")))
    failed = np.array([{"a": alone, "b": alone, "both": both}[name] for name in pair.names])
    assert pair.state(1 - failed, failed).works == pytest.approx(0.982, abs=PRINTED)


@pytest.mark.parametrize("n", range(2, MOST_PARTS + 1))
def test_a_part_loses_nothing_and_the_factors_come_back(n):
    """The definitions of NUREG/CR-4780 and CR-5485, from the shares: what they say of failures and of events."""

    def of_one(shares: Shares, k: int) -> float:  # of the failures of one part, those that take exactly k
        return comb(n - 1, k - 1) * shares[k - 1]

    letters = [0.1 + 0.8 * k / n for k in range(n - 1)]
    mgl = multiple_greek_letter(letters, n)
    for k, letter in enumerate(letters, 2):
        at_least = [sum(of_one(mgl, j) for j in range(i, n + 1)) for i in (k - 1, k)]
        assert at_least[1] / at_least[0] == pytest.approx(letter, rel=1e-12)

    alpha = [Fraction(n - k, n * (n + 1) // 2) for k in range(n)]
    seen = alpha_factor([float(one) for one in alpha], n, staggered=False)
    events = [comb(n, k) * seen[k - 1] for k in range(1, n + 1)]
    assert [one / sum(events) for one in events] == pytest.approx([float(one) for one in alpha], rel=1e-12)
    tested = alpha_factor([float(one) for one in alpha], n)
    assert [of_one(tested, k) for k in range(1, n + 1)] == pytest.approx([float(one) for one in alpha], rel=1e-12)

    for shares in (mgl, seen, tested, beta_factor(0.25, n)):
        assert sum(of_one(shares, k) for k in range(1, n + 1)) == pytest.approx(1, rel=1e-12)
        every = list(shared_causes(shares))
        for part in range(n):  # its own share, and that of every cause that takes it
            assert shares[0] + sum(share for parts, share in every if part in parts) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("n", range(2, MOST_PARTS + 1))
def test_a_beta_factor_is_the_greek_letters_that_leave_no_one_out(n):
    assert multiple_greek_letter([0.2, *[1.0] * (n - 2)], n) == pytest.approx(beta_factor(0.2, n), abs=1e-15)
    assert [parts for parts, _ in shared_causes(beta_factor(0.2, n))] == [tuple(range(n))]


@pytest.mark.parametrize("k", [1, 2, 3])
def test_a_group_in_a_diagram_is_the_sum_over_all_that_may_happen(k):
    shares = alpha_factor([0.7, 0.2, 0.1], 3)
    every = [((i,), 0.3 * shares[0]) for i in range(3)] + [(parts, 0.3 * q) for parts, q in shared_causes(shares)]
    exact = 0.0
    for happened in product([False, True], repeat=len(every)):
        hit = {part for (parts, _), now in zip(every, happened, strict=True) if now for part in parts}
        if 3 - len(hit) >= k:
            exact += np.prod([q if now else 1 - q for (_, q), now in zip(every, happened, strict=True)])
    group = Structure(KOutOfN(k, *(Series(*(str(parts) for parts, _ in every if i in parts)) for i in range(3))))
    failed = np.array([{str(parts): q for parts, q in every}[name] for name in group.names])
    assert group.state(1 - failed, failed).works == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: beta_factor(0.1, 1), "1 part; expected at least two"),
        (lambda: beta_factor(1.0, 2), "beta 1; expected 0 ≤ beta < 1"),
        (lambda: beta_factor(-0.1, 2), "beta -0.1; expected"),
        (lambda: multiple_greek_letter([0.1], 3), "mgl has 1 letters for 3 parts; expected 2"),
        (lambda: multiple_greek_letter([0.1, 1.3], 3), "expected 0 ≤ beta < 1 and the others from 0 to 1"),
        (lambda: multiple_greek_letter([0.1] * 8, 9), "9 parts; expected at most 8"),
        (lambda: alpha_factor([0.9, 0.1], 3), "alpha has 2 factors for 3 parts; expected 3"),
        (lambda: alpha_factor([0.9, 0.2], 2), "alpha adds up to 1.1; expected 1"),
        (lambda: alpha_factor([0.0, 1.0], 2), "expected the first above 0"),
        (lambda: alpha_factor([float("nan"), 0.1], 2), "expected the first above 0"),
    ],
)
def test_factors_that_say_nothing_are_refused(wrong, says):
    with pytest.raises(StructureError, match=says):
        wrong()
