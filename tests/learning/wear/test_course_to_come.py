"""The course of wear to come beside courses that are simulated on, and beside a straight line."""

from types import SimpleNamespace

import numpy as np
import pytest

from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.course_to_come import course_to_come


def seen(times, values, threshold, *, falls=False):
    """As much of a worn mode as is asked for."""
    wear = forecast(times, values, threshold, falls=falls)
    return SimpleNamespace(readings=SimpleNamespace(times=times), values=values, wear=wear)


@pytest.mark.full
@pytest.mark.parametrize("falls", [False, True])
def test_a_straight_course_lies_within_its_band_up_to_the_threshold(falls):
    sign = -1.0 if falls else 1.0
    times = np.arange(40.0)
    line = sign * (5 + 0.05 * times)
    found = course_to_come(seen(times, line + 0.02 * np.sin(7 * times), sign * 9, falls=falls))
    truth = sign * (5 + 0.05 * found.times)
    known = (sign * found.fast < 9) & (found.times > 45)
    assert known.sum() >= 10
    assert np.all(sign * found.slow[known] < sign * truth[known])
    assert np.all(sign * truth[known] < sign * found.fast[known])
    middle = (sign * found.median < 9) & (found.times > 45)
    assert np.interp(8.0, sign * found.median[middle], found.times[middle]) == pytest.approx(60, rel=0.1)
    for band in (found.slow, found.median, found.fast):
        assert np.all(np.diff(sign * band) >= 0)
        assert sign * band[-1] == 9
    assert found.times[0] == times[-1]


@pytest.mark.full
def test_ninety_percent_of_simulated_wear_passes_within_the_band():
    """Of 40 Wiener processes with drift, by what later came: 8 or more outside have a chance of 4 % at 90 %."""
    random, outside, told = np.random.default_rng(5), 0, 0
    for _ in range(40):
        steps = random.normal(0.05, 0.1, 400)
        wear = 1 + np.cumsum(steps)
        found = course_to_come(seen(np.arange(60.0), wear[:60], 7.0)) if wear[:60].max() < 6.5 else None
        if found is None:
            continue
        at = int(found.times[0]) + 20
        highest = max(wear[: at + 1].max(), wear[0])
        slow, fast = (np.interp(at, found.times, band) for band in (found.slow, found.fast))
        told += 1
        outside += not slow <= min(highest, 7) <= fast
    assert told >= 25
    assert outside <= 7


def test_where_no_trend_shows_there_is_no_course():
    times = np.arange(40.0)
    assert course_to_come(seen(times, 5 + 0.5 * np.sin(3 * times), 9)) is None
    assert course_to_come(seen(times, 5 + 0.2 * times, 9)) is None  # reached
