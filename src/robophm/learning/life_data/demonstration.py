"""Tests that demonstrate a reliability: how many to test, for how long, so that few failures are proof enough.

A test is passed where at most so many of n fail within its time. It demonstrates a reliability R at a time t with a
confidence C if what is no better than that passes with at most 1 − C: Σ (n over i) (1 − R′)ⁱ R′ⁿ⁻ⁱ over the failures
that are allowed is at most 1 − C, where R′ = R^((T/t)^β) is the chance to survive the test's time T by a Weibull life
of shape β. Where failed ones are replaced at once, and rates are constant, the time of all together counts: it is at
least χ²(C; 2f + 2)/2 times the mean life. Meeker and Escobar, Statistical Methods for Reliability Data, section 10.6;
MIL-HDBK-781A, section 5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import bdtr, betaincinv, gammaincinv, pdtr

from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError

MOST_UNITS = 100_000_000
"""The most that a test may be of."""

LONGEST_TEST = 1e9
"""The longest time of a test, or until which a reliability is wanted [h]."""

BETTER = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)
"""How many times as long the true lives are for which the chance to pass is stated."""


@dataclass(frozen=True)
class Wanted:
    """A reliability that is to be demonstrated."""

    reliability: float
    at: float
    """Time until which it is to hold [h]."""
    confidence: float = 0.9
    """Confidence with which a test that is passed says so."""
    allowed: int = 0
    """Failures with which the test is passed still."""
    shape: float = 1.0
    """Shape of the Weibull life; 1: a constant rate."""

    def __post_init__(self) -> None:
        number(self.at, "time of the reliability [h]", above=True, high=LONGEST_TEST)
        number(self.allowed, "failures allowed", low=0, high=10_000, whole=True)
        number(self.shape, "shape", low=0.1, high=50)
        for value, name in ((self.reliability, "reliability"), (self.confidence, "confidence")):
            if not 0 < number(value, name) < 1:
                raise RobophmError(f"{name} {value:g}: expected above 0 and below 1, e.g. 0.9")

    @property
    def mean_life(self) -> float:
        """Return the mean life that it stands for at a constant rate [h]."""
        return self.at / -math.log(self.reliability)

    def fails(self, hours: float, times_as_long: float = 1.0) -> float:
        """Return P(one fails within a test of so many hours), if it is just as good, or lives so many times as long."""
        return -math.expm1(math.log(self.reliability) * (hours / self.at / times_as_long) ** self.shape)

    def passes(self, units: int, hours: float, times_as_long: float = 1.0) -> float:
        """Return P(the test is passed), arguments as of ``fails``."""
        return 1.0 if units <= self.allowed else float(bdtr(self.allowed, units, self.fails(hours, times_as_long)))


@dataclass(frozen=True)
class TestPlan:
    """A test of so many for so long, and what it is worth."""

    __test__ = False  # of pytest's

    wanted: Wanted
    units: int
    hours: float
    """Time of the test of each [h]."""
    confidence: float
    """Confidence that it has: at least what is wanted, unless both units and hours were given."""
    passed: tuple[tuple[float, float], ...]
    """How many times as long lives truly are as they just must be, and P(passed) then."""
    with_replacement: float | None
    """Hours of all together [h] where failed ones are replaced at once; None where rates are not constant."""

    @property
    def total(self) -> float:
        """Return the hours of all together [h], if none fails."""
        return self.units * self.hours


def demonstration(wanted: Wanted, units: int | None = None, hours: float | None = None) -> TestPlan:
    """Return the smallest test of so many ``hours`` each, by default until the wanted time; or the shortest of so many
    ``units``; or what a test of both is worth.

    Raises RobophmError where no test can be: fewer units than failures allowed, or more than MOST_UNITS needed.
    """
    if units is not None:
        units = int(number(units, "units", low=wanted.allowed + 1, high=MOST_UNITS, whole=True))
    if hours is not None:
        hours = number(hours, "hours of the test", above=True, high=LONGEST_TEST)
    if units is None:
        hours = wanted.at if hours is None else hours
        units = _units(wanted, hours)
    elif hours is None:
        hours = _hours(wanted, units)
    passed = tuple((times, wanted.passes(units, hours, times)) for times in BETTER)
    together = None
    if wanted.shape == 1:
        together = wanted.mean_life * float(gammaincinv(wanted.allowed + 1, wanted.confidence))
    return TestPlan(wanted, units, hours, 1 - passed[0][1], passed, together)


def replaced_pass(wanted: Wanted, total: float, times_as_long: float = 1.0) -> float:
    """Return P(passed) of a test of so many hours of all together in which failed ones are replaced; rates constant."""
    return float(pdtr(wanted.allowed, total / (wanted.mean_life * times_as_long)))


def _units(wanted: Wanted, hours: float) -> int:
    """The fewest units whose test is as sure as is wanted: their chance to pass falls with their number."""
    risk = 1 - wanted.confidence
    high = wanted.allowed + 1
    while wanted.passes(high, hours) > risk:
        high *= 2
        if high > 2 * MOST_UNITS:
            raise RobophmError(
                f"more than {MOST_UNITS:,} units would have to be tested for {hours:g} h; expected a longer test"
            )
    low = max(high // 2, wanted.allowed)  # too few
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if wanted.passes(middle, hours) <= risk else (middle, high)
    return high


def _hours(wanted: Wanted, units: int) -> float:
    fails = float(betaincinv(wanted.allowed + 1, units - wanted.allowed, wanted.confidence))
    with np.errstate(divide="ignore"):  # as good as none survives
        hours: float = wanted.at * float(np.log1p(-fails) / math.log(wanted.reliability)) ** (1 / wanted.shape)
    if not 0 < hours <= LONGEST_TEST:
        raise RobophmError(
            f"a test of {units:,} would take {hours:.3g} h; expected at most {LONGEST_TEST:g}: test more"
        )
    return hours
