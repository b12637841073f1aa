"""Many distributions side by side give what each gives alone, in every place and for every number of axes."""

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
