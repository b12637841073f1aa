"""Paths that the next part may take: of simulated kinds, whose paths and lives are known."""

import numpy as np
import pytest
from scipy.stats import lognorm

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.possible_paths import SHARES, paths_of_forecast, paths_of_others

LIVES = lognorm.ppf((np.arange(40) + 0.5) / 40, 0.2, scale=100.0)


def unit(life: float, *, until: float = 1.0, falls: bool = False) -> Unit:
    """From 2 to 10 along the square of age, or from −2 down to −10."""
    times = np.linspace(0.0, until * life, 60)
    values = 2 + 8 * (times / life) ** 2
    return Unit(times, -values if falls else values)


@pytest.mark.parametrize("falls", [False, True])
def test_the_paths_and_lives_of_a_kind(falls):
    sign = -1 if falls else 1
    found = paths_of_others([unit(life, falls=falls) for life in LIVES], sign * 10.0)
    assert (found.known, found.new, found.way) == (40, sign * 2, pytest.approx(sign * 8))
    assert found.wear == pytest.approx(np.tile(SHARES**2, (40, 1)), abs=0.02)
    assert found.noise < 1e-3
    assert np.median(found.lives) == pytest.approx(100.0, rel=0.01)
    assert np.std(np.log(found.lives)) == pytest.approx(0.2, rel=0.1)


def test_those_that_still_run_last_longer():
    ended = paths_of_others([unit(life) for life in LIVES[:20]], 10.0)
    with_others = paths_of_others([unit(life, until=min(80 / life, 1.0)) for life in LIVES], 10.0)
    alone = paths_of_others([unit(life) for life in LIVES if life <= 80], 10.0)
    assert with_others.known == alone.known == np.sum(LIVES <= 80)
    assert np.median(alone.lives) < np.median(ended.lives) < np.median(with_others.lives)
    with pytest.raises(DataError, match="none of its kind wore out"):
        paths_of_others([unit(100.0, until=0.5)], 10.0)


def test_one_that_failed_before_it_came_to_the_threshold_ends_below_it():
    early = unit(100.0, until=0.7)
    found = paths_of_others([Unit(early.times, early.values, failed=float(early.times[-1]))], 10.0)
    assert found.wear[0] == pytest.approx(0.49 * SHARES**2, abs=0.02)


def test_the_forecast_of_one_part_alone():
    """Straight wear with little noise: levels are shares of life, and the next life differs as parts of a kind do."""
    rng = np.random.default_rng(1)
    times = np.arange(60.0)
    values = 10 - 8 * times / 100 + 0.02 * rng.standard_normal(60)
    found = paths_of_forecast(forecast(times, values, 2.0, falls=True), times, values)
    assert found.known == 0
    assert (found.new, found.way) == (pytest.approx(10.0, abs=0.1), pytest.approx(-8.0, abs=0.1))
    assert np.median(found.wear, axis=0) == pytest.approx(SHARES, abs=0.04)
    assert np.all(np.diff(found.wear, axis=1) >= -1e-9)
    assert found.noise == pytest.approx(0.02 / 8, rel=0.3)
    assert np.median(found.lives) == pytest.approx(100.0, rel=0.06)
    assert 0.3 < np.std(np.log(found.lives)) < 0.8
    still = 5 + 0.1 * rng.standard_normal(60)
    with pytest.raises(DataError, match="no trend shows yet"):
        paths_of_forecast(forecast(times, still, 2.0, falls=True), times, still)
