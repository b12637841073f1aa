"""Seven questions at most, each with what is assumed; answers that cannot be are refused with the nearest that can."""

import pytest
from tests.drafting.robots import DATA

from robophm.core.errors import RobophmError
from robophm.drafting.answers import (
    Answers,
    asked,
    battery_called,
    check,
    questions,
    settled,
    share_of_day,
)
from robophm.drafting.composing import change_of
from robophm.drafting.drafting import evidence, new


def test_nobody_is_asked_what_was_said_and_silence_takes_what_is_assumed():
    known = evidence(DATA / "six_axis_arm.urdf")
    put = []

    def ask(question):
        put.append(question.key)
        return "12" if question.key == "hours" else ""

    found = asked(Answers(where="factory", drive="planetary gearbox"), known, ask)
    assert put == ["hours", "battery", "computer", "sensors", "needs"]
    assert (found.hours, found.where, found.battery) == ("12", "factory", None)
    said, assumed = settled(found, known)
    assert (said.battery, said.computer) == ("mains", "industrial pc")
    assert {one.key for one, _ in assumed} == {"battery", "computer", "sensors", "needs"}
    assert all(one.because for one, _ in assumed)


def test_there_are_at_most_seven_whatever_is_known():
    for urdf in (None, DATA / "six_axis_arm.urdf", DATA / "quadrotor.urdf"):
        assert len(list(questions(evidence(urdf)))) <= 7


@pytest.mark.parametrize(("said", "share"), [("8", 1 / 3), ("90 min", 1 / 16), ("24", 1.0)])
def test_hours_are_a_share_of_the_day(said, share):
    assert share_of_day(said) == pytest.approx(share)


@pytest.mark.parametrize(
    ("key", "said", "says"),
    [
        ("hours", "25", "at most 24 a day"), ("hours", "0", "more than 0"), ("hours", "8 km", "'km' does not measure"),
        ("where", "indors", "did you mean 'indoor'"), ("battery", "lidar", "none of that name"),
        ("computer", "pizza", "none of that name"), ("drive", "imu", "finds imu, which is none"),
        ("sensors", "lidar, pizza", "'pizza'"),
    ],
)  # fmt: skip
def test_answers_that_cannot_be_are_refused(key, said, says):
    with pytest.raises(RobophmError, match=says):
        check(key, said)


def test_words_are_those_of_the_library():
    assert battery_called("lead acid").name == "battery_lead_acid"
    assert battery_called("battery_lfp").name == "battery_lfp"


def test_changes_add_replace_and_leave_out():
    changes = [change_of(one) for one in ("computer=raspberry pi", "force torque sensor=none", "head/eye=depth camera")]
    entries = {one.path: one.entry for one in new(DATA / "six_axis_arm.urdf", changes=changes).parts}
    assert entries["computing/computer"] == "single_board_computer"
    assert entries["head/eye"] == "depth_camera"
    assert "sensing/force torque sensor" not in entries
    for wrong in ("computer", "=x", "a="):
        with pytest.raises(RobophmError, match="expected NAME=WORDS"):
            change_of(wrong)
    with pytest.raises(RobophmError, match="no part 'computr' to leave out; did you mean"):
        new(DATA / "six_axis_arm.urdf", changes=[change_of("computr=none")])


def test_what_is_needed_must_be_there():
    with pytest.raises(RobophmError, match="needs 'elbo': no such part or module; did you mean 'elbow'"):
        new(DATA / "six_axis_arm.urdf", answers=Answers(needs="elbo"))


def test_nothing_at_all_is_no_robot():
    with pytest.raises(RobophmError, match="nothing tells of a part"):
        new(answers=Answers(battery="none", computer="none"))


MOVES = """<robot name="m"><link name="base"><inertial><mass value="20"/></inertial></link>
<link name="{link}"/><joint name="j" type="{type}"><parent link="base"/><child link="{link}"/></joint></robot>"""


@pytest.mark.parametrize(
    ("link", "type_", "symbol"),
    [("wheel", "continuous", "GM"), ("thigh", "revolute", "GM"), ("forearm", "revolute", "GF"),
     ("rotor", "continuous", "ARW")],
)  # fmt: skip
def test_what_moves_over_ground_is_ground_mobile_unless_somebody_says_else(tmp_path, link, type_, symbol):
    """MIL-HDBK-217F Table 3-2: GM is on wheels or tracks or carried by hand, ARW a helicopter, GF does not move."""
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(MOVES.format(link=link, type=type_))
    assert f"environment: {symbol} " in new(urdf).text
    indoors = new(urdf, answers=Answers(where="indoor"))
    assert "environment: GB " in indoors.text
    said = {"GM": "'mobile robot' (GM) is", "ARW": "'flying' (ARW) is"}.get(symbol)
    assert len(indoors.doubts) == (said is not None)
    assert all("where 'indoor' is GB" in doubt and said in doubt for doubt in indoors.doubts)
    assert new(urdf, answers=Answers(where="GB")).doubts == ()
    assert "environment: GM " in new(urdf, answers=Answers(where="Indoor-Robot")).text
