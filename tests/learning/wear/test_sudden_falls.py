"""Sudden falls of wear: rests and maintenance are told from wear that leads away, and from a machine that shakes."""

import numpy as np
import pytest

from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.sudden_falls import recoveries


def test_maintenance_begins_wear_anew_and_rests_do_not():
    rng = np.random.default_rng(3)
    wear = np.r_[np.arange(40), np.arange(30)] * 0.1 + 0.01 * rng.standard_normal(70)
    when, renewed = recoveries(np.arange(70.0), wear, 8.0)
    assert (when.tolist(), renewed) == ([40.0], 40.0)
    assert forecast(np.arange(70), 1 + wear, 9.0).remaining.median == pytest.approx(51, rel=0.15)
    rested = np.arange(60) * 0.1 - 0.8 * (np.arange(60) >= 30) + 0.01 * rng.standard_normal(60)
    when, renewed = recoveries(np.arange(60.0), rested, 8.0)
    assert (when.tolist(), renewed) == ([30.0], -np.inf)
    assert forecast(np.arange(60), 1 + rested, 9.0).events == (30.0,)


def test_a_burst_of_bad_readings_is_no_maintenance():
    rng = np.random.default_rng(2)
    wear = 0.01 * np.arange(60) + 0.005 * rng.standard_normal(60)
    wear[30:32] += 1.5
    assert recoveries(np.arange(60.0), wear, 2.0)[1] == -np.inf


def test_wear_that_leads_away_falls_steadily_and_not_at_once():
    t = np.arange(20.0)
    assert recoveries(t, 5 - 0.1 * t + 0.01 * (t % 3), 10.0) == (pytest.approx([]), -np.inf)
    assert len(recoveries(t, 0.6 - 0.00012 * t, 0.7)[0]) == 0  # steps that differ by rounding alone
    assert len(recoveries(t, 0.6 - 0.00012 * t - 1e-7 * (t >= 12), 0.7)[0]) == 0
    fell = 5 - 0.1 * t + 0.01 * (t % 3) - 1.0 * (t >= 12)
    assert recoveries(t, fell, 10.0)[0].tolist() == [12.0]


def test_a_signal_of_few_digits_does_not_fall_by_its_last_one():
    rng = np.random.default_rng(1)
    wear = np.round(0.02 * np.arange(200) + 0.03 * rng.standard_normal(200), 1)
    assert len(recoveries(np.arange(200.0), wear, 10.0)[0]) == 0


def test_a_machine_that_shakes_ever_more_is_not_served_by_that():
    """Vibration of a bearing: its noise goes with its level, so that late steps are large beside those of its youth."""
    hours = np.arange(600.0)
    level = 0.5 + 1e-6 * np.maximum(hours - 300, 0) ** 2.4

    def shaken(times):
        return level * (1 + 0.01 * (1 + times * (hours > 300)) * np.random.default_rng(2).standard_normal(600))

    found = [recoveries(hours[:n], shaken(8)[:n], 2.0) for n in range(320, 600, 10)]
    assert {renewed for _, renewed in found} == {-np.inf}
    assert len(found[-1][0]) <= 6
    assert recoveries(hours, np.where(hours < 560, shaken(3), 0.5), 2.0)[1] == 560.0
