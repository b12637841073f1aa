"""Backtests: what was known at each cut, and metrics by hand and by brute force."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import Forecast, forecast
from robophm.learning.wear.backtest import Backtest, Cut, backtest
from robophm.learning.wear.trend_bend import Bend

CRACK = np.array([0.90, 0.94, 0.98, 1.03, 1.07, 1.12, 1.19, 1.24, 1.34, 1.43, 1.55, 1.71])
"""A specimen of Alloy-A (Meeker and Escobar 1998, table C.14) [inch], a reading each 0.01 million cycles."""


def test_each_cut_knows_what_was_read_until_then_alone():
    done = backtest(np.arange(12) * 0.01, CRACK, 1.6, cuts=11)
    assert done.reached
    assert done.end == pytest.approx(0.1 + 0.01 * (1.6 - 1.55) / (1.71 - 1.55))
    assert [cut.readings for cut in done.cuts] == [4, 5, 6, 7, 8, 9, 10]
    for cut in done.cuts:
        alone = forecast(np.arange(cut.readings) * 0.01, CRACK[: cut.readings], 1.6, draws=1000)
        assert cut.forecast.remaining == alone.remaining
        assert cut.time + cut.left == pytest.approx(done.end)
    changed = backtest(np.arange(12) * 0.01, np.r_[CRACK[:9], 1.45, 1.56, 1.8], 1.6, cuts=11)
    assert changed.cuts[0].forecast.remaining == done.cuts[0].forecast.remaining


def test_a_falling_signal_is_the_same_turned_round():
    up = backtest(np.arange(12), CRACK, 1.6)
    down = backtest(np.arange(12), -CRACK, -1.6, falls=True)
    assert [cut.median for cut in up.cuts] == [cut.median for cut in down.cuts]
    assert (down.threshold, down.end) == (-1.6, up.end)


def said(*draws):
    """A forecast of equally likely draws."""
    return Forecast(1.0, np.array(draws, dtype=float), np.ones(1), 0.0, Bend(1.0, False), {}, 1.0)


def test_metrics_by_hand():
    """True remaining lives of 80, 60, 40, 20; α = 0.2: within 16, 12, 8, 4 of them, and at first within 20 of all."""
    found = (said(110, 120, 130), None, said(30, 50, 60), said(17, 18, 19))
    cuts = tuple(Cut(time, 4, one, 100 - time) for time, one in zip((20.0, 40.0, 60.0, 80.0), found, strict=True))
    done = Backtest(1.0, True, 100.0, cuts)
    assert [cut.near for cut in cuts] == [False, False, False, True]
    assert [cut.accuracy for cut in cuts] == [pytest.approx(0.5), None, pytest.approx(0.75), pytest.approx(0.9)]
    assert [cut.held for cut in cuts] == [False, False, True, False]
    assert done.coverage == pytest.approx(1 / 3)
    assert done.relative_accuracy == pytest.approx((0.5 + 0.75 + 0.9) / 3)
    assert done.horizon == 40
    assert done.near_from == 80
    assert Backtest(1.0, True, 100.0, cuts[:3]).near_from is None
    nothing = Backtest(1.0, True, 100.0, cuts[1:2])
    assert (nothing.coverage, nothing.relative_accuracy, nothing.horizon) == (None, None, None)


def test_quantiles_beyond_the_horizon_are_the_horizon():
    cut = Cut(10.0, 4, said(1.0, 2.0, np.inf, np.inf), 5.0)
    assert cut.quantiles([0.25, 0.5, 0.75]).tolist() == [1, 2, 600]
    with pytest.raises(DataError, match="nothing was foretold"):
        Cut(10.0, 4, None, 5.0).quantiles([0.5])


def test_wear_short_of_its_threshold_is_foretold_to_where_it_is_now():
    done = backtest(np.arange(12), CRACK, 9.0)
    assert not done.reached
    assert done.threshold == 1.55
    assert done.end == 10
    assert max(cut.time for cut in done.cuts) < 10


@pytest.mark.full
def test_others_of_its_kind_teach_at_each_cut_too():
    others = [Unit(np.arange(12.0), CRACK * share) for share in (0.98, 1.0, 1.01, 1.02)]
    alone, among = backtest(np.arange(12), CRACK, 1.6), backtest(np.arange(12), CRACK, 1.6, others=others)
    for cut in among.cuts:
        known = np.arange(cut.readings), CRACK[: cut.readings]
        assert cut.forecast.remaining == forecast_among(others, *known, 1.6, draws=1000).remaining
    assert among.relative_accuracy > alone.relative_accuracy


def test_a_signal_that_stood_still_at_first():
    done = backtest(np.arange(30.0), np.r_[np.ones(15), 1 + 0.1 * np.arange(15)], 2.0, cuts=10)
    assert done.cuts[0].forecast is None
    assert done.cuts[-1].forecast is not None


@pytest.mark.full
def test_straight_wear_holds_its_intervals():
    """By simulation: of all cuts of forty units more than 80 %, though those of one unit go together."""
    rng, shares = np.random.default_rng(5), []
    for k in range(40):
        path = 1 + np.cumsum(0.05 + 0.05 * rng.standard_normal(200))
        done = backtest(np.arange(200.0), path, 4.0, cuts=6, seed=k, draws=300)
        shares.append(done.coverage)
    assert np.mean(shares) > 0.8


@pytest.mark.full
def test_real_cracks_come_near_their_end(measured_wear):
    """Virkler's: intervals hold, and half of the way before the end the median is good to within a third."""
    found = [backtest(t, y, 49.8, cuts=10, draws=300) for t, y in list(measured_wear("virkler_crack").values())[:12]]
    assert all(one.reached for one in found)
    coverage = np.mean([one.coverage for one in found])
    accuracy = np.median([one.relative_accuracy for one in found])
    print(f"12 cracks, 10 cuts each: {coverage:.0%} of 90 % intervals held, relative accuracy {accuracy:.2f}")
    assert coverage > 0.7


@pytest.mark.parametrize(
    ("t", "y", "said"),
    [
        ([0, 1, 2], [1, 2, 3], "3 readings"),
        ([0, 1, 2, 3, 4], [1, 2, 3, 9, 9.5], "fewer than 4 readings before 9 was reached"),
        (np.arange(30), 5 - 0.1 * np.arange(30), "its last readings show no wear"),
    ],
)
def test_refusals(t, y, said):
    with pytest.raises(DataError, match=said):
        backtest(t, y, 9)
