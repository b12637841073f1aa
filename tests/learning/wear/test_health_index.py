"""An index of health by many signals: simulated fleets, NASA's engines, and what cannot be learned."""

import csv
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.health_index import SignalHistory, learn_health_index

ENGINES = Path(__file__).parents[4] / "shared/degradation"


def course(rng, life=None):
    """Three signals of which two show wear in the last sixty hours, one is noise and one stands still."""
    life = life or int(rng.uniform(80, 240))
    t = np.arange(1.0, life + 1)
    worn = np.maximum(0.0, 1 - (life - t) / 60) ** 1.5
    noise = rng.standard_normal((len(t), 3))
    values = np.column_stack(
        [300 + 10 * worn + noise[:, 0], 5 - 2 * worn + 0.3 * noise[:, 1], noise[:, 2], np.ones(len(t))]
    )
    return SignalHistory(t, values)


@pytest.mark.full
def test_intervals_hold_and_the_index_tells():
    rng = np.random.default_rng(1)
    index = learn_health_index([course(rng) for _ in range(40)], horizon=60)
    off, held = [], []
    for _ in range(100):
        one = course(rng)
        rest = float(rng.integers(5, 50))
        seen = one.times <= one.times[-1] - rest
        said = index.remaining(one.times[seen], one.values[seen])
        off.append(said.index - rest)
        held.append(said.interval[0] <= rest <= said.interval[2])
    assert np.sqrt(np.mean(np.square(off))) < 10
    assert 0.82 <= np.mean(held) <= 1


@pytest.mark.full
@pytest.mark.skipif(not ENGINES.is_dir(), reason="NASA's engines are not here")
def test_nasas_engines():
    """C-MAPSS FD001 (Saxena and others 2008), engines 1 to 50: published networks have an RMSE of 12.6 to 18.4."""

    def table(file):
        rows = np.genfromtxt(ENGINES / file, delimiter=",", skip_header=1)
        return [rows[rows[:, 0] == unit][:, 1:] for unit in np.unique(rows[:, 0])]

    failed, running = table("cmapss_fd001_train.csv"), table("cmapss_fd001_test_1_50.csv")
    with (ENGINES / "cmapss_fd001_rul_1_50.csv").open() as rows:
        truth = np.array([float(row["rul"]) for row in csv.DictReader(rows)])
    index = learn_health_index([SignalHistory(one[:, 0], one[:, 1:]) for one in failed], horizon=125, window=30)
    said = [index.remaining(one[:, 0], one[:, 1:]) for one in running]
    off = np.array([one.index for one in said]) - np.minimum(truth, 125)
    assert np.sqrt(np.mean(off**2)) <= 14
    held = np.mean([one.interval[0] <= end <= one.interval[2] for one, end in zip(said, truth, strict=True)])
    assert held >= 0.85


@pytest.mark.full
def test_the_same_readings_give_the_same_and_signals_that_stand_still_do_not_matter():
    rng = np.random.default_rng(2)
    fleet = [course(rng) for _ in range(12)]
    without = [SignalHistory(one.times, one.values[:, :3]) for one in fleet]
    first, again, less = (learn_health_index(one, window=10) for one in (fleet, fleet, without))
    t, values = fleet[0].times[:50], fleet[0].values[:50]
    assert first.remaining(t, values).index == again.remaining(t, values).index
    assert less.remaining(t, values[:, :3]).index == first.remaining(t, values).index


def test_what_cannot_be_learned():
    rng = np.random.default_rng(3)
    fleet = [course(rng, 100) for _ in range(6)]
    t = fleet[0].times
    with pytest.raises(DataError, match="4 units that failed; expected at least 5"):
        learn_health_index(fleet[:4])
    with pytest.raises(DataError, match="units have 3 and 4 signals"):
        learn_health_index([*fleet, SignalHistory(t, fleet[0].values[:, :3])])
    with pytest.raises(DataError, match="no signal varies"):
        learn_health_index([SignalHistory(t, np.ones((100, 2))) for _ in range(6)])
    with pytest.raises(DataError, match="unit 7: times do not ascend"):
        learn_health_index([*fleet, SignalHistory(t[::-1], fleet[0].values)])
    with pytest.raises(DataError, match="unit 7: a time or value is no number"):
        learn_health_index([*fleet, SignalHistory(t, np.full((100, 4), np.nan))])
    with pytest.raises(DataError, match="unit 7: a time or value is beyond 1e"):
        learn_health_index([*fleet, SignalHistory(t, np.full((100, 4), 1e300))])
    index = learn_health_index(fleet, window=10)
    with pytest.raises(DataError, match="the unit: one reading; expected at least two"):
        index.remaining(t[:1], fleet[0].values[:1])
    old = [*t[:-1], 100 * t[-1]]
    with pytest.raises(DataError, match=r"none older than .* how long it goes on cannot be said by them"):
        index.remaining(old, fleet[0].values)
    with pytest.raises(DataError, match="2 signals; expected the 4"):
        index.remaining(t, fleet[0].values[:, :2])
