"""Many distributions side by side give what each gives alone, in every place and for every number of axes."""

import mpmath as mp
import numpy as np
import pytest

from robophm.life import LifeDistribution
from robophm.life.curve import Curve
from robophm.life.exponential import Exponential
from robophm.life.extreme_value import ExtremeValue
from robophm.life.gamma import Gamma
from robophm.life.loglogistic import Loglogistic
from robophm.life.lognormal import Lognormal
from robophm.life.rayleigh import Rayleigh
from robophm.life.side_by_side import Lives
from robophm.life.weibull import Weibull

LIVES: list[LifeDistribution] = [
    Weibull(1e4, 2.0), Exponential(1e-4), Weibull(3e3, 0.7), Lognormal(8.0, 1.2), Weibull(1e4, 2.0), Gamma(2e3, 3.0),
    Exponential(1e-6), Rayleigh(5e3), Loglogistic(4e3, 2.5), ExtremeValue(9e3, 1e3), Gamma(2e3, 3.0),
    Loglogistic(1e3, 0.8), Exponential(2e-4),
]  # fmt: skip
LATER = [*LIVES, Weibull(2e3, 1.5, 500.0), Exponential(1e-3, 100.0), Curve(1e-4, 0.6)]
SHARE = np.linspace(0.25, 1.0, len(LATER))


@pytest.mark.parametrize("lives", [LIVES, LATER, LIVES[:1], LIVES[1:2]], ids=["plain", "any", "weibull", "exponential"])
@pytest.mark.parametrize("shape", [(), (5,), (5, 3)])
def test_as_each_alone(lives, shape):
    rng = np.random.default_rng(len(shape))
    age = 10 ** rng.uniform(-2, 4.5, (len(lives), *shape))
    duration = 10 ** rng.uniform(-6, 4.5, age.shape)
    if shape:
        age[:, 0], duration[:, 1] = 0.0, 0.0
    share = SHARE[: len(lives)]
    together = Lives(lives, share)
    increment, hazard = together.increment(age, duration), together.hazard(age)
    both = together.hazards(age)
    for i, life in enumerate(lives):
        for found, alone in (
            (increment[i], life.increment(age[i], duration[i])),
            (hazard[i], life.hazard(age[i])),
            (both[0][i], life.increment(np.zeros_like(age[i]), age[i])),
            (both[1][i], life.hazard(age[i])),
        ):
            np.testing.assert_allclose(found, share[i] * alone, rtol=2e-14)


def test_an_age_of_all():
    together = Lives(LATER)
    durations = np.random.default_rng(1).uniform(0, 1e4, (len(LATER), 4))
    found = together.increment(np.zeros((1, 1)), durations)
    np.testing.assert_array_equal(found, together.increment(np.zeros_like(durations), durations))


@pytest.mark.parametrize(
    "lives", [LIVES, LATER, LIVES[:1], [Weibull(1e4, 2.0), Weibull(3e3, 0.7)]], ids=["plain", "any", "one", "weibulls"]
)
@pytest.mark.parametrize("draws", [1, 3])
@pytest.mark.parametrize("new", [True, False])
def test_at_a_pace_as_each_alone(lives, draws, new):
    rng = np.random.default_rng(draws)
    times = np.append(0.0, 10 ** rng.uniform(-5, 4.5, 6))
    age = np.zeros((len(lives), draws)) if new else 10 ** rng.uniform(-2, 4.5, (len(lives), draws))
    pace = 10 ** rng.uniform(-2, 1, age.shape)
    pace[-1] = 0.0
    found = Lives(lives, SHARE[: len(lives)]).at_pace(age, pace)(times)
    assert found.shape == (len(lives), len(times), draws)
    for i, life in enumerate(lives):
        alone = life.increment(age[i], pace[i] * times[:, None])
        np.testing.assert_allclose(found[i], SHARE[i] * alone, rtol=2e-14)


@pytest.mark.parametrize("shape", [0.3, 1.0, 2.5, 8.0])
def test_new_weibull_parts_at_a_pace_against_mpmath(shape):
    pace, times = np.array([1e-3, 0.7, 3.0, 100.0]), 10.0 ** np.arange(-4, 5)
    lives = Lives([Weibull(2e4, shape)] * len(pace))
    found = lives.at_pace(np.zeros((len(pace), 1)), pace[:, None])(times)[..., 0]
    with mp.workdps(40):
        exact = [[float((mp.mpf(p) * mp.mpf(t) / 20000) ** mp.mpf(shape)) for t in times] for p in pace]
    np.testing.assert_allclose(found, exact, rtol=1e-13)


def test_at_a_pace_far_and_near():
    """Beyond all numbers it is infinite, before all of them 0, and nothing where no time goes by."""
    lives = Lives([Weibull(1.0, 50.0), Weibull(1.0, 0.5)])
    found = lives.at_pace(np.zeros((2, 1)), np.ones((2, 1)))(np.array([0.0, 1e-250, 1.0, 1e250]))[..., 0]
    np.testing.assert_allclose(found, [[0.0, 0.0, 1.0, np.inf], [0.0, 1e-125, 1.0, 1e125]], rtol=1e-13)


def test_far_and_near():
    """Where H overflows it is infinite, but for no time at all; at birth a falling hazard is infinite."""
    together = Lives([Weibull(1.0, 50.0), Weibull(1.0, 0.5), Weibull(1.0, 38.0)])
    age, duration = np.array([1e10, 0.0, 1e-8]), np.array([0.0, 1.0, 1.0])
    np.testing.assert_allclose(together.increment(age, duration), [0.0, 1.0, (1 + 1e-8) ** 38], rtol=1e-15)
    assert together.increment(age, duration + 1.0)[0] == np.inf
    total, now = together.hazards(age)
    np.testing.assert_allclose(total[1:], [0.0, 0.0], atol=1e-300)
    assert now[1] == np.inf
    assert 0 < now[2] == pytest.approx(38 * 1e-8**37, rel=1e-12)
