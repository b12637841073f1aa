"""Chains of constant rates that lie many orders of magnitude apart, against mpmath; and of hundreds of members."""

from __future__ import annotations

import sys
from pathlib import Path as File

import mpmath as mp
import numpy as np
import pytest

sys.path.insert(0, str(File(__file__).parent))
from solving import sharing, solved, standby

from robophm.blocks.diagram import LoadSharing, Standby
from robophm.groups.markov_chain import Chain
from robophm.life.exponential import Exponential

GROUPS = [standby(2), standby(3, 1, 0.1, 0.9), standby(3, 2, 1.0), standby(4, 2, 0.1, 0.9), sharing(3, 1, 2.0),
          sharing(4, 2, 3.0)]  # fmt: skip
RATES = [(1e12, 1e-3, 1.0, 3e5), (1e-3, 1e12, 1e-3 * (1 + 1e-13), 1.0), (1e-3, 1e-3, 1e12, 1e12), (1e-9, 1e9, 1.0, 1.0)]


def exact(group: Standby | LoadSharing, rates: tuple[float, ...], t: float, length: float) -> tuple[mp.mpf, ...]:
    """P(works at t), and P(works then, fails in the stretch after it), over all sets of failed members."""
    n = len(group.members)
    last = 2**n
    generator = mp.zeros(last + 1)
    for failed in range(last):
        alive = [i for i in range(n) if not failed >> i & 1]
        for place, i in enumerate(alive):
            after, rate = failed | 1 << i, mp.mpf(rates[i])
            if isinstance(group, LoadSharing):
                works = len(alive) > group.k
                ways = [(after if works else last, mp.mpf(group.factors[min(n - len(alive), len(group.factors) - 1)]))]
            elif place >= group.active:
                ways = [(after, mp.mpf(group.dormancy))]
            elif len(alive) > group.active:
                ways = [(after, mp.mpf(group.switch)), (last, 1 - mp.mpf(group.switch))]
            else:
                ways = [(last, mp.mpf(1))]
            for to, weight in ways:
                generator[failed, to] += weight * rate
                generator[failed, failed] -= weight * rate

    def after_(v: mp.matrix, time: float) -> mp.matrix:
        halvings = max(int(mp.ceil(mp.log(mp.mpf(time) * 1e13, 2))), 0) + 8
        step = generator * (mp.mpf(time) / mp.mpf(2) ** halvings)
        total = term = mp.eye(last + 1)
        for k in range(1, 25):
            term = term * step / k
            total = total + term
        for _ in range(halvings):
            total = total * total
        return v * total

    begin = mp.zeros(1, last + 1)
    begin[0] = 1
    then = after_(begin, t)
    alive_then = then.copy()
    alive_then[last] = 0
    return mp.fsum(alive_then), after_(alive_then, length)[last]


@pytest.mark.parametrize("group", GROUPS[:3])
@pytest.mark.parametrize("rates", RATES)
def test_rates_far_apart(group: Standby | LoadSharing, rates: tuple[float, ...]) -> None:
    check(group, rates, 40.0, 1e-6)


@pytest.mark.full
@pytest.mark.parametrize("group", GROUPS)
@pytest.mark.parametrize("rates", RATES)
@pytest.mark.parametrize(("t", "length"), [(1e-9, 1e-6), (1.0, 1e-3), (300.0, 700.0)])
def test_rates_far_apart_in_all_groups(
    group: Standby | LoadSharing, rates: tuple[float, ...], t: float, length: float
) -> None:
    check(group, rates, t, length)


def check(group: Standby | LoadSharing, rates: tuple[float, ...], t: float, length: float) -> None:
    rates = rates[: len(group.members)]
    one = solved(group, [Exponential(rate) for rate in rates], way=Chain)
    with mp.workdps(70):
        works, fails = (mp.log(p) for p in exact(group, rates, t, length))
    found = one.log_works(np.array([t]))[0], one.log_fails_in(np.array([t]), np.array([length]))[0]
    assert found[0] == pytest.approx(float(works), rel=1e-12, abs=1e-12)
    assert found[1] == pytest.approx(float(fails), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("n", "t"), [(30, 1e-3), (30, 40.0), (100, 60.0), (100, 420.0)])
def test_many_cold_spares_make_an_erlang_life(n: int, t: float) -> None:
    one = solved(standby(n), [Exponential(2.0)] * n)
    works, fails = (float(mp.log(mp.gammainc(n, *ends, regularized=True))) for ends in ((2 * t, mp.inf), (0, 2 * t)))
    assert one.log_works(np.array([t]))[0] == pytest.approx(works, rel=1e-12, abs=1e-12)
    assert one.log_fails_in(np.zeros(1), np.array([t]))[0] == pytest.approx(fails, rel=1e-12, abs=1e-12)


def test_far_beyond_what_a_number_holds() -> None:
    """One slow and one fast part in cold standby: soon only the slow one is left, for ever at its rate."""
    one = solved(standby(2), [Exponential(1e6), Exponential(1.0)])
    np.testing.assert_allclose(one.lived(np.array([5e3, 1e6]), np.array([1.0, 50.0])), [1.0, 50.0], rtol=1e-12)
