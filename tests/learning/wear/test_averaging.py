"""All degradation models together: honest on simulated wear of several laws, and plain about what cannot be said."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import first_passage, forecast

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


@pytest.mark.full
@pytest.mark.parametrize(
    ("bend", "noise"),
    [
        (1.0, 0.0),
        pytest.param(1.0, 0.1, marks=pytest.mark.full),
        pytest.param(2.0, 0.02, marks=pytest.mark.full),
        (0.7, 0.02),
    ],
)
def test_intervals_hold_on_simulated_wear_of_several_laws(bend, noise):
    """Of 40 at least 32: of intervals that hold 90 % fewer come in 2 % of all runs."""
    rng, held = np.random.default_rng(8), 0
    for k in range(40):
        t, y, threshold, left = simulated(rng, bend, noise)
        low, _, high = forecast(t, y, threshold, seed=k, draws=800).remaining
        held += low <= left <= high
    assert held >= 32


@pytest.mark.full
def test_intervals_of_means_over_stretches_hold_though_they_are_taken_for_moments():
    """Each reading is the mean of twenty moments of straight wear that wanders."""
    rng, held = np.random.default_rng(12), 0
    for k in range(120):
        level = np.cumsum(0.05 + rng.standard_normal(1600) / np.sqrt(20))
        times, values = (one.reshape(80, 20).mean(axis=1) for one in ((np.arange(1600) + 1) / 20, level))
        left = 80 - times[-1] + rng.wald(40.0, 40.0**2)
        low, _, high = forecast(times, values, level[-1] + 40.0, draws=400, seed=k).remaining
        held += low <= left <= high
    print(f"{held} of 120 held")
    assert held >= 102  # fewer of intervals that hold 90 % come in 3 % of all runs


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


def test_a_threshold_that_was_reached_stays_reached_where_readings_recover():
    """A battery that rests after it fell below its threshold: the first crossing that lasted, and since when not."""
    capacity = np.array([2.0, 1.9, 1.8, 1.7, 1.6, 1.5, 1.38, 1.36, 1.34, 1.45, 1.44, 1.43, 1.42])
    found = forecast(np.arange(13), capacity, 1.4, falls=True)
    assert found.reached == pytest.approx(5 + (1.5 - 1.4) / (1.5 - 1.38))
    assert (found.recovered, found.renewed, found.worn_out) == (9, None, True)
    assert found.remaining == (0, 0, 0)
    once = np.where(np.arange(13) == 6, 1.38, np.maximum(capacity, 1.42))  # a reading that was bad
    assert (forecast(np.arange(13), once, 1.4, falls=True).reached) is None


def test_after_maintenance_a_threshold_that_was_reached_is_told_and_life_begins_anew():
    wear = np.r_[np.arange(12), np.arange(8)] * 0.1 + 0.01 * np.random.default_rng(3).standard_normal(20)
    found = forecast(np.arange(20), 1 + wear, 1.95)
    assert found.reached == pytest.approx(9.5, abs=0.3)
    assert (found.recovered, found.renewed) == (12, 12)
    assert not found.worn_out
    assert found.remaining.median == pytest.approx(9.5 - 7, rel=0.3)


def test_a_last_reading_far_beyond_the_threshold_has_reached_it():
    found = forecast(np.arange(12), CRACK, 1.6)
    assert found.reached == pytest.approx(10 + (1.6 - 1.55) / (1.71 - 1.55))
    assert found.worn_out


def test_real_batteries_that_rested_had_reached_their_threshold(measured_wear):
    """NASA's B0005: first below 1.4 Ah after cycle 124; above again at rest, as others of the set."""
    for name, (t, y) in measured_wear("nasa_battery_capacity").items():
        threshold = {"B0005": 1.4, "B0007": 1.43}[name]
        crossing = int(np.argmax(y <= threshold))
        assert y[crossing + 1] <= threshold  # it lasted
        for end in range(crossing + 3, len(t)):
            found = forecast(t[:end], y[:end], threshold, falls=True, draws=50)
            assert t[crossing - 1] < found.reached <= t[crossing]
            assert found.worn_out
            short = np.sum(y[end - 3 : end] > threshold) >= 2
            assert (found.recovered is not None) == short


