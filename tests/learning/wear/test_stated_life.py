"""A stated life as a prior of when wear ends: products of densities in closed form, and readings that contradict it."""

import numpy as np
import pytest
from scipy.stats import norm

from robophm.learning.wear import stated_life
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import Forecast, forecast
from robophm.learning.wear.stated_life import StatedLife
from robophm.learning.wear.trend_bend import Bend
from robophm.life.exponential import Exponential
from robophm.life.lognormal import Lognormal
from robophm.life.weibull import Weibull

LEVELS = (np.arange(20000) + 0.5) / 20000


def foretold(logs, never=0):
    """A forecast whose logarithms of the remaining time are these, and some that never end."""
    passage = np.r_[np.exp(logs), np.full(never, np.inf)]
    return Forecast(1.0, passage, np.ones(len(passage)), 0.0, Bend(1.0, False), {}, 1.0)


def test_of_a_new_part_both_are_one_product_of_normal_densities(monkeypatch):
    """N(4, 0.6²) by the readings and N(5, 0.3²) as stated: the mean is weighed by precisions, which add up.

    The flat prior of the pace, 1/R² at age 0, is taken off: of ln R a factor R, which adds the variance to the mean.
    """
    monkeypatch.setattr(stated_life, "_FACTORS", np.ones(1))
    monkeypatch.setattr(stated_life, "_SHARES", np.ones(1))
    found = StatedLife(Lognormal(log_mean=5.0, log_deviation=0.3), 0.0).given(foretold(norm.ppf(LEVELS, 4, 0.6)), 0.0)
    precision = 1 / 0.6**2 + 1 / 0.3**2
    mean = (4 / 0.6**2 + 5 / 0.3**2) / precision + 1 / precision
    expected = np.exp(norm.ppf([0.05, 0.5, 0.95], mean, precision**-0.5))
    assert found.remaining == pytest.approx(tuple(expected), rel=0.01)


def test_an_aged_part_is_given_its_age_and_its_pace(monkeypatch):
    """Weights are t·(now + t)·f(age), as summed by hand over a grid."""
    monkeypatch.setattr(stated_life, "_FACTORS", np.ones(1))
    monkeypatch.setattr(stated_life, "_SHARES", np.ones(1))
    life = Weibull(scale=100.0, shape=3.0)
    found = StatedLife(life, 20.0, 2.0).given(foretold(norm.ppf(LEVELS, 3, 0.8), never=500), 15.0)
    t = np.exp(np.linspace(-2, 7, 200001))
    age = 20 + 2 * (15 + t)
    posterior = norm.pdf(np.log(t), 3, 0.8) * t * (15 + t) * (3 / 100) * (age / 100) ** 2 * np.exp(-((age / 100) ** 3))
    median = t[np.searchsorted(np.cumsum(posterior) / posterior.sum(), 0.5)]
    ends = found.passage[np.isfinite(found.passage)]
    assert np.median(ends) == pytest.approx(median, rel=0.01)
    assert found.never == pytest.approx(500 / 20500)


def test_what_readings_contradict_gives_way():
    """Far away the stated density over ln R falls as a power of ln R: weights rise less than R³, and move what is known
    to 20 % by less than 3·0.2². Altogether outside of the stated lives it does not count at all."""
    seen = foretold(norm.ppf(LEVELS, np.log(100), 0.2))
    found = StatedLife(Weibull(scale=1000.0, shape=3.0), 0.0).given(seen, 10.0)
    assert 1 <= found.remaining.median / seen.remaining.median < np.exp(3 * 0.2**2)
    assert StatedLife(Weibull(scale=5000.0, shape=3.0), 0.0).given(seen, 10.0) is seen


def test_a_constant_rate_says_nothing_of_when_wear_ends():
    seen = foretold(norm.ppf(LEVELS, 4, 0.6))
    assert StatedLife(Exponential(rate=1e-3), 0.0).given(seen, 10.0) is seen


@pytest.mark.full
def test_it_counts_alone_and_not_beside_others_that_wore_out():
    t = np.arange(1.0, 31.0)
    stated = StatedLife(Weibull(scale=60.0, shape=6.0), 0.0)
    y = 1 + 0.03 * t + 0.02 * np.random.default_rng(2).standard_normal(30)
    alone, by_life = (
        forecast(t, y, 3.0, law_ends=False).remaining,
        forecast_among([], t, y, 3.0, stated=stated).remaining,
    )
    assert by_life.high - by_life.low < alone.high - alone.low
    others = [Unit(np.arange(1.0, end), 1 + 2.05 * np.arange(1.0, end) / end) for end in (150.0, 180.0, 220.0)]
    among = [forecast_among(others, t, y, 3.0, stated=one).remaining for one in (None, stated)]
    assert among[0] == among[1]
