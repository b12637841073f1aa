"""Alternating renewals against Markov chains whose matrices are exponentiated, and against renewals that are drawn."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from robophm.core.renewal import Law, Renewals, constant

TIMES = np.array([5.0, 20.0, 150.0, 1000.0, 4000.0, 8000.0])
WORKS, DOWN = np.array([False]), np.array([True])


def erlang(rate: float) -> Law:
    """A life of two stages of equal rates."""

    def failed(hours: np.ndarray) -> np.ndarray:
        return 1 - np.exp(-rate * hours) * (1 + rate * hours)

    return Law(failed, failed)


def weibull(scale: float, shape: float) -> Law:
    def failed(hours: np.ndarray) -> np.ndarray:
        return -np.expm1(-((hours / scale) ** shape))

    return Law(failed, failed)


@pytest.mark.full
@pytest.mark.parametrize("repair", [0.5, 4.0, 200.0])
@pytest.mark.parametrize("down", [WORKS, DOWN])
def test_lives_of_two_stages_are_those_of_their_markov_chain(repair: float, down: np.ndarray) -> None:
    rate = 1 / 600
    chain = np.array([[-rate, rate, 0], [0, -rate, rate], [1 / repair, 0, -1 / repair]])
    begin = 2 if down[0] else 0
    states = np.array([expm(chain * time)[begin] for time in TIMES])
    found, frequency = Renewals([erlang(rate)], np.array([repair]), np.array([8760.0]), down).at(TIMES)
    assert found[0] == pytest.approx(states[:, 2], rel=2e-4, abs=2e-5 * states[:, 2].max())
    often = rate * states[:, 1]
    assert frequency[0] == pytest.approx(often, rel=2e-4, abs=1e-4 * often.max())


def test_what_is_not_repaired_stays_down() -> None:
    law = weibull(3000.0, 2.5)
    found, _ = Renewals([law], np.array([np.inf]), np.array([8760.0]), WORKS).at(TIMES)
    assert found[0] == pytest.approx(law.first(TIMES), abs=1e-5)


def test_constant_rates_are_their_markov_chain() -> None:
    rate, repair = np.array([1e-3, 0.02, 0.0]), np.array([8.0, 300.0, 5.0])
    for down in (np.zeros(3, dtype=bool), np.ones(3, dtype=bool)):
        found, frequency = constant(rate, repair, down, TIMES)
        for i in range(3):
            chain = np.array([[-rate[i], rate[i]], [1 / repair[i], -1 / repair[i]]])
            states = np.array([expm(chain * time)[int(down[i])] for time in TIMES])
            assert found[i] == pytest.approx(states[:, 1], rel=1e-9, abs=1e-16)
            assert frequency[i] == pytest.approx(rate[i] * states[:, 0], rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("shape", [0.7, 1.8, 4.0])
def test_lives_that_age_are_as_drawn(shape: float) -> None:
    """60,000 histories of a part: how many are down at a time, and how often each has failed."""
    drawn, repair, until = np.random.default_rng(7), 60.0, 3000.0
    time, fails = np.zeros(60_000), np.zeros((60_000, len(TIMES)))
    down = np.zeros_like(fails)
    seen = TIMES[until > TIMES]
    while (alive := time < until).any():
        failed = time + 1000 * drawn.weibull(shape, len(time))
        back = failed + drawn.exponential(repair, len(time))
        for i, at in enumerate(seen):
            fails[:, i] += alive & (failed <= at)
            down[:, i] += alive & (failed <= at) & (at < back)
        time = back
    found, _ = Renewals([weibull(1000.0, shape)], np.array([repair]), np.array([until]), WORKS).at(seen)
    share = down[:, : len(seen)].mean(axis=0)
    assert np.all(np.abs(found[0] - share) < 4.5 * np.sqrt(found[0] / len(time)) + 2e-3 * found[0])


def test_in_the_long_run_means_alone_decide() -> None:
    from math import gamma

    mean, repair = 800 * gamma(1 + 1 / 1.5), 30.0
    found, frequency = Renewals([weibull(800.0, 1.5)], np.array([repair]), np.array([30_000.0]), WORKS).at(
        np.array([29_000.0])
    )
    assert found[0, 0] == pytest.approx(repair / (mean + repair), rel=1e-4)
    assert frequency[0, 0] == pytest.approx(1 / (mean + repair), rel=1e-4)
