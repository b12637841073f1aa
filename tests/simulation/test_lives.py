"""Lives against SciPy's own distributions, given the same mean."""

import math

import numpy as np
import pytest
from scipy import stats

from robophm.simulation.lives import LIVES, exponential, gamma, lognormal, normal, weibull

MEAN = 80.0
CASES = {
    "exponential": (exponential(), stats.expon(scale=MEAN)),
    "weibull": (weibull(2.5), stats.weibull_min(2.5, scale=MEAN / math.gamma(1 + 1 / 2.5))),
    "weibull, early": (weibull(0.7), stats.weibull_min(0.7, scale=MEAN / math.gamma(1 + 1 / 0.7))),
    "lognormal": (lognormal(0.6), stats.lognorm(0.6, scale=MEAN * math.exp(-(0.6**2) / 2))),
    "gamma": (gamma(3.5), stats.gamma(3.5, scale=MEAN / 3.5)),
    "normal": (normal(12.0), stats.norm(MEAN, 12.0)),
}


def test_every_distribution_is_here():
    assert {name.partition(",")[0] for name in CASES} == set(LIVES)


@pytest.mark.parametrize("name", CASES)
def test_survival_and_its_inverse(name):
    life, peer = CASES[name]
    ages = np.array([1.0, 20.0, 79.0, 120.0, 200.0])
    assert peer.mean() == pytest.approx(MEAN, rel=1e-12)
    assert life.log_survival(ages, MEAN) == pytest.approx(peer.logsf(ages), rel=1e-9)
    chances = np.array([0.999, 0.9, 0.5, 0.01, 1e-9])
    assert life.age_at(np.log(chances), MEAN) == pytest.approx(peer.isf(chances), rel=1e-9)


@pytest.mark.parametrize("name", [name for name in CASES if name != "normal"])
def test_a_new_part_works(name):
    assert CASES[name][0].log_survival(np.array([0.0]), MEAN) == 0.0