def test_an_uncertain_threshold_widens_what_is_said():
    sharp, blurred = (forecast(np.arange(8), CRACK[:8], 1.6, deviation=one).remaining for one in (0.0, 0.2))
    assert blurred.high - blurred.low > 1.1 * (sharp.high - sharp.low)
    known_by_nobody = forecast(np.arange(8), CRACK[:8], 1.6, deviation=50.0)
    assert known_by_nobody.remaining.low > 0  # it still works
    assert not known_by_nobody.worn_out


def test_a_knee_that_no_model_foretold_is_said():
    rng = np.random.default_rng(5)
    flat = 1 + 0.01 * np.arange(80) + 0.002 * rng.standard_normal(80)
    assert forecast(np.arange(80), flat, 9.0).followed
    knee = flat + 1.0 * np.maximum(np.arange(80) - 76, 0)
    assert not forecast(np.arange(80), knee, 9.0).followed


@pytest.mark.parametrize("at", [250, 280, 292])
def test_a_knee_is_not_explained_away_by_the_models_that_it_makes_likely(at):
    """What weighs them is what they had foretold before it."""
    hours = np.arange(300.0)
    wear = 0.005 * hours + 0.01 * np.random.default_rng(4).standard_normal(300)
    assert not forecast(hours, 1 + wear + 0.1 * np.maximum(hours - at, 0), 20.0, draws=50).followed
    assert forecast(hours, 1 + wear, 20.0, draws=50).followed


def test_one_bad_reading_is_no_knee():
    wear = 1 + 0.05 * np.arange(60) + 0.01 * np.random.default_rng(4).standard_normal(60)
    wear[-1] += 2
    assert forecast(np.arange(60), wear, 20.0, draws=50).followed
    assert not forecast(np.arange(61), np.r_[wear, wear[-1] + 0.05], 20.0, draws=50).followed


@pytest.mark.full
@pytest.mark.parametrize(
    ("bend", "noise"),
    [
        pytest.param(1.0, 0.1, marks=pytest.mark.full),
        (2.0, 0.02),
        pytest.param(1.0, 0.0, marks=pytest.mark.full),
        pytest.param(0.7, 0.02, marks=pytest.mark.full),
    ],
)
def test_wear_that_keeps_its_law_is_followed(bend, noise):
    rng = np.random.default_rng(1)
    found = [forecast(*simulated(rng, bend, noise)[:3], draws=20).followed for _ in range(60)]
    print(f"t^{bend}, noise {noise}: {1 - np.mean(found):.1%} not followed")
    assert np.mean(found) > 0.9


def test_wear_that_leads_away_has_no_life_that_can_be_said():
    rng = np.random.default_rng(2)
    found = forecast(np.arange(60), 5 - 0.02 * np.arange(60) + 0.02 * rng.standard_normal(60), 9.0)
    assert not found.said


def test_before_a_trend_shows_nothing_is_foretold_but_what_its_age_says():
    """Of a thing seen at no special time of its life 5 % go on for less than a nineteenth of its age (Gott 1993)."""
    quiet = 0.3 + 0.02 * np.random.default_rng(1).standard_normal(200)
    found = forecast(np.arange(1.0, 201.0), quiet, 1.2)
    assert (found.shows, found.said) == (False, False)
    assert found.remaining.low == pytest.approx(200 / 19, rel=0.01)
    assert np.isinf(found.remaining.median)
    damaged = quiet + 0.01 * np.maximum(np.arange(200) - 160.0, 0)
    assert forecast(np.arange(1.0, 201.0), damaged, 1.2).shows


def test_the_cumulative_hazard_is_of_what_is_drawn():
    found = forecast(np.arange(8), CRACK[:8], 1.6)
    for level, time in zip((0.05, 0.5, 0.95), found.remaining, strict=True):
        assert 1 - np.exp(-found.cumulative_hazard(np.array(time))) == pytest.approx(level, abs=0.002)
    assert found.cumulative_hazard(np.array(0.0)) == 0
    assert np.all(np.diff(found.cumulative_hazard(np.linspace(0, 100, 300))) >= 0)


@pytest.mark.parametrize(
    ("t", "y", "threshold", "said"),
    [
        ([1], [1], 2, "1 reading: when a threshold is reached cannot be said; expected at least 4"),
        ([1, 2, 2, 3], [1, 2, 3, 4], 9, "times do not ascend"),
        ([0, 1e-300, 2e-300, 3e-300], [1, 2, 3, 4], 9, "the nearest 1e-300 apart: no part's clock says that"),
        ([0, 1e300, 2e300, 3e300], [1, 2, 3, 4], 9, r"readings until 3e\+300, .*: no part's clock says that"),
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
