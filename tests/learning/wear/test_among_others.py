"""Wear foretold with others of its kind as teachers: real cracks, simulated fleets, and what cannot be said."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Unit, forecast_among, stacked
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.log_regression import LIFE_SCATTER, lasting

CRACKS = Path(__file__).parents[4] / "shared/degradation/virkler_crack.csv"


def fleet(rng, count, bend=2.0, spread=0.3, noise=0.0):
    """Units whose wear goes as tᵇᵉⁿᵈ to 1, each at a speed of its own; times until just after the end."""
    found = []
    for life in 100 * np.exp(spread * rng.standard_normal(count)):
        t = np.arange(0.0, 1.02 * life, 2.0)
        wear = (t / life) ** bend * np.exp(0.01 * np.cumsum(rng.standard_normal(len(t))))
        found.append(
            (t, wear + noise * rng.standard_normal(len(t)), float(np.interp(1.0, np.maximum.accumulate(wear), t)))
        )
    return found


@pytest.mark.full
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_intervals_hold_and_medians_are_no_worse_than_alone(noise):
    rng, held, off = np.random.default_rng(5), 0, []
    for _ in range(25):
        (t, y, end), *others = fleet(rng, 9, noise=noise)
        seen = t <= 0.6 * end
        units = [Unit(*one[:2]) for one in others]
        rest = end - t[seen][-1]
        low, median, high = forecast_among(units, t[seen], y[seen], 1.0, draws=1000).remaining
        held += low <= rest <= high
        alone = forecast(t[seen], y[seen], 1.0, draws=1000).remaining.median
        off.append((abs(median / rest - 1), abs(alone / rest - 1)))
    assert held >= 20
    with_others, by_itself = np.median(off, axis=0)
    assert with_others < by_itself


@pytest.mark.skipif(not CRACKS.is_file(), reason="the data of Virkler's cracks are not here")
@pytest.mark.full
def test_real_cracks_by_thirty_others():
    """Virkler, Hillberry and Goel 1979: at half of life the error of the median is below .1, and intervals hold."""
    units = {}
    with CRACKS.open() as table:
        for row in csv.DictReader(table):
            units.setdefault(row["unit"], []).append((float(row["time"]), float(row["value"])))
    read = {name: tuple(np.array(part) for part in zip(*rows, strict=True)) for name, rows in units.items()}
    off, held = [], []
    for name in list(read)[:8]:
        t, y = read[name]
        seen = t <= 0.5 * t[-1]
        others = [Unit(*known) for other, known in read.items() if other != name]
        low, median, high = forecast_among(others, t[seen], y[seen], 49.8).remaining
        truth = t[-1] - t[seen][-1]
        off.append(abs(median / truth - 1))
        held.append(low <= truth <= high)
    assert np.median(off) < 0.1
    assert sum(held) >= 6


def test_those_that_still_run_lengthen_what_is_said():
    rng = np.random.default_rng(2)
    (t, y, end), *others = fleet(rng, 8, bend=1.0, spread=0.1, noise=0.05)
    seen = t <= 0.2 * end
    failed = [Unit(*one[:2]) for one in others[:4]]
    flat = np.arange(0.0, 400.0, 2.0)
    lasting = [Unit(flat, np.minimum(flat / 100, 0.35) + 0.05 * rng.standard_normal(len(flat))) for _ in range(4)]
    before = forecast_among(failed, t[seen], y[seen], 1.0).remaining.median
    after = forecast_among([*failed, *lasting], t[seen], y[seen], 1.0).remaining.median
    assert after > 1.3 * before


def test_falling_signals_and_thresholds_of_their_own():
    rng = np.random.default_rng(4)
    (t, y, end), *others = fleet(rng, 6)
    seen = t <= 0.6 * end
    rising = forecast_among([Unit(a, b, 1.0) for a, b, _ in others], t[seen], y[seen], 1.0)
    falling = forecast_among([Unit(a, 2 - b, 1.0) for a, b, _ in others], t[seen], 2 - y[seen], 1.0, falls=True)
    np.testing.assert_allclose(falling.remaining, rising.remaining, rtol=0.05)
    assert sum(rising.weights.values()) == pytest.approx(1)


def test_without_others_that_ended_it_is_as_alone():
    rng = np.random.default_rng(6)
    ((t, y, end),) = fleet(rng, 1)
    seen = t <= 0.5 * end
    alone = forecast(t[seen], y[seen], 1.0)
    running = [Unit(t[:5], y[:5])]
    for others in ([], running):
        assert forecast_among(others, t[seen], y[seen], 1.0).remaining == alone.remaining


def test_before_a_trend_shows_it_is_by_the_lives_of_the_others():
    """Bearings that look sound until shortly before they fail: how long others lived that grew as old."""
    rng = np.random.default_rng(3)
    lives = np.array([80.0, 90.0, 110.0, 120.0, 150.0])
    others = []
    for life in lives:
        t = np.arange(0.0, life + 1)
        others.append(Unit(t, 0.3 + 0.02 * rng.standard_normal(len(t)) + 2 * (t >= life - 1)))
    t = np.arange(60.0)
    found = forecast_among(others, t, 0.3 + 0.02 * rng.standard_normal(60), 1.2)
    crossed = [one.times[np.argmax(one.values >= 1.2)] - 0.5 for one in others]
    none = np.zeros((5, 0))
    law = lasting(np.array(crossed), np.full(5, True), none, none[0], 59.0, LIFE_SCATTER)
    assert found.weights["others' lives"] == 1
    assert (found.shows, found.said) == (False, True)
    assert found.remaining == pytest.approx(law.quantile(np.array([0.05, 0.5, 0.95])), rel=0.08)


@pytest.mark.full
@pytest.mark.parametrize("spread", [0.1, 0.3])
def test_one_other_is_a_teacher_whose_kind_differs_as_kinds_mostly_do(spread):
    """Of a kind that differs by 0.1 to 0.3: of 20 intervals 15 or more hold (fewer: 1 % of runs); none is open."""
    rng, held = np.random.default_rng(6), 0
    for _ in range(20):
        (t, y, end), (a, b, _) = fleet(rng, 2, spread=spread)
        seen = t <= 0.7 * end
        low, _, high = forecast_among([Unit(a, b)], t[seen], y[seen], 1.0, draws=800).remaining
        held += low <= end - t[seen][-1] <= high
        assert np.isfinite(high)
    assert held >= 15


def test_failed_without_having_reached_the_threshold():
    """Units that are known to have failed early shorten what is said, whatever their readings were."""
    rng = np.random.default_rng(9)
    (t, y, end), *others = fleet(rng, 8, spread=0.1)
    seen = t <= 0.4 * end
    reached = [Unit(*one[:2]) for one in others]
    early = [Unit(a[a < 0.6 * e], b[a < 0.6 * e], failed=0.6 * e) for a, b, e in others]
    usual, short = (forecast_among(one, t[seen], y[seen], 1.0).remaining.median for one in (reached, early))
    assert short < 0.6 * usual


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        (Unit(np.array([1.0]), np.array([0.1])), "unit 1 of the others: expected two readings"),
        (Unit(np.array([2.0, 1.0]), np.array([0.1, 0.2])), "each later than the one before"),
        (Unit(np.array([1.0, 2.0]), np.array([0.1, np.nan])), "a time or value is no number"),
        (Unit(np.array([1.0, 2.0]), np.array([0.1, 1e300])), "or none that a clock or sensor says"),
        (Unit(np.array([0.0, 1e-300]), np.array([0.1, 0.2])), "or none that a clock or sensor says"),
        (Unit(np.array([1.0, 2.0, 3.0]), np.array([1.1, 1.2, 1.3])), "unit 1 of the others is past the threshold when"),
    ],
)
def test_others_that_are_none(unit, expected):
    t = np.arange(10.0)
    with pytest.raises(DataError, match=expected):
        forecast_among([unit], t, 0.02 * t**1.5, 1.0)


def test_weights_are_the_shares_of_kinds():
    """By a general optimiser: Dirichlet's prior of one unit, times the likelihood of a mixture of the ways."""
    rng = np.random.default_rng(4)
    prior = {"a": 0.5, "b": 0.3, "c": 0.2}
    logs = rng.normal(0, 2, (7, 3))
    share = np.array(list(prior.values()))

    def off(free):
        weights = np.exp(free) / np.exp(free).sum()
        return -np.log(np.exp(logs) @ weights).sum() - share @ np.log(weights)

    best = minimize(off, np.zeros(3), tol=1e-12).x
    found = stacked(prior, dict(zip(prior, logs.T.tolist(), strict=True)))
    assert [*found.values()] == pytest.approx(np.exp(best) / np.exp(best).sum(), abs=1e-3)
    assert stacked(prior, {"a": [], "b": [], "c": []}) == pytest.approx(prior)
    # One that was not asked is as good as the mean of those that were, here all alike.
    assert stacked(prior, {"a": [-1.0, -1.0], "b": [], "c": [-1.0]}) == pytest.approx(prior)


def test_one_of_another_kind_keeps_the_way_that_foretells_its_kind():
    """Of ten others nine went as one way says, one as the other does: the next may be either."""
    found = stacked({"a": 0.5, "b": 0.5}, {"a": [0.0] * 9 + [-15.0], "b": [-15.0] * 9 + [0.0]})
    assert found == pytest.approx({"a": 9.5 / 11, "b": 1.5 / 11}, abs=1e-4)
