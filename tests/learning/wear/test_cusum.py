"""CUSUM: run lengths as published, and false alarms and delays as promised, by simulation and on real bearings."""

from dataclasses import replace

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.cusum import Autoregression, design, false_alarm_rate, highest_sums


@pytest.mark.parametrize(
    ("h", "shift", "length"),
    [(4, 0.0, 168), (5, 0.0, 465), (4, 1.0, 8.38), (5, 1.0, 10.4), (4, 2.0, 3.34), (5, 2.0, 4.01)],
)
def test_published_run_lengths(h, shift, length):
    """Two sides, k = 1/2: Montgomery, Introduction to Statistical Quality Control, table 9.3."""
    z = np.random.default_rng(1).standard_normal((1, 1500, 100 if shift else 3000)) + shift
    assert 1 / false_alarm_rate(highest_sums(z, 0.5), h) == pytest.approx(length, rel=0.06)


def followed(rng, rho, n):
    """An autoregression of order 1."""
    noise = rng.standard_normal(n + 200)
    for i in range(1, len(noise)):
        noise[i] += rho * noise[i - 1]
    return noise[200:]


def achieved(rho, readings, count, wanted, seed):
    """How many times as often as promised each of so many baselines' detectors alarms, and which promise anything."""
    rng = np.random.default_rng(seed)
    found, promised = [], []
    for k in range(count):
        y = followed(rng, rho, readings + 3000)
        detector = design(y[:readings], wanted, seed=k)
        found.append(len(detector.alarms(y[readings:])[1]) / 3000 * wanted)
        promised.append(detector.promised)
    return np.array(found), np.array(promised)


@pytest.mark.full
@pytest.mark.parametrize(
    ("rho", "readings"),
    [
        pytest.param(0.0, 80, marks=pytest.mark.full),
        (0.5, 100),
        pytest.param(0.8, 300, marks=pytest.mark.full),
    ],
)
def test_false_alarms_come_as_promised_where_readings_follow_one_another(rho, readings):
    """On average over baselines within a factor of 2."""
    found, promised = achieved(rho, readings, 25, 300.0, 4)
    print(f"rho {rho}, baselines of {readings}: {found.mean():.2f} times as often as promised")
    assert 0.5 < found.mean() < 2
    assert promised.mean() > 0.5


def test_a_limit_for_independent_readings_would_not_do():
    rng = np.random.default_rng(4)
    y = followed(rng, 0.6, 5300)
    own = design(y[:300], 300.0)
    blind = replace(own, limit=design(rng.standard_normal(300), 300.0).limit)
    assert len(own.alarms(y[300:])[1]) < 2 * 5000 / 300
    assert len(blind.alarms(y[300:])[1]) > 5 * 5000 / 300


@pytest.mark.full
@pytest.mark.parametrize("readings", [100, 300])
@pytest.mark.parametrize("rho", [0.0, 0.3, 0.6, 0.8, 0.9])
def test_false_alarms_come_as_promised_in_full(rho, readings):
    found, promised = achieved(rho, readings, 200, 1000.0, 5)
    among = found[promised].mean() if promised.any() else float("nan")
    print(f"rho {rho}, baselines of {readings}: {found.mean():.2f} times as often as promised; {promised.mean():.0%} "
          f"promise it, and of those {among:.2f} times")  # fmt: skip
    assert 0.5 < found.mean() < 2


@pytest.mark.full
def test_a_baseline_of_few_independent_readings_promises_nothing():
    rng = np.random.default_rng(3)
    assert not any(design(followed(rng, 0.97, 100), 1000.0).promised for _ in range(4))
    assert not design(np.cumsum(rng.standard_normal(200)), 1000.0).promised
    assert not design(np.arange(100.0) ** 2 + rng.standard_normal(100), 1000.0).promised  # it trends already


