"""From nothing to the first report, as a new user would: robots, described, recorded, seven questions."""

import json
import math
import time

import pytest
from scipy.stats import norm
from tests.drafting.robots import DATA, robots

from robophm.core.units import quantity
from robophm.design.file import load, parse
from robophm.design.task_file import parse_plan
from robophm.drafting.answers import Answers, questions
from robophm.drafting.drafting import drafted, evidence, new
from robophm.drafting.first_look import first_look, part_figures
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.refusal import refusal

NAMES = ("turtlebot3", "so101", "six_axis_arm", "quadrotor", "quadrotor_px4")


@pytest.fixture(scope="module")
def drafts(shared, tmp_path_factory):
    """Each robot's draft and first look, and how long they took [s]."""
    folder = tmp_path_factory.mktemp("recorded")
    found = {}
    for robot in robots(shared):
        bag = robot.recorded(folder)
        begun = time.monotonic()
        known = evidence(robot.urdf, [bag])
        draft = drafted(known, Answers().with_(**robot.said), (), {})
        found[robot.name] = robot, draft, first_look(draft.robot, [bag]), time.monotonic() - begun
    return found


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
def test_it_takes_seconds_and_seven_questions_at_most(name, drafts):
    _, draft, _, took = drafts[name]
    assert took < 60
    asked = [one.key for one in questions(draft.known)]
    assert len(asked) <= 7
    assert len(set(asked)) == len(asked)


@pytest.mark.parametrize("name", NAMES)
def test_the_draft_is_a_design_without_warnings_of_which_figures_can_be_given(name, drafts):
    robot, draft, _, _ = drafts[name]
    assert draft.robot.warnings == ()
    assert refusal(draft.robot) is None
    assert set(robot.expects) <= {one.entry for one in draft.parts}
    assert parse_plan(draft.tasks_file, draft.robot).tasks


@pytest.mark.parametrize("name", NAMES)
def test_every_rate_has_a_source_and_a_grade_and_a_range(name, drafts):
    for one in part_figures(drafts[name][1].robot):
        assert one.grade in ("A", "B", "C"), one.path
        assert one.source, one.path
        assert one.rate.low < one.rate.median < one.rate.high, one.path


@pytest.mark.parametrize("name", NAMES)
def test_at_least_five_signals_are_bound_each_with_values_that_were_seen(name, drafts):
    _, draft, look, _ = drafts[name]
    assert len(draft.robot.signals) >= 5
    assert set(draft.robot.signals) == {signal for one in draft.bound for signal in one.signals}
    assert all("samples" in one.seen or "odometry" in one.seen for one in draft.bound)
    assert look.report is not None
    assert look.lived == pytest.approx(1 / 6, rel=0.01)
    assert not look.report.subjects[0].silence


@pytest.mark.parametrize("name", NAMES)
def test_the_first_look_is_a_range_and_names_whom_to_ask(name, drafts):
    look = drafts[name][2]
    for interval in (look.ranges.hazard_rate, look.ranges.median_life, look.ranges.remaining_life, look.ranges.failure):
        assert 0 < interval.low < interval.median < interval.high
    assert len(look.unknowns) == 3
    assert all(one.left < 1 for one in look.unknowns)
    assert look.unknowns[0].left <= look.unknowns[1].left <= look.unknowns[2].left


def test_joints_are_bound_by_their_own_names(drafts):
    draft = drafts["six_axis_arm"][1]
    bound = {one.part: one.signals for one in draft.bound if one.input == "load"}
    assert bound["elbow/gear"] == ("/joint_states.effort[elbow_joint]",)
    assert bound["wrist 2/gear"] == ("/joint_states.effort[wrist_2_joint]",)
    assert len(bound) == 6
    warm = {one.part: one.signals for one in draft.bound if one.input == "temperature"}
    assert warm["wrist 3/motor"] == ("/diagnostics.status[wrist_3_joint motor].values[Temperature].value",)
    assert "wrist 3/motor driver" not in warm  # the motor's temperature is not its driver's


def test_what_is_not_measured_is_not_bound_and_what_lacks_its_limit_says_so(drafts):
    draft = drafts["turtlebot3"][1]
    assert not any("/battery_state" in signal for signal in draft.robot.signals)  # its temperature is not a number
    assert [note for note in draft.unbound if "wheel_left_joint" in note and "what counts as 1" in note]


def test_parts_that_are_inside_others_do_not_count_twice(drafts):
    assert not {"imu", "barometer", "magnetometer"} & {one.entry for one in drafts["quadrotor"][1].parts}
    assert (
        "imu, magnetometer, barometer: taken to be inside the part flight_controller"
        in drafts["quadrotor"][1].assumptions
    )
    assert "magnetometer" not in {one.entry for one in drafts["turtlebot3"][1].parts}


