"""CUSUM: run lengths as published, and false alarms and delays as designed, by simulation."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.cusum import design, run_length


@pytest.mark.parametrize(
    ("h", "shift", "length"),
    [(4, 0.0, 336), (5, 0.0, 930), (4, 1.0, 8.38), (5, 1.0, 10.4), (4, 2.0, 3.34), (5, 2.0, 4.01)],
)
def test_published_run_lengths(h, shift, length):
    """One side, k = 1/2: Montgomery, Introduction to Statistical Quality Control, table 9.3, whose two sides have half
    of the length without shift (168 and 465)."""
    assert run_length(h, 0.5, shift) == pytest.approx(length, rel=4e-3)


def lengths(baselines, shift, between, length, seed):
    """Readings to the first alarm, or to the end, each against a baseline of its own; and whether it came."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(baselines):
        detector = design(rng.standard_normal(80), between)
        _, alarms = detector.alarms(rng.standard_normal(length) + shift)
        found.append(alarms)
    return found


def test_false_alarms_come_as_designed():
    """On average over what baselines of 80 readings are off by: alarms per reading."""
    found = lengths(150, 0.0, 200.0, 1500, 4)
    rates = np.array([len(one) / 1500 for one in found])
    assert rates.mean() == pytest.approx(1 / 200, abs=3 * rates.std() / np.sqrt(150))
    assert 3 * rates.std() / np.sqrt(150) < 0.4 / 200


def test_a_shift_is_seen_as_soon_as_designed():
    rng = np.random.default_rng(6)
    detector = design(rng.standard_normal(20_000), 500.0)
    first = [detector.alarms(rng.standard_normal(200) + 1.0)[1][0] + 1 for _ in range(800)]
    assert np.mean(first) == pytest.approx(detector.delay, rel=0.06)
    down = [detector.alarms(rng.standard_normal(200) - 1.0)[1][0] + 1 for _ in range(400)]
    assert np.mean(down) == pytest.approx(detector.delay, rel=0.1)


def test_longer_baselines_need_lower_limits():
    rng = np.random.default_rng(1)
    short, long = design(rng.standard_normal(30), 1000.0), design(rng.standard_normal(3000), 1000.0)
    assert short.limit > long.limit
    walk = design(np.cumsum(rng.standard_normal(200)), 1000.0)
    assert walk.correlation > 0.8


@pytest.mark.parametrize(
    ("baseline", "between", "shift", "said"),
    [
        (np.arange(10.0), 100, 1, "a baseline of 10 readings; expected at least 30"),
        (np.ones(50), 100, 1, "the baseline is 1 all the time"),
        (np.r_[np.arange(40.0), np.nan], 100, 1, "no numbers"),
        (np.arange(50.0), 1, 1, "expected at least 10"),
        (np.arange(50.0), 100, 50, "expected at least 10"),
    ],
)
def test_refusals(baseline, between, shift, said):
    with pytest.raises(DataError, match=said):
        design(baseline, between, shift)
