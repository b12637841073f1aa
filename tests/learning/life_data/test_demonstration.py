"""Demonstration tests, against printed plans, sums of the binomial in fractions, and drawn tests."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

import robophm
from robophm.core.errors import RobophmError
from robophm.learning.life_data.demonstration import Wanted, replaced_pass


@pytest.mark.parametrize(
    ("reliability", "confidence", "units"),
    [(0.9, 0.9, 22), (0.95, 0.9, 45), (0.99, 0.9, 230), (0.9, 0.95, 29), (0.95, 0.95, 59), (0.99, 0.95, 299),
     (0.8, 0.9, 11)],
)  # fmt: skip
def test_the_success_run_theorem(reliability: float, confidence: float, units: int) -> None:
    """Printed in every handbook, as ln(1 − C)/ln R; the last in ReliaWiki, Non-Parametric Binomial Test Design."""
    assert robophm.demonstrate(reliability, 1.0, confidence=confidence).units == units


def test_printed_plans() -> None:
    """ReliaWiki, Parametric Binomial Example and Constant Failure Rate/Chi-Squared Example."""
    wanted = {"confidence": 0.95, "shape": 1.5}
    assert robophm.demonstrate(0.9, 100, hours=48, **wanted).units == 86
    assert robophm.demonstrate(0.9, 100, units=20, **wanted).hours == pytest.approx(126.4339, abs=5e-5)
    together = robophm.demonstrate(0.85, 500, allowed=2).with_replacement
    assert together == pytest.approx(16_374, abs=1)


@pytest.mark.parametrize(("allowed", "factor"), [(0, 2.30), (1, 3.89), (2, 5.32), (3, 6.68)])
def test_the_guide_for_constant_rates(allowed: int, factor: float) -> None:
    """NIST/SEMATECH e-Handbook of Statistical Methods, 8.3.1.2, column of 90 %: test time over MTBF."""
    plan = robophm.demonstrate(math.exp(-1), 1.0, allowed=allowed)
    assert plan.with_replacement == pytest.approx(factor, abs=0.006)


@pytest.mark.parametrize("allowed", [0, 1, 3])
def test_one_unit_fewer_would_not_do(allowed: int) -> None:
    plan = robophm.demonstrate(0.9, 1000.0, allowed=allowed, confidence=0.8)

    def passed(units: int) -> Fraction:
        fails = Fraction(1, 10)
        return sum(
            (math.comb(units, i) * fails**i * (1 - fails) ** (units - i) for i in range(allowed + 1)), Fraction()
        )

    assert passed(plan.units) <= Fraction(1, 5) < passed(plan.units - 1)
    assert plan.confidence == pytest.approx(float(1 - passed(plan.units)), rel=1e-12)


def test_the_shortest_time_has_just_the_confidence() -> None:
    plan = robophm.demonstrate(0.95, 1000.0, allowed=2, units=12, shape=2.5, confidence=0.85)
    assert plan.confidence == pytest.approx(0.85, rel=1e-9)


def test_chances_to_pass_are_as_drawn() -> None:
    """40,000 tests of parts that live so many times as long."""
    plan = robophm.demonstrate(0.9, 1000.0, allowed=1, hours=500.0, shape=2.0)
    scale = 1000.0 / (-math.log(0.9)) ** 0.5
    drawn = np.random.default_rng(3)
    for times, passed in plan.passed[:4]:
        failed = drawn.binomial(plan.units, np.mean(scale * times * drawn.weibull(2.0, 400_000) < 500.0), 40_000)
        assert np.mean(failed <= 1) == pytest.approx(passed, abs=0.02)


def test_with_replacement_the_risk_is_the_wanted_one() -> None:
    wanted = Wanted(0.9, 100.0, 0.9, 2)
    together = robophm.demonstrate(0.9, 100.0, allowed=2).with_replacement
    assert replaced_pass(wanted, together) == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"reliability": 1.0}, "reliability 1"), ({"reliability": 0.0}, "reliability 0"), ({"at": 0}, "time"),
        ({"confidence": 1.0}, "confidence"), ({"units": 2, "allowed": 3}, "units 2"), ({"hours": -1}, "hours"),
        ({"shape": 0.0}, "shape"), ({"hours": 1e-7, "shape": 3.0}, "more than 100,000,000 units"),
        ({"allowed": 1.5}, "allowed"), ({"at": math.nan}, "time"),
        ({"units": 1, "shape": 0.1, "reliability": 0.999999}, "test more"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(wanted: dict[str, float], said: str) -> None:
    with pytest.raises(RobophmError, match=said):
        robophm.demonstrate(**{"reliability": 0.9, "at": 1000.0, **wanted})
