"""What remains of a part that is seen to wear, and of the robot with it: laws of competing risks."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.learning.wear.readings_table import Readings
from robophm.learning.wear.worn_mode import WornMode, worn_mode
from robophm.monitoring.worn_life import worn_lives

DESIGN = """
schema_version: 1
name: courier
usage: {operating: 0.5, kilometres: 0 km/h}
components:
  battery: {rate: 120 FPMH, life: {distribution: weibull, shape: 3.5}}
  computer: {rate: 10 FPMH}
  tyre: {rate: 1e-6 /km, clock: kilometres}
  board: {rate: unknown}
"""
ROBOT = parse(DESIGN)


def rising(robot: Robot, path: str, *, knee: bool = False, dated: bool = False) -> WornMode:
    """Wear by 1e-3 an hour, which reaches 3 some 1500 h from now; with a ``knee`` of which nothing was to be seen."""
    hours = np.arange(300) * 5.0
    values = hours * 1e-3 + (0.04 * np.maximum(np.arange(300) - 280, 0) if knee else 0.0)
    values = values + 0.01 * np.random.default_rng(4).standard_normal(300)
    mode = next(one for one in robot.modes if one.path == path)
    return worn_mode(mode, path, Readings(hours, values, None, dated=dated), 3.0)


def test_the_part_alone_lives_as_its_wear_says_on_its_own_clock() -> None:
    """Half of the time it works; a robot of dates wears by the calendar."""
    outlook = as_designed(Plant(ROBOT))
    for dated, times in ((False, 2.0), (True, 1.0)):
        one = rising(ROBOT, "battery", dated=dated)
        found = worn_lives(outlook, [one])
        assert list(found) == ["battery", "courier"]
        part = found["battery"]
        assert part.with_wear.life.median == pytest.approx(times * one.wear.remaining.median, rel=0.02)
        assert part.with_wear.life.late == pytest.approx(times * one.wear.remaining.high, rel=0.02)
        assert part.holds
        assert (part.by_hazard.unknown, part.with_wear.unknown) == (None, None)


def test_the_robot_survives_while_its_wear_and_all_else_do() -> None:
    outlook, one = as_designed(Plant(ROBOT)), rising(ROBOT, "battery")
    robot = worn_lives(outlook, [one])["courier"]
    hours = robot.with_wear.life.median
    wear = math.exp(-float(one.wear.cumulative_hazard(np.array([hours / 2]))[0]))
    others = math.exp(-1e-5 * hours / 2)  # what rolls nowhere lives
    assert wear * others == pytest.approx(0.5, abs=0.005)
    assert robot.with_wear.life.median < robot.by_hazard.life.median
    assert robot.with_wear.unknown is not None  # the board's rate is


def test_wear_says_what_no_rate_does() -> None:
    found = worn_lives(as_designed(Plant(ROBOT)), [rising(ROBOT, "board")])
    assert found["board"].by_hazard.unknown is not None
    assert math.isinf(found["board"].by_hazard.life.median)
    assert found["board"].with_wear.unknown is found["courier"].with_wear.unknown is None


def test_wear_that_no_model_follows_is_of_the_part_and_of_the_robot_alone() -> None:
    found = worn_lives(as_designed(Plant(ROBOT)), [rising(ROBOT, "battery", knee=True), rising(ROBOT, "computer")])
    assert {name: one.holds for name, one in found.items()} == {"battery": False, "computer": True, "courier": False}


def test_a_clock_that_stands_tells_no_time() -> None:
    with pytest.raises(RobophmError, match="'tyre' does not age by the design's usage"):
        worn_lives(as_designed(Plant(ROBOT)), [rising(ROBOT, "tyre")])
