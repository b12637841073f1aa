"""Units foretold along the courses of others: closed forms, a likelihood by SciPy, and simulated kinds."""

import numpy as np
import pytest
from scipy.stats import multivariate_t

from robophm.learning.wear import shape_invariant
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.log_regression import COUNTS
from robophm.learning.wear.shape_invariant import NOISE, RESOLVED, STRAY, DegradationCurve, along


def knee(age):
    """A cell's fade: straight to 0.4 at 600, then six times as fast, 1 at 850."""
    return np.where(age < 600, age / 1500, 0.4 + (age - 600) * 0.0024)


def quantiles(draws):
    return np.quantile(draws, [0.05, 0.5, 0.95])


AGES = np.arange(0.0, 1200.0, 10.0)
TEACHER = DegradationCurve(AGES, knee(AGES), 850.0)


@pytest.mark.parametrize(("pace", "size"), [(1.0, 1.0), (1.25, 1.0), (0.8, 1.0), (1.0, 1.2), (1.0, 0.85)])
def test_a_knee_is_taken_over_at_a_pace_and_a_size(pace, size):
    """Until 0.9 of the way to its knee a unit tells pace over size alone; the truth is where c·f(t/a) is 1."""
    now = 540.0 * pace
    t = np.arange(0.0, now, 10.0)
    truth = pace * (600 + (1 / size - 0.4) / 0.0024) - t[-1]
    low, median, high = quantiles(along([TEACHER], t, size * knee(t / pace), 2000))
    assert low < truth < high
    assert abs(median / truth - 1) < 0.35
    assert forecast(t, size * knee(t / pace) + 1e-4 * np.sin(t), 1.0).remaining.median > 1.5 * truth


@pytest.mark.parametrize(("pace", "size"), [(1.25, 1.0), (1.0, 1.3)])
def test_behind_the_knee_pace_and_size_are_told(pace, size):
    t = np.arange(0.0, 700.0 * pace, 10.0)
    truth = pace * (600 + (1 / size - 0.4) / 0.0024) - t[-1]
    assert np.median(along([TEACHER], t, size * knee(t / pace), 2000)) == pytest.approx(truth, rel=0.15)


def test_the_likelihood_is_that_of_all_readings_at_once():
    """Straying in level alone makes readings multivariate Student's t about the course."""
    rng = np.random.default_rng(1)
    t = np.sort(rng.uniform(0, 500, 12))
    y = knee(t) + 0.05 * rng.standard_normal(12)
    lasts = 0.3 * TEACHER.life
    curves = shape_invariant._Curves([TEACHER])
    one = np.ones(1)
    some = shape_invariant._Candidates(
        np.zeros(1, dtype=int), 0.1 * one, -0.05 * one, one, 0 * one, lasts * one, NOISE[1] * one
    )
    found = shape_invariant._filtered(curves, some, t, y).log[0]
    shape = np.exp(-np.abs(t[:, None] - t) / lasts) + (NOISE[1] ** 2 + RESOLVED**2) * np.eye(12)
    mean = np.exp(-0.05) * np.interp(t / np.exp(0.1), AGES, knee(AGES))
    expected = multivariate_t(mean, STRAY**2 * shape, COUNTS).logpdf(y)
    prior = sum(float(shape_invariant._alike(np.array([x]))[0]) for x in (0.1, -0.05))
    assert found == pytest.approx(expected + prior, abs=0.05)


@pytest.mark.full
def test_intervals_hold_of_a_kind_that_goes_so():
    """Paces and sizes that scatter by 0.15, straying of 0.02: of 30 intervals 23 or more hold (fewer: 1 % of runs)."""
    rng, held = np.random.default_rng(4), 0
    for _ in range(30):
        ages = np.arange(0.0, 2500.0, 20.0)
        courses = []
        for _ in range(3):
            pace, size = np.exp(0.15 * rng.standard_normal(2))
            stray = 0.02 * _wanders(rng, len(ages), 20 / 250)
            courses.append((ages, size * knee(ages / pace) + stray))
        (_, mine), *others = courses
        end, *lives = (float(np.interp(1.0, np.maximum.accumulate(level), ages)) for _, level in courses)
        seen = ages <= 0.6 * end
        teachers = [DegradationCurve(a, level, life) for (a, level), life in zip(others, lives, strict=True)]
        low, _, high = quantiles(along(teachers, ages[seen], mine[seen], 500))
        held += low <= end - ages[seen][-1] <= high
    assert held >= 23


def _wanders(rng, count, step):
    """Ornstein and Uhlenbeck's process of variance 1."""
    kept, found = np.exp(-step), [rng.standard_normal()]
    for _ in range(count - 1):
        found.append(kept * found[-1] + np.sqrt(1 - kept**2) * rng.standard_normal())
    return np.array(found)


def test_what_comes_after_the_end_and_single_bad_readings_change_little():
    ages = np.arange(0.0, 1000.0, 4.0)
    t = np.arange(0.0, 500.0, 4.0)
    whole = DegradationCurve(ages, knee(ages), 850.0)
    stopped = DegradationCurve(ages, np.where(ages < 900, knee(ages), -0.2), 850.0)
    bad = knee(t).copy()
    bad[[30, 90]] = 0.9
    clean, stood, spiked = (
        quantiles(along([one], t, y, 2000)) for one, y in ((whole, knee(t)), (stopped, knee(t)), (whole, bad))
    )
    truth = 850 - t[-1]
    assert clean[0] < truth < clean[2]
    assert stood == pytest.approx(clean, rel=0.1)
    assert spiked == pytest.approx(clean, rel=0.2)
