"""Wear in the place of a hazard: closed forms of what then remains of a system."""

import math

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.worn import curve, remaining_life

ROBOT = """
schema_version: 1
name: R
usage: {operating: 0.5}
components:
  battery: {rate: 100 FPMH}
  computer: {rate: 200 FPMH}
  left: {rate: 300 FPMH}
  right: {rate: 300 FPMH}
diagram: {series: [battery, computer, {parallel: [left, right]}]}
"""


def worn(hours):
    """Fails about 4000 h from now: −ln S of a Weibull."""
    return (np.asarray(hours) / 4000.0) ** 6


@pytest.fixture
def outlook():
    return as_designed(Plant(parse(ROBOT)))


def test_survival_in_closed_form(outlook):
    found = curve(outlook, outlook.plant.robot.diagram, {0: worn})
    t = np.array([10.0, 2000.0, 5000.0])
    pair = 1 - (-np.expm1(-150e-6 * t)) ** 2
    survives = np.exp(-worn(t) - 100e-6 * t) * pair
    fails, works = found(t)
    assert works == pytest.approx(survives, rel=1e-12)
    assert fails == pytest.approx(1 - survives, rel=1e-9)
    pair_alone = curve(outlook, outlook.plant.robot.diagram, {2: worn})(t)[1]
    assert pair_alone == pytest.approx(
        np.exp(-150e-6 * t) * (1 - (-np.expm1(-worn(t))) * (-np.expm1(-150e-6 * t))), rel=1e-12
    )


def test_nothing_seen_is_as_it_was(outlook):
    diagram = outlook.plant.robot.diagram
    assert remaining_life(outlook, diagram, {}).median == pytest.approx(
        outlook.remaining_life(diagram).median, rel=1e-6
    )


def test_of_the_part_alone(outlook):
    life = remaining_life(outlook, outlook.plant.alone[0], {0: worn})
    assert life.median == pytest.approx(4000 * math.log(2) ** (1 / 6), rel=1e-6)
    assert life.mean == pytest.approx(4000 * math.gamma(1 + 1 / 6), rel=1e-6)
    gone = remaining_life(outlook, outlook.plant.alone[0], {0: lambda hours: np.full(np.shape(hours), np.inf)})
    assert gone.median == 0.0


def test_a_member_of_a_group_is_refused():
    robot = parse("{schema_version: 1, name: R, components: {a: {rate: 1 /h}, b: {rate: 1 /h}},"
                  " diagram: {standby: {of: [a, b]}}}")  # fmt: skip
    outlook = as_designed(Plant(robot))
    with pytest.raises(RobophmError, match="'a' is of a group of parts that depend on each other"):
        curve(outlook, robot.diagram, {0: worn})
