"""Signals freed of operating conditions: regimes and slopes that are simulated, and an index that needs them."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.health_index import SignalHistory, learn_health_index
from robophm.learning.wear.operating_conditions import learn_operating_conditions


def test_regimes_and_slopes_are_taken_off_and_health_is_left():
    rng = np.random.default_rng(1)
    settings = np.column_stack([rng.choice([0.0, 20.0, 35.0], 3000), rng.uniform(0, 1, 3000)])
    settings[:, 0] += 0.001 * rng.standard_normal(3000)
    health = rng.standard_normal(3000)
    level = np.select([settings[:, 0] < 10, settings[:, 0] < 30], [100.0, 40.0], 70.0)
    values = np.column_stack([level + 8 * settings[:, 1] + health, np.full(3000, 3.0)])
    usual = learn_operating_conditions([values], [settings])
    assert len(usual.regimes) == 3
    found = usual.normalised(values, settings)
    assert found.shape == (3000, 1)  # what stands still is left out
    assert np.corrcoef(found[:, 0], health)[0, 1] > 0.99
    elsewhere = usual.normalised(np.array([[74.0, 3.0]]), np.array([[50.0, 0.5]]))  # nearest is 35, where 74 is usual
    assert abs(elsewhere[0, 0]) < 0.5


def test_settings_that_are_but_coarse_noise_and_none_at_all():
    rng = np.random.default_rng(2)
    x = rng.standard_normal((200, 2))
    coarse = learn_operating_conditions([x], [np.round(rng.standard_normal((200, 2)), 1)])
    assert len(coarse.regimes) <= 50
    none = learn_operating_conditions([x], [np.zeros((200, 0))])
    np.testing.assert_allclose(none.normalised(x, np.zeros((200, 0))), (x - x.mean(axis=0)) / x.std(axis=0))
    with pytest.raises(DataError, match="no signal varies"):
        learn_operating_conditions([np.ones((50, 2))], [np.zeros((50, 0))])


def course(rng):
    """Two signals that six regimes move by far more than wear does, as of engines at several altitudes."""
    life = int(rng.uniform(80, 200))
    t = np.arange(1.0, life + 1)
    regime = rng.integers(0, 6, life)
    worn = np.maximum(0.0, 1 - (life - t) / 60) ** 1.5
    offsets = np.array([500.0, 560.0, 590.0, 610.0, 640.0, 700.0])[regime]
    values = np.column_stack([offsets + 10 * worn, 0.3 * offsets - 4 * worn]) + rng.standard_normal((life, 2))
    settings = np.column_stack([10.0 * regime + 0.01 * rng.standard_normal(life), rng.standard_normal(life)])
    return SignalHistory(t, values, settings)


@pytest.mark.full
def test_an_index_of_health_at_six_operating_conditions():
    """Freed of them it tells what remains; as plain signals it tells half as well or worse."""
    rng = np.random.default_rng(3)
    fleet, asked = [course(rng) for _ in range(20)], [course(rng) for _ in range(50)]
    freed = learn_health_index(fleet, horizon=60, window=10)
    plain = learn_health_index([SignalHistory(one.times, one.values) for one in fleet], horizon=60, window=10)
    off, held = [], []
    for one in asked:
        rest = float(rng.integers(5, 50))
        seen = one.times <= one.times[-1] - rest
        said = freed.remaining(one.times[seen], one.values[seen], one.settings[seen])
        off.append((said.index - rest, plain.remaining(one.times[seen], one.values[seen]).index - rest))
        held.append(said.interval[0] <= rest <= said.interval[2])
    with_settings, without = np.sqrt(np.mean(np.square(off), axis=0))
    assert with_settings < 10
    assert with_settings < 0.7 * without
    assert np.mean(held) >= 0.78  # fewer of intervals that hold 90 % come in 1 % of all runs
    with pytest.raises(DataError, match="0 settings; expected the 2"):
        freed.remaining(asked[0].times, asked[0].values)