def test_a_long_baseline_that_drifts_promises_nothing():
    """However many readings there are, of a line beneath them or of a walk, none is as the one before the start."""
    rng = np.random.default_rng(3)
    line = design(np.linspace(0, 1, 4_000) + rng.standard_normal(4_000), 100.0)
    assert line.drifts
    assert line.independent > 1000
    assert not line.promised
    assert not any(design(np.cumsum(rng.standard_normal(4_000)), 100.0).promised for _ in range(2))
    assert not design(followed(rng, 0.6, 300), 100.0).drifts


def test_an_autoregression_is_found_again():
    fitted = Autoregression.of(followed(np.random.default_rng(2), 0.7, 20_000))
    assert fitted.coefficients[0] == pytest.approx(0.7, abs=0.03)
    assert fitted.residuals.std() == pytest.approx(1.0, abs=0.03)
    long = design(followed(np.random.default_rng(2), 0.7, 20_000), 100.0)
    assert long.correlation_length == pytest.approx(1.7 / 0.3, rel=0.1)  # (1 + ρ)/(1 − ρ)


def test_a_shift_is_seen_as_soon_as_stated():
    rng = np.random.default_rng(6)
    detector = design(rng.standard_normal(5000), 500.0)
    for shift in (1.0, -1.0):
        first = [detector.alarms(rng.standard_normal(200) + shift)[1][0] + 1 for _ in range(800)]
        assert np.median(first) == pytest.approx(detector.delay, abs=1.5)


@pytest.mark.full
def test_longer_baselines_need_lower_limits():
    rng = np.random.default_rng(1)
    assert design(rng.standard_normal(30), 1000.0).limit > design(rng.standard_normal(3000), 1000.0).limit


@pytest.mark.full
@pytest.mark.parametrize("wanted", [10.0, 1e5])
def test_rare_and_frequent_alarms_have_their_limits(wanted):
    detector = design(np.random.default_rng(7).standard_normal(2000), wanted)
    z = np.random.default_rng(8).standard_normal(200_000)
    assert len(detector.alarms(z)[1]) / 200_000 == pytest.approx(1 / wanted, rel=0.5 if wanted < 1e3 else 2)


def test_a_shift_so_large_that_nothing_else_alarms():
    detector = design(np.random.default_rng(7).standard_normal(200), 10.0, shift=10.0)
    assert detector.alarms(np.random.default_rng(8).standard_normal(2000))[1] == []
    assert detector.delay == 1


@pytest.mark.full
def test_bearings_that_drift_while_they_are_sound(measured_wear):
    """IMS, test 2, until bearing 1 is damaged and shakes the others, after some 500 of 984 readings.

    Where far more alarms come than promised, the vibration is really no longer what it was in the baseline.
    """
    kept = 0
    for name, (_, values) in measured_wear("ims_test2_mean_abs_acceleration").items():
        for readings in (100, 200, 300):
            detector, later = design(values[:readings], 1000.0), values[readings:500]
            alarms = len(detector.alarms(later)[1])
            moved = (later.mean() - detector.mean) / detector.deviation
            print(f"{name}, baseline {readings}: {alarms} alarms in {len(later)} readings, whose mean moved by "
                  f"{moved:+.1f}; {'once in 1000 promised' if detector.promised else 'nothing promised'}")  # fmt: skip
            kept += alarms <= 1
            if detector.promised and alarms > 3:  # by chance once in a thousand such stretches
                assert abs(moved) > 3 * np.sqrt(1 / detector.independent + detector.correlation_length / len(later))
    assert kept >= 5


@pytest.mark.parametrize(
    ("baseline", "between", "shift", "said"),
    [
        (np.arange(10.0), 100, 1, "a baseline of 10 readings; expected at least 30"),
        (np.ones(50), 100, 1, "the baseline is 1 all the time"),
        (np.r_[np.arange(40.0), np.nan], 100, 1, "no numbers"),
        (np.arange(50.0), 1, 1, "expected at least 10"),
        (np.arange(50.0), 100, 50, "expected at least 10"),
        ((-1.0) ** np.arange(50), 100, 1, "goes by a rule and not by chance"),
    ],
)
def test_refusals(baseline, between, shift, said):
    with pytest.raises(DataError, match=said):
        design(baseline, between, shift)
