"""FMECA: effects from the structure, against what each failure does by hand."""

import math

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.health.effects import OCCURRENCE, effects, fault_chances, mode_shares, silent_states, unit_alarms
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

ROBOT = """
schema_version: 1
name: R
components:
  battery: {rate: 50 FPMH}
  motor: {quantity: 2, failure_modes: {winding: {rate: 8 FPMH}, bearing: {rate: 24 FPMH}}}
  lidar: {rate: 30 FPMH}
  camera: {rate: 90 FPMH}
  radio: {rate: 40 FPMH}
  lamp: {rate: 70 FPMH}
diagram: {series: [battery, motor, {parallel: [lidar, camera]}]}
functions: {drive: {series: [battery, motor]}, talk: {series: [battery, radio]}}
"""


@pytest.fixture
def outlook():
    return as_designed(Plant(parse(ROBOT)))


def test_effects_by_hand(outlook):
    found = {one.mode: one for one in effects(outlook, 1000.0, {"battery": 0.5})}
    assert (found["battery"].effect, found["battery"].lost) == ("robot", ("", "drive", "talk"))
    assert (found["radio"].effect, found["radio"].lost) == ("function", ("talk",))
    assert (found["lidar"].effect, found["lidar"].lost) == ("redundancy", ())
    assert found["lamp"].effect == "nothing"
    assert found["motor/winding"].functions == ("drive",)
    assert [found[m].severity for m in ("battery", "radio", "lidar", "lamp")] == [8, 6, 3, 1]
    assert found["motor/winding"].ratio == pytest.approx(0.25)
    assert found["motor/winding"].probability == pytest.approx(-math.expm1(-2 * 8e-3))
    assert found["battery"].beta == 1.0
    q = {name: -math.expm1(-1000 * rate) for name, rate in (("lidar", 3e-5), ("camera", 9e-5))}
    series = math.exp(-1000 * (50e-6 + 64e-6))
    assert found["lidar"].beta == pytest.approx(1 - series * (1 - q["camera"]), rel=1e-10)
    assert found["lidar"].criticality == pytest.approx(found["lidar"].beta * 0.03, rel=1e-10)
    assert found["motor/bearing"].criticality == pytest.approx(2 * 24e-3, rel=1e-10)
    occurrence = 1 + sum(q["camera"] >= limit for limit in OCCURRENCE)
    assert (found["camera"].occurrence, found["camera"].detection) == (occurrence, 10)
    assert (found["battery"].detection, found["battery"].rpn) == (
        round(5.5),
        8 * found["battery"].occurrence * round(5.5),
    )


def test_severities_may_be_said(outlook):
    said = {"talk": 9, "robot": 10, "lamp": 2, "motor/bearing": 7}
    found = {one.mode: one.severity for one in effects(outlook, 1000.0, {}, said)}
    assert found == {
        "battery": 9,
        "motor/winding": 10,
        "motor/bearing": 7,
        "lidar": 3,
        "camera": 3,
        "radio": 9,
        "lamp": 2,
    }
    ranked = [one.rpn for one in effects(outlook, 1000.0, {}, said)]
    assert ranked == sorted(ranked, reverse=True)


@pytest.mark.parametrize(
    ("said", "says"),
    [
        ({"tlk": 9}, "no function or part 'tlk'; did you mean 'talk'"),
        ({"talk": 11}, "severity of 'talk' 11: expected a whole number of at least 1 and at most 10"),
        ({"talk": 0}, "severity of 'talk' 0"),
    ],
)
def test_a_severity_that_is_none_is_refused(outlook, said, says):
    with pytest.raises(RobophmError, match=says):
        effects(outlook, 1000.0, {}, said)


def test_members_of_groups():
    robot = parse("{schema_version: 1, name: R, components: {a: {rate: 100 FPMH}, b: {rate: 100 FPMH}},"
                  " diagram: {standby: {of: [a, b]}}}")  # fmt: skip
    found = {one.mode: one for one in effects(as_designed(Plant(robot)), 1000.0, {})}
    assert {one.effect for one in found.values()} == {"redundancy"}
    assert found["a"].beta == pytest.approx(-math.expm1(-0.1))  # then the spare alone
    assert found["b"].beta == 1.0  # a cold spare fails at work alone: the first has failed before it


def test_chances_of_faults(outlook):
    found = fault_chances(outlook, 100.0)
    assert found["motor/bearing"] == pytest.approx(-math.expm1(-2 * 24e-4))
    assert found["lidar"] == pytest.approx(-math.expm1(-3e-3))


def test_nothing_has_failed_unseen_in_a_new_robot(outlook):
    with pytest.raises(RobophmError, match="nothing can have failed unseen"):
        silent_states(outlook, outlook.plant.robot.diagram, 10.0)
    assert np.isfinite(outlook.age).all()


def test_what_a_sensor_says_of_a_part_that_has_failed():
    """Of a motor's failures 1 in 4 is of the winding: 8 of 32 FPMH; of one that is new each is as likely."""
    plant = Plant(parse(ROBOT))
    assert mode_shares(as_designed(plant))["motor/winding"] == 0.5
    old = as_designed(plant, after=1000.0)
    assert mode_shares(old)["motor/winding"] == pytest.approx(0.25)
    (motor,) = (part for part in plant.components if part.path == "motor")
    states = [frozenset(), frozenset(motor.units), frozenset({"lidar", *motor.units})]
    found = unit_alarms(old, states, [({"motor/winding": 0.8, "motor/bearing": 0.4}, 0.1), ({"lidar": 0.5}, 0.0)])
    sees = 0.25 * 0.8 + 0.75 * 0.4
    silent = 0.9 * (1 - sees) ** len(motor.units)
    assert found == pytest.approx(np.array([[0.1, 0.0], [1 - silent, 0.0], [1 - silent, 0.5]]))
