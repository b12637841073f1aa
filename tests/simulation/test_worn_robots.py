"""Robots that wear: their laws in closed form, and when they fail."""

import math

import numpy as np
import pytest

from robophm.simulation.worn_robots import (
    BATTERY,
    CRACK,
    GEAR,
    HOURS,
    LIMITS,
    _battery,
    _crack,
    _gear,
    _passage,
    worn_out,
    worn_robots,
)


class Fixed:
    """Draws that are what they are in the mean."""

    def normal(self, mean, _):
        return mean

    def uniform(self, low, high, count=None):
        return (low + high) / 2 if count is None else np.full(count, (low + high) / 2)

    def lognormal(self, _, __):
        return 1.0


def test_a_crack_and_a_battery_go_by_their_closed_forms():
    """Of m = 3: a^(−1/2) falls evenly; of the power 1 the battery is exponential."""
    cycles = (1 - 1 / math.sqrt(CRACK)) / (0.5 * 0.008)
    assert _passage(_crack(Fixed()), CRACK) == pytest.approx(cycles, abs=0.5)
    assert _passage(_battery(Fixed()), BATTERY) == pytest.approx(-150 * math.log(1 - BATTERY / 0.42), abs=0.5)


def test_a_gear_loses_what_its_steps_and_loads_say():
    """Two steps an hour of 0.02 g, times the mean square of loads between 0.6 and 1.4."""
    rng = np.random.default_rng(1)
    lost = np.mean([_gear(rng)[-1] for _ in range(400)]) / (HOURS - 1)
    square = (1.4**3 - 0.6**3) / 3 / 0.8
    assert lost == pytest.approx(2 * 0.02 * math.exp(0.3**2 / 2) * square, rel=0.05)
    assert _passage(np.zeros(5), GEAR) == math.inf


def test_all_that_are_asked_work_then_and_a_seed_says_which():
    some, same = worn_robots(50, 3), worn_robots(50, 3)
    assert [one.fails for one in some] == [one.fails for one in same]
    for one in some:
        assert one.asked < one.fails <= min(one.ends.values())
        assert {name: len(values) for name, values in one.readings.items()} == dict.fromkeys(LIMITS, int(one.asked) + 1)
    assert 0.1 < np.mean([one.completed for one in some]) < 0.9


def test_parts_that_wore_out_are_read_until_their_limit():
    for part, limit in LIMITS.items():
        for wear in worn_out(part, 3, 1):
            assert wear[0] < 0.4 * limit
            assert wear[-1] == pytest.approx(limit, rel=0.35)  # behind it by an hour at most
            assert np.all(wear[:-5] < 1.1 * limit)
