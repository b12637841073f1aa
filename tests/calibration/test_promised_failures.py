"""Promised failures against noted ones: closed forms, plain sums of Poisson masses, simulated robots."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robophm.calibration.promised_failures import CountedFailures, promised_failures
from robophm.core.signal import HOUR
from robophm.stores.figures import FIGURES, FigureSeries, joined, packed, unpacked

HOURS = np.arange(0, 721)
"""Reports, one an hour of 30 days."""


def history(failed):
    """What a store keeps of reports with this probability of having failed since new."""
    values = np.full((len(failed), len(FIGURES)), np.nan)
    values[:, FIGURES.index("unreliability.sensor_based")] = failed
    times = HOURS[: len(failed)] * HOUR
    series = FigureSeries(0, times, (~np.isnan(values)).astype(int), values, values, values)
    return unpacked(0, times.tolist(), packed(series))  # in single precision


def test_what_is_promised_is_the_cumulative_hazard_gone_through():
    worn = -np.expm1(-(((HOURS + 100) / 400) ** 2))  # Weibull, begun at an age of 100 h
    expected = (820 / 400) ** 2 - (100 / 400) ** 2
    assert promised_failures(history(worn), [], "sensor_based") == pytest.approx(expected, rel=1e-5)
    assert promised_failures(history(worn), [], "nominal") is None
    assert promised_failures(history(worn[:1]), [], "sensor_based") is None
    assert promised_failures(history(np.minimum(worn + 0.9, 0.99999)), [], "sensor_based") is None


@pytest.mark.parametrize("width", [0, 6 * HOUR])
def test_a_service_does_not_take_back_what_was_promised_before_it(width):
    """A part without wear on, one of 1/500 h put in new after 300.5 h: 720 h, less what passes around the service."""
    gone = HOURS / 500
    gone[301:] -= 300.5 / 500
    series = history(-np.expm1(-gone))
    series = joined(series, width) if width else series
    service = round(300.5 * HOUR)
    left_out = 12 + 5 if width else 1  # of spans of six hours half of the first and last are too
    assert promised_failures(series, [service], "sensor_based") == pytest.approx((720 - left_out) / 500, rel=0.01)
    assert promised_failures(series, [], "sensor_based") is None  # it fell without a reason


def mass(count, mean):
    return math.exp(-mean) * mean**count / math.factorial(count)


@pytest.mark.parametrize("promised", [0.01, 0.3, 1.0, 4.2, 12.0])
@pytest.mark.parametrize("noted", [0, 1, 2, 5, 14])
def test_a_count_is_judged_by_both_tails(promised, noted):
    below, above = (sum(mass(k, promised) for k in some) for some in (range(noted + 1), range(noted, 100)))
    counted = CountedFailures(promised, noted)
    assert counted.chance == pytest.approx(min(1, 2 * min(below, above)), rel=1e-9)
    few, many = counted.against
    speaks = [CountedFailures(promised, one).chance < 0.05 for one in range(40)]
    assert speaks == [(few is not None and one <= few) or one >= many for one in range(40)]
    assert ("does not hold" in counted.says) == speaks[noted]


def test_what_is_said():
    assert CountedFailures(0.23, 0).says == (
        "Nothing speaks against what was promised: 0.23 promised, none noted; 2 or more would speak against it"
    )
    assert CountedFailures(12.0, 2).says.startswith(
        "What was promised does not hold: 12 promised, 2 noted, fewer than chance explains (0.1"
    )


def test_robots_that_keep_their_promise_are_believed_and_others_are_not():
    """Repaired as new after each failure, Weibull with shape 2: what they went through is not fixed beforehand."""
    rng = np.random.default_rng(5)

    def judged(truth):
        found = []
        for _ in range(1000):
            promised, failures, age, clock = 0.0, 0, 0.0, 0.0
            while clock < 20:
                life = truth * rng.weibull(2)
                spent = min(life, 20 - clock)
                promised += spent**2 - age**2  # as of a scale of 1
                failures += life < 20 - clock
                clock += spent
            found.append(CountedFailures(promised, failures).chance < 0.05)
        return np.mean(found)

    assert judged(1.0) < 0.07
    assert judged(0.6) > 0.6
