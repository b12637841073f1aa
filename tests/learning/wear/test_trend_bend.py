"""Whether a trend bends: told of straight wear as seldom as stated, and of bent wear, with its direction."""

import numpy as np
import pytest
from scipy.stats import binomtest, linregress

from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.trend_bend import FALSE_ALARMS, bend_of_wiener


def told(draw, count, seed):
    """Directions that are told of so many signals."""
    rng = np.random.default_rng(seed)
    found = [bend_of_wiener(*draw(rng)).direction for _ in range(count)]
    return [one for one in found if one]


def straight(rng, noise, n=60):
    t = np.cumsum(rng.uniform(0.5, 1.5, n))
    steps = np.diff(t, prepend=0.0)
    path = np.cumsum(0.02 * steps + 0.03 * np.sqrt(steps) * rng.standard_normal(n))
    return t, path + noise * rng.standard_normal(n)


@pytest.mark.full
@pytest.mark.parametrize("noise", [0.0, 0.03, 0.1, 0.3])
def test_straight_wear_is_seldom_taken_for_bent(noise):
    """No more than as stated: of 200 a true share of 5 % gives more than 19 in less than 1 %."""
    false = told(lambda rng: straight(rng, noise), 200, 3)
    assert binomtest(len(false), 200, FALSE_ALARMS, "greater").pvalue > 0.01


@pytest.mark.parametrize("scale", [1e-300, 1e-50, 1e60])
def test_the_unit_of_a_signal_bends_nothing(scale):
    t, y = straight(np.random.default_rng(1), 0.1)
    assert bend_of_wiener(t, scale * y) == pytest.approx(bend_of_wiener(t, y))


@pytest.mark.full
@pytest.mark.parametrize("n", [12, 60, 300])
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_straight_wear_is_seldom_taken_for_bent_in_full(noise, n):
    false = told(lambda rng: straight(rng, noise, n), 600, n)
    print(f"{n} readings, noise {noise:g}: {len(false) / 600:.1%} of straight ones taken for bent")
    assert binomtest(len(false), 600, FALSE_ALARMS, "greater").pvalue > 0.001


def test_without_noise_it_is_a_regression_of_increments():
    """Of increments per time on time, by SciPy; noise that is next to none beside the wandering."""
    rng = np.random.default_rng(8)
    y = np.cumsum(0.5 + 0.01 * np.arange(80) + rng.standard_normal(80))
    t = np.arange(80.0)
    alone = linregress((t[1:] + t[:-1]) / 2, np.diff(y))
    found = bend_of_wiener(t, y)
    assert found.p_value == pytest.approx(alone.pvalue, abs=0.15)
    assert found.rises == (alone.slope > 0)


@pytest.mark.parametrize(("power", "direction"), [(2.0, "accelerating"), (0.5, "slowing")])
@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_bent_wear_is_told_with_its_direction(power, direction, noise):
    def draw(rng):
        t = np.arange(1.0, 61.0)
        wandering = np.cumsum(0.02 * rng.standard_normal(60))
        return t, 4 * (t / 60) ** power + wandering + noise * rng.standard_normal(60)

    found = told(draw, 40, 5)
    assert len(found) >= 36
    assert set(found) == {direction}


def test_of_falling_signals():
    """A capacity that falls ever faster accelerates."""
    rng = np.random.default_rng(1)
    t = np.arange(2000.0)
    y = 1 - 6e-8 * t**2 + 0.002 * rng.standard_normal(2000)
    assert forecast(t, y, 0.5, falls=True).bend.direction == "accelerating"
    assert forecast(t, -y, -0.5).bend.direction == "accelerating"
    assert forecast(t, 1e-5 * t + 0.01 * rng.standard_normal(2000), 1.0).bend.direction is None


def test_a_crack():
    """A specimen of Alloy-A (Meeker and Escobar 1998, table C.14), which grows ever faster [inch, million cycles]."""
    length = np.array([0.90, 0.94, 0.98, 1.03, 1.07, 1.12, 1.19, 1.24, 1.34, 1.43, 1.55, 1.71])
    assert bend_of_wiener(np.arange(12) * 0.01, length).direction == "accelerating"
