"""What a unit's own models say, as far as such forecasts held of others: quadrature, and simulated knees."""

import numpy as np
import pytest
from scipy import stats

from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.own_forecast import OwnForecast, next_off


@pytest.mark.parametrize("off", [(-2.0,), (-1.5, -2.5, -1.0), (3.0, -1.0)])
def test_how_far_off_it_is_next_by_quadrature(off):
    """P(next | off), over a variance worth three units of 1/2 and a mean worth one unit of 0."""
    means, logs = np.linspace(-12, 12, 1201)[:, None], np.linspace(-6, 6, 601)[None, :]
    deviation = np.exp(logs / 2)
    weight = stats.invgamma(1.5, scale=0.75).pdf(np.exp(logs)) * np.exp(logs) * stats.norm(0, deviation).pdf(means)
    for one in off:
        weight = weight * stats.norm(means, deviation).pdf(one)
    weight /= weight.sum()
    centre, scale = next_off(off)
    for at in (-4.0, -1.0, 0.0, 2.0):
        seen = float(np.sum(weight * stats.norm(means, deviation).pdf(at)))
        assert stats.t(3 + len(off), centre, scale).pdf(at) == pytest.approx(seen, rel=1e-3)


def test_nobody_asked_says_nothing():
    assert next_off([]) == (0.0, 1.0)
    own = OwnForecast(np.exp(np.random.default_rng(1).normal(3, 0.5, 500)))
    assert own.as_others_fared([]) is own


def test_draws_are_moved_and_those_that_never_end_stay():
    passage = np.r_[np.exp(np.random.default_rng(1).normal(3, 0.5, 3600)), np.full(400, np.inf)]
    own = OwnForecast(passage)
    assert own.off_by(np.exp(3 + 2 * 0.5 / 1.22)) == pytest.approx(2, abs=0.15)  # 1.645/2.015 of Student's deviations
    moved = own.as_others_fared([-2.0, -2.0, -2.0])
    assert moved.share == own.share
    fitted, before = moved.fitted, own.fitted
    mean, scale = next_off([-2.0, -2.0, -2.0])
    assert fitted.centre == pytest.approx(before.centre + before.deviation * mean, abs=0.01)
    assert fitted.deviation == pytest.approx(before.deviation * scale, rel=0.01)
    few = OwnForecast(np.full(30, np.inf))
    assert few.as_others_fared([-2.0]) is few
    assert few.off_by(1.0) is None


def knee(rng):
    """Slow wear that bends down at 300, ten times as steep, until just after the threshold at 1."""
    t = np.arange(0.0, 700.0, 10.0)
    bends = 300 * np.exp(0.1 * rng.standard_normal())
    y = 0.001 * t + 0.012 * np.maximum(t - bends, 0) + 0.003 * rng.standard_normal(len(t))
    return Unit(t[: (k := int(np.argmax(y > 1))) + 2], y[: k + 2]), float(t[k])


def test_a_knee_that_others_had_is_in_what_its_own_past_says():
    """At two thirds of its life its own past says thrice too long and more; by one other it is nearer, and sooner."""
    rng = np.random.default_rng(3)
    (unit, end), (other, _) = knee(rng), knee(rng)
    seen = unit.times < 0.66 * end
    t, y = unit.times[seen], unit.values[seen]
    left = end - t[-1]
    alone = forecast(t, y, 1.0)
    among = forecast_among([other], t, y, 1.0)
    assert alone.remaining.median > 2 * left
    own = OwnForecast(alone.passage)
    off = OwnForecast(forecast(other.times[: len(t)], other.values[: len(t)], 1.0).passage).off_by(left)
    assert left < np.median(own.as_others_fared([off]).ends) < alone.remaining.median
    assert among.remaining.low < left < among.remaining.high < alone.remaining.high
