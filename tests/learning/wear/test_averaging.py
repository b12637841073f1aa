"""All degradation models together: honest on simulated wear of several laws, and plain about what cannot be said."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import first_passage, forecast, recoveries

CRACK = np.array([0.90, 0.94, 0.98, 1.03, 1.07, 1.12, 1.19, 1.24, 1.34, 1.43, 1.55, 1.71])
"""A specimen of Alloy-A (Meeker and Escobar 1998, table C.14) [inch], a reading each 0.01 million cycles."""


def simulated(rng, bend, noise, goal=4.0, drift=0.05, spread=0.05):
    """Readings of the first 60 % of a life along tᵇᵉⁿᵈ, and what is left of it."""
    while True:
        tau = np.cumsum(np.ones(4000)) ** bend
        tau = tau / tau[79] * 80
        steps = np.diff(tau, prepend=0.0)
        path = np.cumsum(drift * steps + spread * np.sqrt(steps) * rng.standard_normal(4000))
        end = int(np.argmax(path >= goal)) + 1
        n = int(0.6 * end)
        if n >= 20 and path[:n].max() < goal:
            return np.arange(1.0, n + 1), path[:n] + 1 + noise * rng.standard_normal(n), goal + 1, end - n


@pytest.mark.parametrize(("bend", "noise"), [(1.0, 0.0), (1.0, 0.1), (2.0, 0.02), (0.7, 0.02)])
def test_intervals_hold_on_simulated_wear_of_several_laws(bend, noise):
    """Of 40 at least 32: of intervals that hold 90 % fewer come in 2 % of all runs."""
    rng, held = np.random.default_rng(8), 0
    for k in range(40):
        t, y, threshold, left = simulated(rng, bend, noise)
        low, _, high = forecast(t, y, threshold, seed=k, draws=800).remaining
        held += low <= left <= high
    assert held >= 32


def test_a_crack_that_a_line_takes_for_three_times_as_long():
    found = forecast(np.arange(8) * 0.01, CRACK[:8], 1.6)
    left = 0.1 + 0.01 * (1.6 - 1.55) / (1.71 - 1.55) - 0.07
    assert found.remaining.low < left < found.remaining.high
    assert found.remaining.median == pytest.approx(left, rel=0.35)
    assert found.weights["wiener"] < 0.1
    assert found.said
    assert found.followed


def test_a_falling_signal_is_the_same_turned_round():
    up, down = forecast(np.arange(8), CRACK[:8], 1.6), forecast(np.arange(8), -CRACK[:8], -1.6, falls=True)
    assert up.remaining == down.remaining
    assert up.trend.median == -down.trend.median


def test_a_first_passage_is_said_with_its_date():
    found = forecast(np.arange(12), CRACK, 1.5)
    assert found.reached == pytest.approx(9 + (1.5 - 1.43) / (1.55 - 1.43))
    assert found.remaining == (0, 0, 0)
    assert first_passage(np.arange(5.0), np.array([0.0, 9.0, 1.0, 2.0, 3.0]), 5.0) is None  # one reading is noise


def test_an_uncertain_threshold_widens_what_is_said():
    sharp, blurred = (forecast(np.arange(8), CRACK[:8], 1.6, deviation=one).remaining for one in (0.0, 0.2))
    assert blurred.high - blurred.low > 1.1 * (sharp.high - sharp.low)


def test_maintenance_begins_wear_anew_and_rests_do_not():
    rng = np.random.default_rng(3)
    wear = np.r_[np.arange(40), np.arange(30)] * 0.1 + 0.01 * rng.standard_normal(70)
    when, renewed = recoveries(np.arange(70.0), wear)
    assert (when.tolist(), renewed) == ([40.0], 40.0)
    assert forecast(np.arange(70), 1 + wear, 9.0).remaining.median == pytest.approx(51, rel=0.15)
    rested = np.arange(60) * 0.1 - 0.8 * (np.arange(60) >= 30) + 0.01 * rng.standard_normal(60)
    when, renewed = recoveries(np.arange(60.0), rested)
    assert (when.tolist(), renewed) == ([30.0], -np.inf)
    assert forecast(np.arange(60), 1 + rested, 9.0).events == (30.0,)


def test_a_knee_that_no_model_foretold_is_said():
    rng = np.random.default_rng(5)
    flat = 1 + 0.01 * np.arange(80) + 0.002 * rng.standard_normal(80)
    assert forecast(np.arange(80), flat, 9.0).followed
    knee = flat + 1.0 * np.maximum(np.arange(80) - 76, 0)
    assert not forecast(np.arange(80), knee, 9.0).followed


def test_wear_that_leads_away_has_no_life_that_can_be_said():
    rng = np.random.default_rng(2)
    found = forecast(np.arange(60), 5 - 0.02 * np.arange(60) + 0.02 * rng.standard_normal(60), 9.0)
    assert not found.said


def test_the_cumulative_hazard_is_of_what_is_drawn():
    found = forecast(np.arange(8), CRACK[:8], 1.6)
    for level, time in zip((0.05, 0.5, 0.95), found.remaining, strict=True):
        assert 1 - np.exp(-found.cumulative_hazard(np.array(time))) == pytest.approx(level, abs=0.002)
    assert found.cumulative_hazard(np.array(0.0)) == 0
    assert np.all(np.diff(found.cumulative_hazard(np.linspace(0, 100, 300))) >= 0)


@pytest.mark.parametrize(
    ("t", "y", "threshold", "said"),
    [
        ([1], [1], 2, "1 readings: when they reach a threshold cannot be said; expected at least 4"),
        ([1, 2, 2, 3], [1, 2, 3, 4], 9, "times do not ascend"),
        ([1, 3, 2, 4], [1, 2, 3, 4], 9, "times do not ascend"),
        ([1, 2, 3, 4], [1, 2, np.nan, 4], 9, "no number"),
        ([1, 2, 3, 4], [1, 2, 3, 4], np.inf, "no number"),
        ([1, 2, 3, 4], [1, 2, 3], 9, "expected as many"),
        ([1, 2, 3, 4], [3, 3, 3, 3], 9, "the signal is 3 all the time"),
        ([1, 2, 3, 4], [9, 2, 3, 4], 9, "at or past the threshold already"),
        ([-1, 2, 3, 4], [1, 2, 3, 4], 9, "at least 0"),
    ],
)
def test_refusals(t, y, threshold, said):
    with pytest.raises(DataError, match=said):
        forecast(t, y, threshold)
