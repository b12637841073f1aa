"""Replacement by condition: cycles counted one by one, closed forms, and the laws that hold at its ends."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import weibull_min

from robophm.learning.maintenance.condition_based import WearPaths, age_cost, best_condition_policy, condition_cost
from robophm.learning.maintenance.replacement_age import Costs

COSTS = Costs(300.0, 2000.0, 2.0, 30.0)
LEVELS = np.array([0.2, 0.5, 0.95])
SHARES = np.linspace(0, 1, 1001)
LIVES = weibull_min.ppf((np.arange(400) + 0.5) / 400, 3.0, scale=500.0)


def test_one_life_by_hand():
    """Level 0.5 comes at 50 and is found at 60; 0.95 comes at 95, and the next look would be at 120, after the end."""
    cost = condition_cost(WearPaths(SHARES[None], np.array([[100.0]])), LEVELS, COSTS, 7.0, 30.0)
    assert cost.rate[:2] == pytest.approx([(300 + 7) / 32, (300 + 2 * 7) / 62])
    assert cost.rate[2] == pytest.approx((2000 + 3 * 7) / 130)
    assert cost.fails.tolist() == [0, 0, 1]


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_cycles_that_are_lived_one_by_one_cost_as_much(noise):
    """Two paths, by the square and by the root of age, of which one ends before it comes to the last level."""
    wear = np.array([SHARES**2, 0.9 * SHARES**0.5])
    found = condition_cost(WearPaths(wear, np.array([LIVES, LIVES]), noise), LEVELS, COSTS, 5.0, 120.0)
    rng = np.random.default_rng(4)
    for level in range(3):
        spent, lasted, failed = np.zeros(4000), np.zeros(4000), 0
        for i, path in enumerate(rng.integers(0, 2, 4000)):
            end = float(rng.choice(LIVES))
            at = 120.0
            while at < end:
                share = at / end
                if (0.9 * share**0.5 if path else share**2) + noise * rng.standard_normal() >= LEVELS[level]:
                    break
                spent[i] += 5
                at += 120
            if at < end:
                spent[i], lasted[i] = spent[i] + 5 + 300, at + 2
            else:
                spent[i], lasted[i], failed = spent[i] + 2000, end + 30, failed + 1
        rate = spent.mean() / lasted.mean()
        error = float(np.std(spent - rate * lasted) / math.sqrt(4000) / lasted.mean())
        both = error * (math.sqrt(1 + 4000 / 800) if noise else 1.0)  # 800 cycles have noise of their own
        assert found.rate[level] == pytest.approx(rate, abs=3.5 * both)
        assert found.fails[level] == pytest.approx(failed / 4000, abs=0.04)


def test_replacement_by_age_is_as_published():
    """C(T) = (c_p·S + c_f·F)/(∫S + d_p·S + d_f·F), by quadrature; and what every look replaces is replaced by age."""
    lives = weibull_min.ppf((np.arange(20_000) + 0.5) / 20_000, 3.0, scale=500.0)
    for age in (100.0, 400.0, 900.0):
        survives = weibull_min.sf(age, 3.0, scale=500.0)
        lasts = quad(weibull_min.sf, 0, age, args=(3.0, 0.0, 500.0))[0]
        spent = 300 * survives + 2000 * (1 - survives)
        expected = spent / (lasts + 2 * survives + 30 * (1 - survives))
        assert age_cost(lives, COSTS, age).rate == pytest.approx(expected, rel=1e-3)
        every = condition_cost(WearPaths(SHARES[None], lives[None]), np.array([0.0]), COSTS, 0.0, age).rate
        assert every == pytest.approx([expected], rel=1e-3)
    never = 2000 / (weibull_min.mean(3.0, scale=500.0) + 30)
    assert age_cost(lives, COSTS, math.inf).rate == pytest.approx(never, rel=1e-3)


def test_the_best_policy():
    """Looks that cost nothing find wear just before the end; dear ones are rarer; without reason to replace, never."""
    costs, paths = Costs(300.0, 2000.0), WearPaths(SHARES[None] ** 2, LIVES[None])
    free, some, dear = (best_condition_policy(paths, costs, each) for each in (0.0, 5.0, 150.0))
    assert free.fails < 0.02
    assert free.cost_rate == pytest.approx(300 / LIVES.mean(), rel=0.06)
    assert free.cost_rate < some.cost_rate < dear.cost_rate
    assert some.interval < dear.interval
    assert some.cost_rate < some.by_age < some.never
    assert 0 < some.saving < 1
    for level, interval in ((0.9, 1.0), (1.05, 1.0), (1.0, 0.8), (1.0, 1.3)):
        near = condition_cost(paths, np.array([level * some.level]), costs, 5.0, interval * some.interval)
        assert near.rate[0] >= 0.99 * some.cost_rate
    blurred = best_condition_policy(WearPaths(paths.wear, paths.lives, 0.1), costs, 5.0)
    assert some.cost_rate < blurred.cost_rate < some.by_age
    alike = best_condition_policy(paths, Costs(300.0, 300.0), 5.0)
    assert alike.age is None
    assert alike.by_age == alike.never
