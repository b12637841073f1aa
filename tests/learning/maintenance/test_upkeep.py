"""A robot's upkeep planned: against renewal reward, Poisson demand and ages counted by hand."""

import math

import numpy as np
import pytest
from scipy.stats import poisson

from robophm.core.errors import DataError, RobophmError
from robophm.design.file import parse
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant
from robophm.learning.maintenance.costs_table import PartCosts
from robophm.learning.maintenance.life_cycle_costs import ConditionMonitoring
from robophm.learning.maintenance.replacement_age import Costs
from robophm.learning.maintenance.upkeep import UpkeepPlan

ROBOT = """
schema_version: 1
name: courier
usage: {operating: 0.5, kilometres: 1.2 km/h}
components:
  pump: {quantity: 2, required: 1, rate: 2000 FPMH}
  seal: {rate: 100 FPMH, life: {distribution: weibull, shape: 3}, initial_exposure: 2000 h}
  tyre: {rate: 1e-4 /km, clock: kilometres, life: {distribution: weibull, shape: 3}}
  radio: {rate: unknown}
  hand: {failure_modes: {grip: {rate: 1 FPMH}, wrist: {rate: 1 FPMH}}}
"""


def plan(costs, **more):
    robot = parse(ROBOT)
    parts = {part.path: part for part in robot.all_components()}
    said = {name: PartCosts(parts[name], *one) for name, one in costs.items()}
    plant = Plant(robot)
    return UpkeepPlan.of(robot, said, as_designed(plant).future.pace(plant), **more)


def test_redundancy_shares_out_what_standing_still_costs():
    """A pump fails every 1000 h of calendar time and is down for 100 h: the other is up for 1000 of 1100 h."""
    found = plan({"pump": (Costs(10, 10, 0, 100), None), "seal": (Costs(10, 10), None)}, hour_down=5)
    pump, seal = found.parts
    down = 100 / 1100
    assert pump.pace == 0.5
    assert pump.life.mean() == pytest.approx(1000)
    assert pump.stops == pytest.approx(down)
    assert pump.redundant
    assert (seal.stops, seal.redundant) == (1.0, False)
    assert pump.policy.never == pytest.approx((10 + 5 * 100 * down) / 1100)
    assert (pump.age, pump.due) == (None, None)
    assert pump.price == 2 * 10
    cycles = found.life_cycles(20_000, 300, 1)
    assert cycles.by_age.availability == pytest.approx(1 - down**2, abs=2e-3)
    assert cycles.watched is None


def test_ages_are_on_the_parts_own_clock():
    """Half of the hours are of operation, in each of which it goes 1.2 km."""
    costs = {name: (Costs(10, 100), None) for name in ("seal", "tyre")}
    seal, tyre = plan(costs).parts
    assert (seal.pace, tyre.pace) == (0.5, pytest.approx(0.6))
    assert seal.age == pytest.approx(seal.policy.age * 0.5)
    # Of one shape, costs and mean of 10,000 on their clocks: both at the same share of their life.
    assert tyre.age == pytest.approx(seal.age, rel=1e-4)
    assert seal.due is None
    robot = parse(ROBOT)
    plant = Plant(robot)
    old = nominal_outlook(plant, plant.initial + 500.0)
    aged, _ = plan(costs, age=old.age).parts
    assert aged.due == pytest.approx(seal.policy.age - 2500 / 0.5)


def test_spares_of_parts_that_do_not_wear_are_poisson():
    """Three robots of two pumps: 6 parts that fail every 1000 h each, for 500 h."""
    found = plan({"pump": (Costs(10, 10), None)}).spares(500, 3, 0.95)
    number, sure = found["pump"]
    assert number == poisson.ppf(0.95, 3.0)
    assert sure == pytest.approx(poisson.cdf(number, 3.0), abs=1e-3)


def test_a_part_of_unknown_rate_is_named_and_one_that_is_repaired_is_not_replaced():
    found = plan({"radio": (Costs(1, 1), None), "seal": (Costs(10, 90, repair=20), None)})
    assert found.unknown == ("radio",)
    assert [one.path for one in found.parts] == ["seal"]
    assert not found.replaced
    assert (found.visit(5), found.life_cycles(100, 10, 1), found.spares(100, 1, 0.9)) == (None, None, {})


def test_watching_is_of_the_parts_that_have_a_sensor():
    """A sensor that sees nothing saves nothing, on the same lives; it costs its price for each of the two pumps."""
    found = plan({"pump": (Costs(10, 30), ConditionMonitoring(7.0, detects=0.0)), "tyre": (Costs(10, 100), None)})
    watched = found.life_cycles(5000, 40, 3).watched
    assert watched.investment == 14
    assert watched.saved == pytest.approx(np.full(40, -14.0))


@pytest.mark.parametrize(
    ("costs", "more", "says"),
    [
        ({"hand": (Costs(1, 1), None)}, {}, "'hand' fails in 2 ways, each with its own age"),
        ({"pump": (Costs(1, 1), None)}, {"hour_down": math.inf}, "hour_down inf: expected a number of at least 0"),
    ],
)
def test_what_cannot_be_planned(costs, more, says):
    with pytest.raises(RobophmError, match=says):
        plan(costs, **more)


def test_what_stands_still_does_not_age():
    robot = parse(ROBOT)
    parts = {part.path: part for part in robot.all_components()}
    with pytest.raises(DataError, match="'tyre' does not age: its clock 'kilometres' stands still"):
        UpkeepPlan.of(robot, {"tyre": PartCosts(parts["tyre"], Costs(1, 2), None)}, np.zeros(len(robot.modes)))


def test_more_lives_than_can_be_gone_through():
    with pytest.raises(DataError, match=r"some 4e\+06 lives of parts of one robot, 1,000 times over"):
        plan({"pump": (Costs(1, 1), None)}).life_cycles(2e9, 1000, 1)
