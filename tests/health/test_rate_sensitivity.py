"""Ranges under uncertain rates, and what knowing one would make of them, beside closed forms and plain sampling."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.health.drawn_rates import draw_rates
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.rate_sensitivity import MOST_TRIED, largest_unknowns, ranges

HALF_HOUR = Task((Leg(0.5),))


def outlook(components, more=""):
    robot = parse(f"schema_version: 1\nname: r\n{more}\ncomponents: {{{components}}}")
    return as_designed(Plant(robot)), robot.diagram


def test_of_one_part_they_are_the_quantiles_of_its_rate():
    """λ is lognormal of mean 1e-3 with error factor 4: its 5 % and 95 % quantile are the median over and times 4."""
    now, diagram = outlook("a: {rate: 1e-3 /h, uncertainty: {error_factor: 4}}")
    median = 1e-3 * math.exp(-((math.log(4) / norm.ppf(0.95)) ** 2) / 2)
    found = ranges(now, diagram, HALF_HOUR)
    for interval, of_rate in (
        (found.hazard_rate, lambda rate: rate),
        (found.failure, lambda rate: -math.expm1(-rate / 2)),
        (found.median_life, lambda rate: math.log(2) / rate),
    ):
        wanted = sorted(of_rate(median * factor) for factor in (0.25, 1, 4))
        assert interval == pytest.approx(wanted, rel=0.02)
    (unknown,) = largest_unknowns(now, diagram, HALF_HOUR)
    assert [part.path for part in unknown.parts] == ["a"]
    assert unknown.left == 0
    assert unknown.if_known.hazard_rate == pytest.approx((1e-3, 1e-3, 1e-3))


def test_of_several_parts_they_are_as_plain_sampling_has_them():
    rates, factors, shapes = np.array([2e-4, 1e-4, 5e-4]), np.array([5, 2, 3]), np.array([1, 1, 2])
    said = ", ".join(
        f"p{i}: {{mttf: {1 / rate} h, life: {{distribution: weibull, shape: {shape}}}, "
        f"uncertainty: {{error_factor: {factor}}}}}"
        for i, (rate, factor, shape) in enumerate(zip(rates, factors, shapes, strict=True))
    )
    now, diagram = outlook(said)
    found = ranges(now, diagram, HALF_HOUR)
    deviation = np.log(factors) / norm.ppf(0.95)
    drawn = np.exp(deviation * np.random.default_rng(5).standard_normal((40_000, 3)) - deviation**2 / 2)
    scale = np.array([1 / rate / math.gamma(1 + 1 / shape) for rate, shape in zip(rates, shapes, strict=True)]) / drawn

    def hazard(hours):
        return ((hours / scale) ** shapes).sum(axis=1)

    assert found.failure == pytest.approx(np.quantile(-np.expm1(-hazard(0.5)), (0.05, 0.5, 0.95)), rel=0.05)
    low, high = np.full(len(drawn), 1.0), np.full(len(drawn), 1e6)
    for _ in range(60):
        middle = np.sqrt(low * high)
        early = hazard(middle[:, None]) < math.log(2)
        low, high = np.where(early, middle, low), np.where(early, high, middle)
    assert found.median_life == pytest.approx(np.quantile(low, (0.05, 0.5, 0.95)), rel=0.05)


def test_the_widest_of_equal_rates_is_named_first_and_exact_ones_never():
    now, diagram = outlook(
        "narrow: {rate: 1e-4 /h, uncertainty: {error_factor: 2}}, "
        "wide: {rate: 1e-4 /h, uncertainty: {error_factor: 9}}, exact: {rate: 1e-3 /h}"
    )
    found = largest_unknowns(now, diagram, HALF_HOUR)
    assert [part.path for one in found for part in one.parts] == ["wide", "narrow"]
    assert found[0].left < found[1].left < 1


def test_parts_of_one_entry_are_known_together():
    now, diagram = outlook("a: {part: imu}, b: {part: imu}, c: {part: antenna, uncertainty: {error_factor: 1.1}}")
    found = largest_unknowns(now, diagram, HALF_HOUR, most=1)
    assert [[part.path for part in one.parts] for one in found] == [["a", "b"]]
    assert found[0].entry == "imu, grade C"


def test_nothing_is_said_where_all_rates_are_exact():
    now, diagram = outlook("a: {rate: 1e-4 /h}")
    assert largest_unknowns(now, diagram, HALF_HOUR) == []
    found = ranges(now, diagram, HALF_HOUR)
    assert found.hazard_rate == pytest.approx((1e-4, 1e-4, 1e-4))


def test_of_very_many_parts_the_largest_is_still_found():
    few = ", ".join(f"p{i}: {{rate: 1e-6 /h, uncertainty: {{error_factor: 2}}}}" for i in range(MOST_TRIED + 10))
    now, diagram = outlook(few + ", big: {rate: 1e-3 /h, uncertainty: {error_factor: 5}}")
    (found,) = largest_unknowns(now, diagram, HALF_HOUR, most=1, draws=500)
    assert [part.path for part in found.parts] == ["big"]


def test_parts_of_one_entry_share_what_is_not_known_of_it():
    """Two of them fail twice as often as one, whatever that is: their range is as wide as one's, and not narrower."""
    one, two, other = (
        outlook(said)
        for said in ("a: {part: imu}", "a: {part: imu}, b: {part: imu}", "a: {part: imu}, b: {part: antenna}")
    )
    alone, both, apart = (ranges(*each, HALF_HOUR).hazard_rate for each in (one, two, other))
    assert both == pytest.approx([2 * rate for rate in alone], rel=1e-6)
    assert apart.high / apart.low < alone.high / alone.low
    stated, diagram = outlook(
        "a: {part: imu, mtbf: 1e5 h}, b: {part: imu, mtbf: 1e5 h}", "uncertainty: {error_factor: 6}"
    )
    own = ranges(stated, diagram, HALF_HOUR).hazard_rate
    assert own.high / own.low < alone.high / alone.low  # figures of one's own are each their own


def test_failure_modes_of_one_entry_are_each_off_by_a_factor_of_their_own():
    """Motor and gears of a servo are known apart; those of two servos together."""
    now, _ = outlook("a: {part: smart_servo}, b: {part: smart_servo}")
    drawn = draw_rates(now.plant, 100, seed=1)
    row = {mode.path: drawn[i].tolist() for i, mode in enumerate(now.plant.robot.modes)}
    assert row["a/motor"] == row["b/motor"]
    assert row["a/gears"] == row["b/gears"]
    assert row["a/motor"] != row["a/gears"]
