"""What a robot can be asked about itself."""

from __future__ import annotations

import pytest

from robophm.core.errors import DesignError
from robophm.core.signal import SECOND
from robophm.design.file import example_design, load, parse
from robophm.design.robot import Robot
from robophm.design.task import Plan

TEXT = """
schema_version: 1
name: R
functions: {see: lamp}
task: {duration: 2 h}
clocks: {kilometres: {topic: /odom, speed: v, max_age: 7 s}}
components:
  lamp: {rate: 1e-4 /h}
modules:
  drive:
    components:
      wheel: {rate: 1e-5 /h, quantity: 4}
    modules:
      motors:
        acceleration: {model: q10, reference_temperature: 25 degC}
        signals: {temperature: {topic: /t, field: c, unit: degC, range: [0, 90], max_age: 3 s}}
        components:
          left: {rate: 1e-5 /h, quantity: 2, required: 1}
          right: {rate: 1e-5 /h}
        common_causes:
          heat: {of: [left, right], beta: 0.1}
"""


@pytest.fixture(scope="module")
def robot() -> Robot:
    return parse(TEXT)


def test_its_levels_are_itself_and_its_modules_outer_before_inner(robot: Robot) -> None:
    assert list(robot.levels) == ["", "drive", "drive/motors"]
    assert robot.levels[""] is robot
    assert robot.levels["drive/motors"].path == "drive/motors"


def test_parts_are_counted_one_by_one_and_common_causes_are_none(robot: Robot) -> None:
    assert robot.causes
    assert robot.part_count == 1 + 4 + 2 + 1
    assert robot.levels["drive"].part_count == 7


def test_a_function_is_asked_for_by_name(robot: Robot) -> None:
    assert robot.diagram_of("see") is robot.functions["see"]
    assert robot.diagram_of() is robot.diagram_of("") is robot.diagram
    with pytest.raises(DesignError, match="no function 'se'; did you mean 'see'"):
        robot.diagram_of("se")


def test_its_own_task_is_a_plan(robot: Robot) -> None:
    assert robot.task is not None
    assert robot.plan == Plan((robot.task,))
    assert parse("schema_version: 1\nname: R\ncomponents: {a: {rate: 1e-4 /h}}\n").plan == Plan(())


def test_how_long_the_values_of_its_signals_hold(robot: Robot) -> None:
    assert robot.max_ages == {"/odom.v": 7 * SECOND, "/t.c": 3 * SECOND}
    assert robot.max_ages.keys() == robot.signals.keys()


def test_the_example_is_the_robot_of_the_paper() -> None:
    assert load(example_design()).name == "OTA"
