"""Periodic tests: figures that SCRAM's tests print, and a simulation of their definition."""

import math
import random

import pytest

from robophm.design.importers.open_psa.periodic_tests import unavailability

from ....cases import each_case

RATE, REPAIR, FIRST, TIME = 7e-4, 4e-4, 4740.0, 8760.0
FIVE = {
    (REPAIR, 4020): 0.817508, (REPAIR, 2010): 0.736611, (REPAIR, 120): 0.645377, (RATE, 120): 0.511579,
    (0.0, 120): 0.997828,
}  # fmt: skip
ELEVEN = {
    (True, 8760): 0.668316,
    (False, 8760): 0.668316,
    (False, 4750): 1.0,
    (False, 4870): 0.996715,
    (False, 8710): 0.997478,
}
"""Printed in SCRAM's tests/expression_tests.cc, PeriodicTest5 and PeriodicTest11."""


@each_case(("said", "expected"), FIVE.items())
def test_a_test_that_takes_no_time(said, expected):
    repair, every = said
    assert unavailability(RATE, repair, every, FIRST, TIME) == pytest.approx(expected, abs=1e-5)


@each_case(("said", "expected"), ELEVEN.items())
def test_a_test_that_takes_time(said, expected):
    available, time = said
    found = unavailability(RATE, 6e-4, REPAIR, 120, FIRST, 0.01, 20, available, 0.9, 0.01, time)
    assert found == pytest.approx(expected, abs=1e-5)


def test_instant_repair_is_that_of_four_arguments():
    """A part is as new 60 h after the last test, or right before one."""
    for time, since in ((100.0, 100.0), (FIRST, FIRST), (FIRST + 60, 60), (FIRST + 240, 120), (TIME, 60)):
        expected = -math.expm1(-RATE * since)
        assert unavailability(RATE, 120, FIRST, time) == pytest.approx(expected, rel=1e-12)
        if (time - FIRST) % 120:
            assert unavailability(RATE, 1e300, 120, FIRST, time) == pytest.approx(expected, rel=1e-9)


def test_as_simulated():
    """Failed unseen until a test finds it, then repaired at a rate."""
    draw = random.Random(1)
    rate, repair, every, first, time, count, runs = 0.02, 0.05, 30.0, 40.0, 215.0, 0, 20_000
    for _ in range(runs):
        now, works = 0.0, True
        while True:
            if works:
                fails = now + draw.expovariate(rate)
                if fails > time:
                    break
                found = first + max(0, math.ceil((fails - first) / every)) * every
                now, works = found + draw.expovariate(repair), False
            if now > time:
                count += 1
                break
            works = True
    p = unavailability(rate, repair, every, first, time)
    assert abs(count - runs * p) < 4.5 * math.sqrt(runs * p * (1 - p))


@pytest.mark.parametrize(
    "said",
    [
        (0.0, 120, 0, 10), (1e-3, 0, 0, 10), (1e-3, -1, 120, 0, 10), (1e-3, 1e-3, 120, -1, 10),
        (1e-3, 1e-3, 1e-9, 0, 10), (1e-3, 1, 2, 3, 4, 5),
        (1e-3, 1e-3, 1e-3, 120, 0, 0, 130, 1, 1, 0, 10), (1e-3, 1e-3, 1e-3, 120, 0, 2, 1, 1, 1, 0, 10),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(said):
    with pytest.raises(ValueError, match=r"^$"):
        unavailability(*said)