def test_gears_of_the_arm_work_as_was_recorded(drafts):
    """A swing of ±1 rad in 12 s is four radians in each, of a limit of 3.14 rad/s."""
    gears = [one for one in drafts["six_axis_arm"][1].parts if one.name == "gear"]
    assert len(gears) == 6
    assert all(f"as recorded, {4 / 12 / 3.14:.1%} of the joint's limit" in one.assumed for one in gears)


def test_motors_of_the_arm_turn_as_was_recorded_and_its_encoders_are_of_no_stated_kind(drafts):
    """Makers state 20,000 h at the highest speed; between that and as many turns lies a factor of 3.14 · 12 / 4."""
    parts = {one.path: one for one in drafts["six_axis_arm"][1].parts}
    motor = parts["elbow/motor"]
    share = 4 / 12 / 3.14
    deviation = math.log(1 / share) / 2 / norm.ppf(0.95)
    factor = math.sqrt(share) * math.exp(deviation**2 / 2)
    assert quantity(motor.keys["l10"], "h") == pytest.approx(20_000 / factor, rel=0.02)
    wide = math.exp(math.hypot(math.log(3), math.log(1 / share) / 2))
    assert motor.keys["uncertainty"]["error_factor"] == pytest.approx(wide, rel=0.02)
    assert "grade B" in motor.keys["source"]
    assert parts["elbow/encoder"].entry == "joint_encoder"


@pytest.mark.parametrize("name", NAMES)
def test_what_a_design_by_hand_has_from_poor_sources_says_so(name, drafts):
    """Who sells other things, or says it in passing, is no source of a figure: grade C, five times off either way."""
    poor = [mode for mode in load(drafts[name][0].by_hand).modes if mode.source.startswith("Grade C")]
    assert poor
    assert all(mode.uncertainty and mode.uncertainty.error_factor >= 5 for mode in poor)


@pytest.mark.parametrize("name", NAMES)
def test_the_ranges_hold_the_figures_of_a_careful_design_by_hand(name, drafts):
    """Its sources are its own; what a robot that did so much may be asked is the same task."""
    by_hand = load(drafts[name][0].by_hand)
    assert not any("library" in mode.source for mode in by_hand.modes)
    look = drafts[name][2]
    outlook = as_designed(Plant(by_hand))
    failure = completion(outlook, look.task).failure
    assert look.ranges.failure.low < failure < look.ranges.failure.high
    median = outlook.remaining_life(by_hand.diagram).median
    assert look.ranges.median_life.low < median < look.ranges.median_life.high


def test_the_task_is_what_was_driven(drafts):
    """Four minutes of 0.2 m/s out of six, twice over less the last rest: 840 steps of 0.1 m, less the first."""
    (task,) = drafts["turtlebot3"][1].tasks
    assert task.distance == pytest.approx(84, abs=0.2)
    assert quantity(task.leg()["duration"], "s") == pytest.approx(600, abs=1)


def test_a_robot_without_recordings_is_drafted_from_its_description_alone():
    draft = new(DATA / "six_axis_arm.urdf", answers=Answers(needs="elbow, sensing"))
    assert draft.robot.signals == {}
    assert draft.bound == ()
    assert [leg.functions for leg in draft.robot.task.legs] == [("task",)]
    assert "an hour of work, assumed" in draft.assumptions
    assert first_look(draft.robot).report is None


def test_a_parts_list_comes_in_under_its_module_and_what_lacks_a_rate_is_said(tmp_path):
    board = tmp_path / "main.csv"
    board.write_text(
        "Reference,Value,Description\nR1-R4,10k,resistor 0603\nC1,100nF,ceramic capacitor 50V\nX1,?,mystery\n"
    )
    draft = new(DATA / "quadrotor.urdf", parts_lists={"Drive/board": board})
    paths = [part.path for part in draft.robot.all_components()]
    assert any(path.startswith("Drive/board/") for path in paths)
    assert "main.csv" in draft.assumptions
    look = first_look(draft.robot)
    assert look.left_out is not None
    assert look.left_out.parts == 1
    grades = {one.path: one.grade for one in part_figures(draft.robot)}
    assert all(grades[path] in ("B", "") for path in paths if path.startswith("Drive/board/"))


def test_the_design_says_how_it_was_made(drafts):
    text = drafts["turtlebot3"][1].text
    (answers,) = [line.removeprefix("# answers: ") for line in text.splitlines() if line.startswith("# answers: ")]
    assert json.loads(answers) == {"hours": "4", "battery": "lipo", "drive": "dynamixel"}
    assert parse(text).name == "turtlebot3_burger"
