"""Replacement by condition: simulated lives, and the laws that hold at its ends."""

import numpy as np
import pytest
from scipy.stats import gamma

from robophm.core.errors import DataError
from robophm.learning.maintenance.condition_based import (
    GammaWear,
    age_cost_rate,
    best_condition_policy,
    condition_cost_rate,
)
from robophm.learning.maintenance.replacement_age import Costs

WEAR = GammaWear(0.08, 0.5, 20.0)  # 500 h in the mean, a step of 0.5 each twelve
COSTS = Costs(300.0, 2000.0, 2.0, 30.0)


def simulated(threshold: float, interval: float, inspection: float, lives: int, seed: int) -> tuple[float, float]:
    """Cost rate, and its standard error, of lives drawn interval by interval; within one a failure is found by halves.

    The gamma bridge: given what an interval gained, half of it is a Beta share.
    """
    rng = np.random.default_rng(seed)
    spent, lasted = np.zeros(lives), np.zeros(lives)
    for i in range(lives):
        x, t = 0.0, 0.0
        while True:
            step = rng.gamma(WEAR.shape_rate * interval, WEAR.scale)
            if x + step >= WEAR.limit:
                low, width, gained = x, interval, step
                while width > 1e-4 * interval:
                    shape = WEAR.shape_rate * width / 2
                    first = gained * rng.beta(shape, shape)
                    width /= 2
                    if low + first >= WEAR.limit:
                        gained = first
                    else:
                        low, gained, t = low + first, gained - first, t + width
                spent[i] += COSTS.corrective
                lasted[i] = t + COSTS.corrective_downtime
                break
            x, t = x + step, t + interval
            spent[i] += inspection
            if x >= threshold:
                spent[i] += COSTS.preventive
                lasted[i] = t + COSTS.preventive_downtime
                break
    rate = spent.mean() / lasted.mean()
    return rate, float(np.std(spent - rate * lasted) / np.sqrt(lives) / lasted.mean())


@pytest.mark.parametrize(
    ("threshold", "interval", "inspection"), [(12.0, 60.0, 10.0), (18.0, 150.0, 0.0), (4.0, 25.0, 3.0)]
)
def test_lives_that_are_simulated_cost_as_much(threshold, interval, inspection):
    found = condition_cost_rate(WEAR, COSTS, inspection, threshold, interval)
    rate, error = simulated(threshold, interval, inspection, 4000, seed=2)
    assert found == pytest.approx(rate, abs=3.5 * error)
    assert error < 0.03 * rate


def test_without_a_threshold_it_is_replacement_by_age():
    """What every inspection replaces is replaced at an age; what none does, only when it fails."""
    for age in (100.0, 400.0, 900.0):
        survives = gamma.cdf(WEAR.limit, WEAR.shape_rate * age, scale=WEAR.scale)
        times = np.linspace(0, age, 20001)
        lasts = np.trapezoid(gamma.cdf(WEAR.limit, np.maximum(WEAR.shape_rate * times, 1e-12), scale=WEAR.scale), times)
        spent = COSTS.preventive * survives + COSTS.corrective * (1 - survives)
        expected = spent / (lasts + 2 * survives + 30 * (1 - survives))
        assert age_cost_rate(WEAR, COSTS, age) == pytest.approx(expected, rel=1e-6)
        assert condition_cost_rate(WEAR, COSTS, 0.0, 1e-12, age) == pytest.approx(expected, rel=1e-6)
    never = age_cost_rate(WEAR, COSTS, np.inf)
    assert condition_cost_rate(WEAR, COSTS, 0.0, WEAR.limit * (1 - 1e-12), 1e-2 * 500) == pytest.approx(never, rel=0.35)


def test_the_best_policy_is_no_worse_than_any_near_it_nor_than_by_age():
    found = best_condition_policy(WEAR, COSTS, 5.0)
    for a, b in ((0.95, 1.0), (1.05, 1.0), (1.0, 0.9), (1.0, 1.1)):
        near = condition_cost_rate(WEAR, COSTS, 5.0, min(a * found.threshold, WEAR.limit), b * found.interval)
        assert near >= found.cost_rate * (1 - 1e-6)
    assert found.cost_rate < found.by_age < found.never
    assert 0 < found.saving < 1
    dear = best_condition_policy(WEAR, COSTS, 500.0)
    assert dear.interval > found.interval
    assert dear.cost_rate > found.cost_rate


def test_the_law_is_found_again_in_readings_with_noise():
    rng = np.random.default_rng(3)
    times = np.arange(20_000) * 1.0
    wear = np.concatenate(([0.0], np.cumsum(rng.gamma(WEAR.shape_rate, WEAR.scale, len(times) - 1))))
    found = GammaWear.of_readings(times, wear + 0.5 * rng.standard_normal(len(times)), 20.0)
    assert found.mean_rate == pytest.approx(WEAR.mean_rate, rel=0.06)
    assert found.scale == pytest.approx(WEAR.scale, rel=0.25)
    with pytest.raises(DataError, match="3 readings; expected at least 8"):
        GammaWear.of_readings(times[:3], wear[:3], 20.0)
    with pytest.raises(DataError, match="do not come nearer"):
        GammaWear.of_readings(times[:50], -wear[:50], 20.0)
